"""The plain values that cross processes: the request of a run, its units of work, and the report on each unit."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.core import Finding, ModelInfo, NotChecked, SkippedCheck
from urdfcheck.core.records import dataclass
from urdfcheck.policy.limits import ResourceLimits
from urdfcheck.policy.policy import Policy
from urdfcheck.policy.suppression import BaselineEntries, BaselineExcesses, CommentUsage
from urdfcheck.source.model_role import MODEL, ModelRole
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.reach import FileReach
from urdfcheck.system.files import Stamp
from urdfcheck.system.observing.observations import Observations

if TYPE_CHECKING:
    from urdfcheck.core.drop_test import DropTest
    from urdfcheck.core.mechanism import RobotMechanism
    from urdfcheck.core.scene import Scene
    from urdfcheck.core.seams import SeamFact
    from urdfcheck.export.index.source_index import SourceIndex
    from urdfcheck.export.link_pairs import LinkPairs
    from urdfcheck.export.outline import ModelOutline
    from urdfcheck.policy.baseline import Baseline
    from urdfcheck.policy.config_resolver import ConfigResolver

# Joint configurations to sample, and with --thorough.
SAMPLES, THOROUGH = 200, 5_000


@dataclass(frozen=True, slots=True)
class PackageFolders:
    """Where packages are, beside the folders in which ROS looks for them."""

    by_name: Mapping[str, Path] = field(default_factory=dict)
    """Folder of each package that is named."""
    search_path: tuple[Path, ...] = ()
    """Folders in which packages are searched."""

    @property
    def all_folders(self) -> tuple[Path, ...]:
        """Every folder that is named."""
        return (*self.by_name.values(), *self.search_path)


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditOptions:
    """How every unit of a run is audited, whatever the configuration of its folder."""

    samples: int = SAMPLES
    """Number of joint configurations to sample."""
    scene: bool = False
    """Whether reports hold the scene that graphical outputs draw."""
    pairs: bool = False
    """Whether reports classify all pairs of links for an SRDF."""
    drop: bool = False
    """Whether models are dropped on a plane, at many time steps, whatever their targets."""
    mechanism: bool = False
    """Whether reports hold the model in plain values, to compare it with another version."""
    simulate: bool = True
    """Whether models may be dropped for the sake of their targets."""
    base: str = "auto"
    """How their base is held then: auto | fixed | free."""
    environment: tuple[str, ...] = ()
    """Environment variables that a xacro may read beside those of ROS."""
    reading: tuple[str, ...] = ()
    """The options of the command that say what may be read, and where packages are: a command that helps repeats them."""
    limits: ResourceLimits = field(default_factory=ResourceLimits)
    """Time and memory for one unit."""
    index: bool = False
    """Whether reports hold the index of the source, for editors."""
    expansion: bool = False
    """Whether that index holds the expanded robot."""
    heed_comments: bool = True
    """Whether comments in the source suppress findings."""
    texts: Mapping[str, bytes] = field(default_factory=dict)
    """Real path → content that replaces the file's: see :func:`urdfcheck.system.files.overlay_files`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """What a run is asked to do."""

    paths: tuple[Path, ...]
    """Models, launch files, packages and folders to check."""
    root: Path
    """Folder of the configuration; model ids are relative to it."""
    policy: Policy
    """Settings of the rules; they hold for all files unless ``config_resolver`` finds others."""
    options: AuditOptions = field(default_factory=AuditOptions)
    packages: PackageFolders = field(default_factory=PackageFolders)
    """Packages of the command line; with ``config_resolver`` each configuration adds its own."""
    jobs: int = 1
    """Number of worker processes."""
    arguments: Mapping[str, str] = field(default_factory=dict)
    """Values of xacro arguments."""
    cache: Path | None = None
    """Folder of cached results; None for no cache."""
    allowed: tuple[Path, ...] = ()
    """Folders below which files may be opened, beside those around paths and packages."""
    baseline: Baseline | None = None
    config_resolver: ConfigResolver | None = None
    """Finds the configuration of each file, which decides about rules and packages; None: `policy` holds for all."""
    all_arguments: bool = False
    """See :func:`urdfcheck.source.discover.discover_targets`."""
    only: frozenset[str] | None = None
    """Real paths of the files and folders that are checked of what the paths lead to; None for all."""

    @property
    def reach(self) -> FileReach:
        """Which files may be opened."""
        return FileReach.from_paths(self.paths, (*self.packages.all_folders, *self.allowed))

    def wants(self, path: str) -> bool:
        """Whether a file or folder that the paths lead to is to be checked."""
        if self.only is None:
            return True
        real = Path(os.path.realpath(path))
        return any(str(folder) in self.only for folder in (real, *real.parents))


