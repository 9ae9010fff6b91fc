"""The outcome of a run: what every output renders. Standard library only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from urdfcheck.core.findings import Finding, Severity, SkippedCheck
from urdfcheck.core.rule import Rule

if TYPE_CHECKING:
    from urdfcheck.core.drop_test import DropTest
    from urdfcheck.core.scene import Scene


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelInfo:
    """What a run knows of one model."""

    path: str
    robot: str
    """Name of the robot; empty if it could not be read."""
    args: Mapping[str, str]
    """Arguments of the xacro."""
    links: int
    joints: int
    mass: float | None
    """Total mass in kg, as far as it is given."""
    status: str
    """checked | needs-arguments | failed."""
    id: str
    """Name of the model in the report: its path from the configuration's root, and its arguments."""
    seconds: float = 0.0
    """Duration of the check."""

    @classmethod
    def unread(cls, *, path: str, id: str, arguments: Mapping[str, str], status: str = "failed") -> ModelInfo:
        """Return the line of a model that could not be read."""
        return cls(path=path, robot="", args=dict(arguments), links=0, joints=0, mass=None, status=status, id=id)


@dataclass(frozen=True, slots=True)
class Run:
    """The whole outcome, immutable: what every output renders. ``sources`` holds the text of files with findings;
    ``rules`` are those that were selected, ``tier`` how much was computed (source | mesh | full), ``units`` counts the
    models, launch files and packages that were looked at, ``ids`` names them, ``targets`` names who will read the models,
    ``judged`` has the rules by the id of a unit whose findings this run could not have missed there,
    ``homes`` how each baseline (its file and the folder of its names; None for the run's own) calls the units, by their ids;
    ``partial`` says that the run was interrupted, ``fail_on`` from which severity on the findings of a model fail the run, by
    its id; ``drops``: the drop tests, where they were asked for; ``baselines``: the files that say which findings are known."""

    models: tuple[ModelInfo, ...]
    findings: tuple[Finding, ...]
    skipped: tuple[SkippedCheck, ...]
    rules: Mapping[str, Rule]
    versions: Mapping[str, str]
    sources: Mapping[str, str]
    scenes: tuple[Scene, ...] = ()
    drops: tuple[DropTest, ...] = ()
    seconds: float = 0.0
    failures: tuple[str, ...] = ()
    units: int = 0
    unit_ids: frozenset[str] = frozenset()
    complete_rules: Mapping[str, frozenset[str]] = field(default_factory=dict)
    baseline_unit_names: Mapping[tuple[str, str] | None, Mapping[str, str]] = field(default_factory=dict)
    tier: str = "full"
    targets: tuple[str, ...] = ()
    partial: bool = False
    fail_on: Mapping[str, str] = field(default_factory=dict)
    baselines: frozenset[str] = frozenset()

    def count_findings(self, severity: Severity) -> int:
        """Findings of exactly this severity that are not suppressed."""
        return sum(f.severity == severity for f in self.active_findings)

    def find_variant_arguments(self, finding: Finding) -> Mapping[str, str]:
        """The arguments that it takes to see a finding of a model with several variants."""
        if not finding.variants:
            return {}
        return next((info.args for info in self.models if info.id == finding.model), {})

    @property
    def active_findings(self) -> tuple[Finding, ...]:
        """The findings that nobody knows yet."""
        return tuple(f for f in self.findings if f.suppressed is None)

    @property
    def suppressed_counts(self) -> Mapping[str, int]:
        """How many findings are known, by who says so: source, configuration, baseline."""
        counts = dict.fromkeys(("source", "configuration", "baseline"), 0)
        for finding in self.findings:
            if finding.suppressed is not None:
                counts[finding.suppressed.kind] += 1
        return counts
