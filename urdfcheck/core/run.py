"""The outcome of a run: what every output renders. Standard library only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import TYPE_CHECKING

from urdfcheck.core.findings import Finding, Severity, SkippedCheck, Verdict
from urdfcheck.core.records import dataclass
from urdfcheck.core.rule import Rule

if TYPE_CHECKING:
    from urdfcheck.core.drop_test import DropTest
    from urdfcheck.core.scene import Scene


@dataclass(frozen=True, slots=True)
class NotChecked:
    """Why nothing is known of a model, and what helps."""

    reason: str
    """A sentence: the message of the finding at the cause."""
    remedy: str = ""
    """Options of the command with which the model may be checked, like ``--arg name:=…``; empty where the file is wrong."""
    accepted: bool = False
    """Whether the configuration or the command line accepts that the model is not checked (``unchecked``)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelInfo:
    """One model of a run."""

    path: str
    robot: str
    """Name of the robot; empty if it could not be read."""
    args: Mapping[str, str]
    """Arguments of the xacro: those that were given, those that launch files pass, and variables of ROS not set here."""
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
    found_args: Mapping[str, str] = field(default_factory=dict)
    """Of the arguments those that were not given, with the places, ``file:line``, that pass them."""
    not_checked: NotChecked | None = None
    """Why nothing is known of the model; None if it was checked."""

    @classmethod
    def unread(
        cls,
        *,
        path: str,
        model_id: str,
        arguments: Mapping[str, str],
        status: str = "failed",
        not_checked: NotChecked | None = None,
    ) -> ModelInfo:
        """Return the line of a model that could not be read."""
        return cls(
            path=path,
            robot="",
            args=dict(arguments),
            links=0,
            joints=0,
            mass=None,
            status=status,
            id=model_id,
            not_checked=not_checked,
        )

    @property
    def unchecked_severity(self) -> Severity | None:
        """How bad it is that the model was not checked: an error, or a warning where that is accepted; None if it was."""
        if self.status == "checked":
            return None
        return Severity.WARNING if self.not_checked is not None and self.not_checked.accepted else Severity.ERROR


@dataclass(frozen=True, slots=True, kw_only=True)
class EngineAnswer:
    """What an engine that is a target did with a model on this machine."""

    model: str
    """Id of the model."""
    engine: str
    version: str
    """Empty if it is not installed."""
    verdict: Verdict | None
    """None if it was not asked."""
    reasons: tuple[str, ...]
    """What it did, in its own words where it refused; how to install it, or why it was not asked."""
    stopped: bool = False
    """Whether its process died or was stopped, so that it may do something else the next time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """Immutable outcome of a run: the only input of every output."""

    models: tuple[ModelInfo, ...]
    findings: tuple[Finding, ...]
    """In the order of the report; suppressed ones included."""
    skipped: tuple[SkippedCheck, ...]
    rules: Mapping[str, Rule]
    """The selected rules, by code."""
    versions: Mapping[str, str]
    """Versions of urdfcheck, Python and libraries."""
    sources: Mapping[str, str]
    """Text of the files with findings, by name."""
    requested: frozenset[str] = frozenset()
    """Codes of the rules that the command line or the configuration names."""
    unrequested: tuple[Finding, ...] = ()
    """Notes that were not asked for: they show what programs do with a model too. Only the HTML report lists some of them, those
    that say why a program refuses it or drops a part of it."""
    more_notes: int = 0
    """By how many notes the report grows that lists the ``unrequested`` ones."""
    postponed: frozenset[str] = frozenset()
    """Codes of rules that did not run, because they have only notes on request."""
    scenes: tuple[Scene, ...] = ()
    """The models as graphical outputs draw them, if the request asks for them."""
    drops: tuple[DropTest, ...] = ()
    """The drop tests, if the request asks for them."""
    answers: tuple[EngineAnswer, ...] = ()
    """What the engines that are targets did here, if a command asks them."""
    seconds: float = 0.0
    failures: tuple[str, ...] = ()
    """Paths that do not exist, and failures of urdfcheck itself: they make the exit code 2."""
    units: int = 0
    """Number of checked models, launch files and packages."""
    unit_ids: frozenset[str] = frozenset()
    complete_rules: Mapping[str, frozenset[str]] = field(default_factory=dict)
    """Unit id → rules of which this run cannot have missed a finding; decides which baseline entries are stale."""
    baseline_unit_names: Mapping[tuple[str, str] | None, Mapping[str, str]] = field(default_factory=dict)
    """File and root folder of a baseline (None for the run's own) → unit id → name of the unit in that baseline."""
    tier: str = "full"
    """How much was computed: source | mesh | full."""
    targets: tuple[str, ...] = ()
    """Programs that will read the models."""
    targets_by_unit: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Unit id → its targets, where a configuration names others."""
    partial: bool = False
    """Whether the run was interrupted."""
    undeclared_arguments: Mapping[str, str] = field(default_factory=dict)
    """Arguments of the request that no model declares, each with the name of one that resembles it, or nothing."""
    has_unread_declarations: bool = False
    """Whether the expansion of a model stopped, so that these are not declared in what was read."""
    fail_on: Mapping[str, str] = field(default_factory=dict)
    """Model id → least severity of a finding that fails the run, where a configuration sets it."""
    baselines: frozenset[str] = frozenset()
    """Names of the baseline files."""
    unused_macro_files: tuple[str, ...] = ()
    """Files that define macros and that no checked model has read: they were not checked."""

    def count_findings(self, severity: Severity) -> int:
        """Count the findings of exactly this severity that are not suppressed."""
        return sum(f.severity == severity for f in self.active_findings)

    def get_targets(self, unit: str) -> tuple[str, ...]:
        """Return the programs that will read a model; empty where none are named."""
        return self.targets_by_unit.get(unit, self.targets)

    def find_variant_arguments(self, finding: Finding) -> Mapping[str, str]:
        """Return the arguments that reproduce a finding of a model with several variants."""
        if not finding.variants:
            return {}
        info = next((info for info in self.models if info.id == finding.model), None)
        if info is None or sum(other.path == info.path for other in self.models) < 2:
            return {}
        return info.args

    @property
    def unchecked_models(self) -> tuple[ModelInfo, ...]:
        """The models of which nothing is known; without findings they are not clean."""
        return tuple(info for info in self.models if info.status != "checked")

    @property
    def set_aside(self) -> Mapping[str, str]:
        """Why errors or warnings of a model are not listed, by the model's id."""
        ids = {info.id for info in self.models}
        return {s.model: s.reason for s in self.skipped if s.code in SkippedCheck.PROBLEMS and s.model in ids}

    @property
    def active_findings(self) -> tuple[Finding, ...]:
        """The findings that are not suppressed."""
        return tuple(f for f in self.findings if f.suppressed is None)

    @property
    def suppressed_counts(self) -> Mapping[str, int]:
        """Number of suppressed findings by source, configuration and baseline."""
        counts = dict.fromkeys(("source", "configuration", "baseline"), 0)
        for finding in self.findings:
            if finding.suppressed is not None:
                counts[finding.suppressed.kind] += 1
        return counts