@dataclass(frozen=True, slots=True, kw_only=True)
class Unit:
    """What one worker audits: a model with the launch files that lead to it, a launch file or a package."""

    kind: str
    """model | launch | package."""
    path: str
    id: str
    """Name in the report."""
    arguments: Mapping[str, str] = field(default_factory=dict)
    launches: tuple[str, ...] = ()
    is_explicit: bool = True
    """Whether the file was named, not discovered."""
    is_tentative: bool = False
    is_part: bool = False
    is_spare: bool = False
    """For these three see :class:`urdfcheck.source.plan.ModelTarget`."""
    is_xacro: bool | None = None
    """See :func:`urdfcheck.source.load.load_source`."""
    baseline_entries: BaselineEntries = field(default_factory=dict)
    """What the baseline accepts in this unit."""
    baseline_excesses: BaselineExcesses = field(default_factory=dict)
    """How bad that is at most, where it is known."""
    baseline_home: tuple[str, str] | None = None
    """File and root folder of its baseline; None for the run's own."""
    baseline_name: str = ""
    """Name of the unit in its baseline."""
    policy: Policy | None = None
    """Settings of the rules; None for those of the run."""
    packages: PackageFolders | None = None
    """Where packages are; None for those of the run."""
    fail_on: str | None = None
    """Least severity of a finding that fails the run; None where the run decides."""
    unknown_arguments: frozenset[str] = frozenset()
    varied_arguments: tuple[str, ...] = ()
    """For these two see :class:`urdfcheck.source.plan.ModelTarget`."""
    is_of_given_whole: bool = False
    """Whether a folder was given that holds the model's whole package, or its whole repository if it is in no package: only then
    other models in use are checked with it."""
    is_reduced: bool = False
    """Whether the unit was made to find the arguments that a finding takes."""

    def describe_unread(self, not_checked: NotChecked, status: str = "failed") -> ModelInfo | None:
        """Return what a run knows of the model if it could not be read; None if the unit is not a model."""
        if self.kind != "model":
            return None
        return ModelInfo.unread(
            path=format_path(Path(self.path)),
            model_id=self.id,
            arguments=self.arguments,
            status=status,
            not_checked=not_checked,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditSettings:
    """What holds for every unit of a run, inside the worker process."""

    policy: Policy
    """Settings of the rules, unless the unit has its own."""
    options: AuditOptions = field(default_factory=AuditOptions)
    packages: PackageFolders = field(default_factory=PackageFolders)
    """Where packages are, unless the unit has its own."""
    cache: str | None = None
    """Folder of cached results; None for no cache."""
    reach: tuple[str, ...] | None = None
    """Folders below which files may be opened; None for all."""
    known_packages: Mapping[str, Sequence[Path]] = field(default_factory=dict)
    """The folders of each package that the search for models came across, by its name."""
    visible_folders: tuple[str, ...] = ()
    """Folders that the worker process must see."""
    disk_state: str = ""
    """Names the files on the disk, as far as is known: jobs with the same one search packages once; empty: each does."""
    replay_key: str = ""
    """What decides about every report beside its unit, as a digest; empty where reports are not kept."""


@dataclass(frozen=True, slots=True, kw_only=True)
class UnitReport:
    """What a worker sends back."""

    findings: tuple[Finding, ...] = ()
    skipped: tuple[SkippedCheck, ...] = ()
    info: ModelInfo | None = None
    unrequested: tuple[Finding, ...] = ()
    """Notes that were not asked for."""
    findings_size: int = 0
    """Bytes that the findings take."""
    scene: Scene | None = None
    scene_size: int = 0
    """Bytes that the scene takes."""
    pairs: LinkPairs | None = None
    drop: DropTest | None = None
    mechanism: RobotMechanism | None = None
    index: SourceIndex | None = None
    seams: tuple[SeamFact, ...] = ()
    """What files around the model say about it, or a launch file or manifest says."""
    outline: ModelOutline | None = None
    sources: Mapping[str, str] = field(default_factory=dict)
    """Text of the files with findings."""
    digests: Mapping[str, str] = field(default_factory=dict)
    """Digests of the texts of these files, by their names: copies have the same."""
    failures: tuple[str, ...] = ()
    """Failures of urdfcheck itself: they make the exit code 2."""
    reads: Mapping[str, Stamp] = field(default_factory=dict)
    """The files that the findings depend on, as they were."""
    observations: Observations | None = None
    """All that the report depends on; None where that is not known, or has been put together for the run."""
    comments: tuple[CommentUsage, ...] = ()
    """Comments that suppress findings, or would."""
    files: tuple[str, ...] = ()
    """Files that make up the model, as findings call them."""
    xacro_sources: Mapping[str, str] = field(default_factory=dict)
    """Those of them with findings that xacro wrote, each with the path from there to the file that it is made from."""
    srdf_files: frozenset[str] = frozenset()
    """Files that make up its semantic descriptions, if a check has read them."""
    expanded_files: frozenset[str] = frozenset()
    """Those of the model's files that are XML."""
    robot_files: frozenset[str] = frozenset()
    """Those of them of which a link or joint was made."""
    role: ModelRole = MODEL
    """What the file is: where it is no model of its own, the report holds nothing else but `robot_files`."""
    other_environments: tuple[Mapping[str, str], ...] = ()
    """Arguments that stand for variables of the environment, with each of which the file makes another robot."""
    undeclared: Mapping[str, str] | None = None
    """Arguments that were given and that the model does not declare, each with the name of a declared one that resembles it, if
    any; None where what it declares is unknown."""
    is_read_in_part: bool = False
    """Whether the expansion stopped, so that what the model declares after that is unknown."""
