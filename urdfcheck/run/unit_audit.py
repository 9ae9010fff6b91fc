"""The audit of one unit (a model with the launch files that lead to it, or a package), done whole in one process.

Only plain data leaves: findings, skips, the model's line in the report and, when an output draws, its scene.
"""

from __future__ import annotations

import contextlib
import hashlib
import itertools
import operator
import os
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from urdfcheck.core import (
    FactUnavailableError,
    Finding,
    ModelInfo,
    Rule,
    Severity,
    SkippedCheck,
    Span,
)
from urdfcheck.core.errors import ModelTimeout
from urdfcheck.export.outline import ModelOutline, build_outline
from urdfcheck.model import Model
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.policy.consumers import SIMULATOR
from urdfcheck.policy.fix_safety import withdraw_shared_edits
from urdfcheck.policy.policy import TIERS, Policy, keep_aside
from urdfcheck.policy.report_limits import truncate_texts
from urdfcheck.rules import has_check, load_check, load_rules
from urdfcheck.run.comment_usage import assess_comments
from urdfcheck.run.findings import Kind, admit_finding, finalize_unit_findings
from urdfcheck.run.findings_cache import FindingsCache, is_cacheable
from urdfcheck.run.jobs import AuditOptions, AuditSettings, Unit, UnitReport
from urdfcheck.run.replay.reports import keep_report
from urdfcheck.run.report_sizes import limit_mechanism, limit_scene
from urdfcheck.run.shown_paths import PathShortener
from urdfcheck.run.source_texts import RULE as TEXTS_RULE
from urdfcheck.run.source_texts import limit_texts
from urdfcheck.run.units.unchecked import explain_unchecked, locate_unit, mark_cause, report_stopped_unit
from urdfcheck.source.load import Source, load_source, read_xacro_source
from urdfcheck.source.model_role import MODEL, collect_robot_files, find_model_role
from urdfcheck.source.package.finder import PackageFinder, format_path, is_kept_aside, load_package
from urdfcheck.source.package.similar_files import find_files_elsewhere
from urdfcheck.source.reach import OUT_OF_REACH, FileReach
from urdfcheck.source.resources import find_uninstalled_files
from urdfcheck.source.text.suppression_comments import find_ignore_comments
from urdfcheck.source.text.xml import Element, SourceFile
from urdfcheck.source.xacro.usage import iter_elements_by_tag
from urdfcheck.system.array_cache import ArrayCache
from urdfcheck.system.files import overlay_files, read_regular, record_reads
from urdfcheck.system.installation import describe_left_out, find_library_origin, list_own_files
from urdfcheck.system.observing.observations import Observations, observe
from urdfcheck.system.observing.questions import read_folders

if TYPE_CHECKING:
    from urdfcheck.core.drop_test import DropTest
    from urdfcheck.core.mechanism import RobotMechanism
    from urdfcheck.core.scene import Scene
    from urdfcheck.core.seams import SeamFact
    from urdfcheck.export.index.source_index import SourceIndex
    from urdfcheck.export.link_pairs import LinkPairs
    from urdfcheck.model.use.started_variants import StartedVariant
    from urdfcheck.source.launch.launch_file import Launch

_TIER_OF_NEED = {
    **dict.fromkeys(("source", "package"), "source"),
    "mesh": "mesh",
    **dict.fromkeys(("dynamics", "collision", "simulator"), "full"),
}


def audit_unit(unit: Unit, settings: AuditSettings) -> UnitReport:
    """Audit one unit. A check that crashes is reported as a failure and as finding URC900; the others still run."""
    start = time.perf_counter()
    audit = _UnitAudit(unit, settings)
    with (
        _observe(settings) as observations,
        record_reads() as reads,
        overlay_files(settings.options.texts),
        warnings.catch_warnings(),
    ):
        # Numbers that overflow are findings, not warnings of numpy, which few checks of the text load.
        warnings.simplefilter("ignore", RuntimeWarning)
        try:
            if unit.kind == "package":
                audit.audit_package()
            elif unit.kind == "launch":
                audit.audit_launches(None)
            else:
                audit.audit_model()
                audit.build_index()
        except ModelTimeout:
            audit.stop_audit("time")
        except MemoryError:
            audit.stop_audit("memory")
        report = replace(audit.build_report(time.perf_counter() - start), reads=reads)
    if observations is None:
        return report
    keep_report(unit, settings, report, observations)
    return replace(report, observations=observations)


@contextlib.contextmanager
def _observe(settings: AuditSettings) -> Iterator[Observations | None]:
    """Observe what a report depends on that may be kept."""
    if settings.cache is None or not settings.replay_key:
        yield None
        return
    with observe(apart=(settings.cache, *list_own_files())) as observations:
        yield observations


# What LCH001 says of launch files whose model was not found, so that it was not checked.
_UNKNOWN_MODELS = frozenset({"depends", "unfound", "unknown"})


class _UnitAudit:
    """Loads a unit, runs the checks on it and collects what they report."""

    def __init__(self, unit: Unit, settings: AuditSettings) -> None:
        self.unit = unit
        self.settings = settings
        self.options = settings.options
        self.policy = unit.policy or settings.policy
        self.packages = unit.packages or settings.packages
        self.findings: list[Finding] = []
        self.skipped: list[SkippedCheck] = []
        self.failures: list[str] = []
        self.texts: dict[str, str] = {}
        self.loaded_launches: list[Launch] = []
        self.srdf_files: frozenset[str] = frozenset()
        self.info: ModelInfo | None = None
        self.scene: Scene | None = None
        self.pairs: LinkPairs | None = None
        self.drop: DropTest | None = None
        self.mechanism: RobotMechanism | None = None
        self.index: SourceIndex | None = None
        self.model: Model | None = None
        self.seams: list[SeamFact] = []
        self.outline: ModelOutline | None = None
        self.findings_cache: FindingsCache | None = None
        self.source: Source | None = None
        self.role = MODEL
        self.unread_status = ""
        self.other_environments: list[dict[str, str]] = []
        self.shortener = PathShortener(self.list_machine_folders(), self.is_typed)
        self.rules = {c: r for c, r in load_rules().items() if c in self.policy.codes and has_check(r)}

    def make_finder(self, start: Path) -> PackageFinder:
        """Return a finder for the packages around a file or folder."""
        return PackageFinder(
            start.absolute(),
            self.packages.by_name,
            self.packages.search_path,
            reach=None if self.settings.reach is None else FileReach(self.settings.reach),
            known={name: list(folders) for name, folders in self.settings.known_packages.items()},
            disk_state=self.settings.disk_state,
        )

    def list_machine_folders(self) -> set[str]:
        """Return the folders of the unit's files, as absolute and as real paths."""
        given = (*self.packages.by_name.values(), *self.packages.search_path, Path(self.unit.path).parent, Path())
        variables = map(read_folders, ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"))
        folders = {
            *(self.settings.reach or ()),
            *map(os.path.abspath, given),
            *itertools.chain(*variables),
        }
        return folders | set(map(os.path.realpath, folders))

    def is_typed(self, text: str) -> bool:
        """Whether one of the sources that were read contains a text."""
        return any(text in source for source in self.texts.values())

    # -- kinds of units ----------------------------------------------------------------------------------------

    def audit_model(self) -> None:
        """Expand a model, check its text, then the robot, then the launch files that lead to it."""
        source = self.source = self.load_source()
        self.role = find_model_role(
            source,
            is_part=self.unit.is_part,
            is_tentative=self.unit.is_tentative,
            launches=tuple(map(Path, self.unit.launches)),
        )
        if self.role.must_be_checked:
            self.report_part(source)
        if self.role != MODEL:
            return
        is_unbound = source.is_part and bool(source.find_problems("prefix"))
        if source.find_problems("environment-decides"):
            from urdfcheck.source.other_environments import find_other_environments  # few models decide by one

            self.other_environments = find_other_environments(source)
        if source.root is None or source.root.tag != "robot" or is_unbound:
            self.unread_status = "needs-arguments" if source.find_problems("argument-missing") else "failed"
            self.report_causes(source)
            # Everything else is about a robot that is not available.
            self.skip_scope("model", "the model could not be expanded")
            self.audit_launches(None)
            return
        self.run_checks("file", source)
        model = self.model = self.build_model(source, source.root)
        self.check_model(model)
        self.audit_launches(model)
        self.info = _describe_model(self.unit, source, model)
        self.build_extras(model)

    def report_part(self, source: Source) -> None:
        """Say that a part was not checked by itself: that is reported unless a model is made of it."""
        self.unread_status = "failed"
        if source.find_problems("package-not-found"):  # told at its cause, as in the models that miss it too
            self.report_causes(source)
            return
        root = source.root if source.root is not None else source.main_tree
        at = locate_unit(self.unit) if root is None else root
        # Few files are parts that nothing includes.
        from urdfcheck.core.text import spell_breaks
        from urdfcheck.source.uses_elsewhere import (
            find_conditional_include,
            is_completed_by_includer,
            is_named_nowhere,
        )

        rule, reason = load_rules()["XML002"], self.role.reason
        included = find_conditional_include(source)
        if included is None:
            finding = rule.finding("part", at=at, reason=reason)
            # What only its includer completes, and no file takes any longer, is no robot that was missed.
            if self.role.is_doubtful and not self.unit.is_explicit and is_named_nowhere(source):
                finding = replace(finding, severity=Severity.WARNING, blocks_check=True)
        else:
            user, condition = format_path(included[0]), spell_breaks(included[1])
            finding = rule.finding("part-of-variant", at=at, reason=reason, user=user, condition=condition)
            if is_completed_by_includer(source):  # it is no robot that was missed, only a part of other variants
                finding = replace(finding, severity=Severity.INFO, blocks_check=True)
        self.findings.append(mark_cause(replace(finding, model=self.unit.id), self.policy))

    def report_causes(self, source: Source) -> None:
        """Report why there is no model, whatever the configuration says about these rules, and their other findings."""
        for rule in load_rules().values():
            if "file" in rule.scopes and has_check(rule):
                self.run_guarded(rule.code, partial(self.collect_causes, rule, source))

    def collect_causes(self, rule: Rule, source: Source) -> None:
        """Run one check of a file that gives no model: its errors are the causes, and what it says blocks the check."""
        for finding in load_check(rule)(source, rule, **self.get_options(rule)):
            located = replace(finding, model=self.unit.id)
            if finding.severity == Severity.ERROR or finding.blocks_check:
                self.findings.append(truncate_texts(mark_cause(located, self.policy)))
            elif rule.code in self.rules:
                self.findings.append(admit_finding(located, rule, self.policy))

    def get_options(self, rule: Rule) -> dict[str, Any]:
        """Return the values of a rule's options."""
        options = {name: o.default for name, o in rule.options.items()} if rule.options else {}
        return {**options, **self.policy.options.get(rule.code, {})}

    def load_source(self) -> Source:
        """Read and expand the model."""
        path = Path(self.unit.path)
        source = self.load_with_arguments(self.unit.arguments)
        self.texts.update({name: file.text for name, file in source.files.items()})
        for problem in source.find_problems("unreadable"):
            if problem.location.file == source.name and problem.message != OUT_OF_REACH and path.is_file():
                self.failures.append(f"{source.name}: cannot be read: {problem.message}")
        for problem in source.find_problems("time-limit", "memory-limit"):
            message = f"expansion-{problem.kind.partition('-')[0]}"
            self.findings.append(report_stopped_unit(self.unit, self.settings, message, problem=problem))
        return source

    def load_with_arguments(self, arguments: Mapping[str, str]) -> Source:
        """Read the model and expand it with these arguments."""
        path = Path(self.unit.path)
        return load_source(
            path,
            arguments,
            self.make_finder(path),
            is_part=self.unit.is_part,
            xacro=self.unit.is_xacro,
            environment=frozenset(self.options.environment),
            launches=tuple(map(Path, self.unit.launches)),
        )

    def build_model(self, source: Source, robot: Element) -> Model:
        """Return the robot of an expanded source, whose root element is ``robot``."""
        return Model(
            source=source,
            robot=robot,
            tier=self.policy.tier,
            cache=ArrayCache(self.cache_folder),
            samples=self.options.samples,
            targets=self.policy.targets,
            mesh_limits=self.policy.options.get("MSH008", {}),
            simulation=choose_simulation(self.policy, self.options),
            base=self.options.base,
        )

    @property
    def cache_folder(self) -> Path | None:
        """Folder of cached results."""
        return None if self.settings.cache is None else Path(self.settings.cache)

    def check_model(self, model: Model) -> None:
        """Run the checks of the model, and outline it for those of the run."""
        if self.cache_folder is not None and self.policy.tier != TIERS[0]:
            self.findings_cache = FindingsCache(model)
        self.run_checks("model", model)
        self.skip_uninstalled_meshes(model.source)
        if self.findings_cache is not None:
            self.findings_cache.save()
        self.outline = build_outline(model)
        if "SRD001" in self.rules:  # it has read them
            from urdfcheck.model.motion.semantic_descriptions import semantic_descriptions  # loads numpy

            srdfs = self.run_guarded("srdf", lambda: semantic_descriptions(model)) or ()
            self.srdf_files = frozenset(name for srdf in srdfs for name in srdf.files)

    def build_extras(self, model: Model) -> None:
        """Build what the options ask for beside findings."""
        if self.options.scene:
            from urdfcheck.export.scene_builder import build_scene  # only outputs that draw pay for it

            self.scene = self.run_guarded(
                "scene", lambda: build_scene(model, self.unit.id, launches=self.loaded_launches, findings=self.findings)
            )
        if self.options.pairs:
            from urdfcheck.export.link_pairs import compute_link_pairs  # only an SRDF is made of them

            self.pairs = self.run_guarded("srdf", lambda: compute_link_pairs(model))
        if self.options.mechanism:
            from urdfcheck.export.mechanism_builder import build_mechanism  # only a comparison pays for it

            self.mechanism = self.run_guarded("diff", lambda: build_mechanism(model, self.unit.id))
            self.collect_seams(operator.methodcaller("list_model_seams", model))
        if model.simulation != "none":
            self.drop = self.run_guarded("drop", lambda: self.run_drop_test(model))

    def build_index(self) -> None:
        """Index the source, for editors: of parts of models too, and of files of which no model could be made."""
        source = self.source
        if self.options.index and source is not None:
            from urdfcheck.export.index.index_builder import build_index  # only editors pay for it

            build = partial(build_index, with_expansion=self.options.expansion)
            self.index = self.run_guarded("server", lambda: build(source, self.model, self.unit.id))

    def run_drop_test(self, model: Model) -> DropTest | None:
        """Drop the model on a plane; None where that is impossible."""
        from urdfcheck.model.motion.simulated_drop import measure_step_curves, run_drop_test  # loads numpy

        try:
            curves = measure_step_curves(model) if self.options.drop else ()
            return replace(run_drop_test(model), model=self.unit.id, curves=curves)
        except FactUnavailableError:  # DYN005 reports why
            return None

    def collect_seams(self, list_seams: Callable[[Any], Iterable[SeamFact]]) -> None:
        """Keep what files around the models say, where versions are compared."""
        if self.options.mechanism:
            from urdfcheck.export import seam_builder

            self.seams += self.run_guarded("diff", lambda: list_seams(seam_builder)) or ()

    def audit_launches(self, model: Model | None) -> None:
        """Check the launch files of the unit with the model that they lead to."""
        paths = (self.unit.path,) if self.unit.kind == "launch" else self.unit.launches
        if not paths:
            return
        from urdfcheck.source.launch.launch_file import load_launch  # most models are started by none

        for path in map(Path, paths):
            launch = load_launch(path, self.make_finder(path))
            self.loaded_launches.append(launch)
            self.texts.update({name: file.text for name, file in launch.files.items()})
            before = len(self.findings)
            self.run_checks("launch", LaunchContext(launch, model, is_explicit=self.unit.is_explicit))
            for finding in self.findings[before:]:
                if finding.code == "LCH001" and finding.message_id in _UNKNOWN_MODELS:
                    self.add_skip(SkippedCheck.LAUNCHED_MODEL, finding.message, is_partial=True)
            self.collect_seams(operator.methodcaller("list_launch_seams", launch))

    def audit_package(self) -> None:
        """Check a package."""
        folder = Path(self.unit.path)
        package = load_package(folder)
        if package is None:
            return
        if package.file is not None:
            self.texts[package.file.name] = package.file.text
        self.collect_seams(operator.methodcaller("list_package_seams", package))
        self.run_checks(
            "package", replace(package, finder=self.make_finder(folder), is_fully_checked=self.unit.is_explicit)
        )

    def is_left_over(self) -> bool:
        """Whether the model has errors or warnings and is not used, as far as the project shows."""
        source, unit = self.source, self.unit
        if source is None or not unit.is_of_given_whole or self.policy.pedantic:
            return False
        # A test may load all files of its folder; what xacro wrote there is what someone looked at.
        if self.policy.is_for_tests and not source.is_output_of_xacro:
            return False
        is_started = not all(is_kept_aside(Path(launch), source.package) for launch in unit.launches)
        if is_started or all(finding.severity == Severity.INFO for finding in self.findings):
            return False
        from urdfcheck.model.use.left_overs import is_left_over  # reads the files of the project

        return bool(self.run_guarded("left-overs", lambda: is_left_over(source)))

    def find_replaced_defaults(self, names: AbstractSet[str]) -> Mapping[str, Path]:
        """Return those of these arguments whose defaults no file that starts the model leaves, each with such a file."""
        source = self.source
        if source is None or source.root is None:
            return {}
        from urdfcheck.model.use.started_variants import find_replaced_defaults  # few findings are about arguments

        return self.run_guarded("defaults", lambda: find_replaced_defaults(source, names)) or {}

    def find_kinds_of_defaults(self, kinds: AbstractSet[Kind]) -> tuple[AbstractSet[Kind], Sequence[StartedVariant]]:
        """Return those of these codes and messages that the model has with its defaults and not as it is started, and how it is
        started then."""
        if self.source is None or self.model is None:
            return frozenset(), ()
        from urdfcheck.model.use.started_variants import list_replacing_variants  # few models have errors or warnings

        variants = list_replacing_variants(self.source)
        given = [{**self.source.arguments, **variant.arguments} for variant in variants]
        left = self.run_guarded("defaults", partial(self.leave_kinds_of_defaults, kinds, given)) if given else None
        return (left, variants) if left else (frozenset(), ())

    def leave_kinds_of_defaults(
        self, kinds: AbstractSet[Kind], given: Iterable[Mapping[str, str]]
    ) -> AbstractSet[Kind]:
        """Leave those of these codes and messages that the model has with none of these arguments.

        None of a rule that finds another error or warning there: it may be the same fault, and nothing else would list it.
        """
        left = {(code, message) for code, message in kinds if code in self.rules}
        for arguments in given:
            source = self.load_with_arguments(arguments) if left else None
            if source is None or source.root is None:
                return frozenset()
            subjects = {"file": source, "model": self.build_model(source, source.root)}
            for rule in [self.rules[code] for code in {code for code, _ in left}]:
                about = [subjects.get(scope) for scope in rule.scopes]
                try:
                    found = [
                        f for s in about if s is not None for f in load_check(rule)(s, rule, **self.get_options(rule))
                    ]
                    left -= {(rule.code, finding.message_id) for finding in found}
                    graver = {(rule.code, f.message_id) for f in found if f.severity > Severity.INFO}
                    is_spared = None not in about and graver <= kinds
                except FactUnavailableError:
                    is_spared = False
                if not is_spared:
                    left = {kind for kind in left if kind[0] != rule.code}
        return left

    # -- running checks ----------------------------------------------------------------------------------------

    def run_checks(self, scope: str, subject: Any) -> None:
        """Run all selected checks of a scope on what it is about."""
        for rule in self.rules.values():
            if scope not in rule.scopes:
                continue
            missing = find_missing_tier(rule.needs, self.policy.tier)
            if missing:
                self.add_skip(rule.code, f"{SkippedCheck.TIER_REASON}{missing}")
                continue
            self.run_guarded(rule.code, partial(self.collect_findings, rule, subject, self.get_options(rule)))

    def collect_findings(self, rule: Rule, subject: Any, options: Mapping[str, Any]) -> None:
        """Run one check, or take its findings from the cache."""

        def run_check() -> Iterable[Finding]:
            return load_check(rule)(subject, rule, **options)

        cache = self.findings_cache if is_cacheable(rule) else None
        for finding in run_check() if cache is None else cache.recall_findings(rule, options, run_check):
            own = self.shortener.shorten_finding(replace(finding, model=self.unit.id))
            self.findings.append(admit_finding(own, rule, self.policy))

    def run_guarded(self, name: str, work: Callable[[], Any]) -> Any:
        """Run a check. A fact that is not available, or a library that may be left out, skips it; any other exception is a
        failure of urdfcheck."""
        try:
            return work()
        except FactUnavailableError as reason:
            self.add_skip(name, str(reason))
        except MemoryError:
            raise  # the model is too large; no check is at fault
        except Exception as error:
            missing = describe_left_out(error) if isinstance(error, ImportError) else None
            if missing is None:
                self.add_crash(name, error)
            else:
                self.add_skip(name, missing)
        return None

    def add_crash(self, name: str, error: Exception) -> None:
        """Report that a check failed."""
        import traceback  # nearly no run needs it

        where = traceback.extract_tb(error.__traceback__)[-1]
        text = f"{type(error).__name__}: {error} ({Path(where.filename).name}:{where.lineno})"
        text = self.shortener.shorten_text(text)
        self.failures.append(f"{name} crashed on {self.unit.id}: {text}")
        crash = load_rules()["URC900"].finding("crashed", at=locate_unit(self.unit), check=name, error=text)
        self.findings.append(replace(crash, model=self.unit.id))

    def stop_audit(self, message: str) -> None:
        """Give up: the findings so far stay, everything else is unknown."""
        self.findings.append(report_stopped_unit(self.unit, self.settings, message))
        self.add_skip("ALL", "the check was stopped (URC906)")
        self.unread_status = "failed"

    def add_skip(self, code: str, reason: str, *, is_partial: bool = False) -> None:
        """Note that a check could not run, or only on a part of what there is."""
        self.skipped.append(SkippedCheck(code, self.unit.id, self.shortener.shorten_text(reason), is_partial))

    def skip_uninstalled_meshes(self, source: Source) -> None:
        """Note which meshes are unknown because their package is declared but not installed here, which is not a mistake."""
        for package, files in find_uninstalled_files(source).items():
            number = "a mesh" if len(files) == 1 else f"{len(files)} meshes"
            reason = f"nothing is known of {number} in package {package}, which is not installed here"
            for rule in self.rules.values():
                if "mesh" in rule.needs and not find_missing_tier(rule.needs, self.policy.tier):
                    self.add_skip(rule.code, reason, is_partial=True)

    def skip_scope(self, scope: str, reason: str) -> None:
        """Note that no check of a scope could run."""
        for rule in self.rules.values():
            if scope in rule.scopes:
                self.add_skip(rule.code, reason)

    # -- the report --------------------------------------------------------------------------------------------

    def build_report(self, seconds: float) -> UnitReport:
        """Hand over what was collected."""
        if self.is_left_over():
            self.policy = keep_aside(self.policy, is_left_over=True)
            self.findings = [mark_cause(f, self.policy) if f.blocks_check else f for f in self.findings]
        named_files = self.read_named_files()
        comments = [
            comment
            for name, text in self.texts.items()
            for comment in find_ignore_comments(SourceFile(Path(name), name, text=text))
        ]
        comments = comments if self.options.heed_comments else []
        root, loose_reads = (
            (None, frozenset[Span]()) if self.source is None else (self.source.root, self.source.loose_reads)
        )
        settled = finalize_unit_findings(
            withdraw_shared_edits(self.findings, root, loose_reads),
            unit=self.unit,
            policy=self.policy,
            rules=load_rules(),
            comments=comments,
            root=root,
            texts=self.texts,
            joins_simulated=not self.options.drop,  # there it is what was asked for
            find_replaced_defaults=self.find_replaced_defaults,
            find_kinds_of_defaults=self.find_kinds_of_defaults,
        )
        usages = assess_comments(
            comments,
            needed=settled.needed_comments,
            texts=self.texts,
            unit=self.unit,
            source=self.source,
            checked_codes=self.policy.codes,
            # Of a model that was not checked nobody knows what its comments are for.
            skipped_codes={
                *(skip.code for skip in self.skipped),
                *self.policy.postponed,
                *(["ALL"] if self.unread_status else []),
            },
        )
        info = self.info
        if self.unread_status:
            cause = explain_unchecked(settled.findings, self.policy, self.options.reading)
            info = self.unit.describe_unread(cause, self.unread_status)
            if info is not None and self.source is not None:
                found = _locate_found_arguments(self.source)
                info = replace(info, args=dict(self.source.arguments), found_args=found)
            if not any(finding.blocks_check for finding in settled.findings):
                self.failures.append(f"{self.unit.id} could not be read, and no rule says why")
        named_files |= {usage.comment.span.file for usage in usages}
        sources, left_out = limit_texts({name: text for name, text in self.texts.items() if name in named_files})
        if left_out:
            self.add_skip(TEXTS_RULE, left_out, is_partial=True)
        scene, scene_size, undrawn = limit_scene(self.scene, self.unit.id)
        mechanism, uncompared = limit_mechanism(self.mechanism, self.unit.id)
        return UnitReport(
            findings=settled.findings,
            skipped=(*self.skipped, *settled.unlisted, *undrawn, *uncompared),
            info=None if info is None else replace(info, seconds=round(seconds, 3)),
            unrequested=settled.unrequested,
            findings_size=settled.size,
            scene=scene,
            scene_size=scene_size,
            pairs=self.pairs,
            drop=self.drop,
            mechanism=mechanism,
            index=self.index,
            seams=tuple(self.seams),
            outline=self.outline,
            sources=sources,
            digests={name: _digest_text(self.texts[name]) for name in named_files if name in self.texts},
            failures=tuple(self.failures),
            comments=usages,
            files=() if self.source is None else tuple(self.source.files),
            xacro_sources=self.find_xacro_sources({span.file for f in settled.findings if (span := f.location.span)}),
            srdf_files=self.srdf_files,
            expanded_files=frozenset() if self.source is None else frozenset(self.source.trees),
            robot_files=frozenset() if self.source is None else collect_robot_files(self.source),
            role=self.role,
            other_environments=tuple(self.other_environments),
            undeclared=None if self.source is None else _find_undeclared_arguments(self.source),
            is_read_in_part=self.source is not None and self.source.root is None,
        )

    def find_xacro_sources(self, names: Iterable[str]) -> dict[str, str]:
        """Return the paths from those of these files of the model that xacro wrote to their sources, as far as these are here.

        Where several files may be the source, it is the name that they share.
        """
        sources: dict[str, str] = {}
        source = self.source
        for name, file in () if source is None else source.files.items():
            written = read_xacro_source(file.text) if name in names else None
            found = [] if source is None or written is None else find_files_elsewhere(written, file.path, source.finder)
            if len(found) == 1:
                sources[name] = Path(os.path.relpath(found[0], file.path.parent)).as_posix()
            elif found:
                sources[name] = found[0].name
        return sources

    def read_named_files(self) -> set[str]:
        """Return the names of the files that findings point into, and read those that no check has read."""
        spans = (
            span
            for finding in self.findings
            for span in (finding.location.span, *finding.location.via, *(place.span for place in finding.related))
        )
        names = {span.file for span in spans if span is not None}
        if self.mechanism is not None:
            names |= self.mechanism.trace_files | self.mechanism.idle_lines.keys()
        for name in sorted(names - set(self.texts)):
            text = self.read_text(Path(name))
            if text is not None:
                self.texts[name] = text
        return names

    def read_text(self, path: Path) -> str | None:
        """Return the text of a file; None where it cannot or must not be read."""
        if not self.make_finder(Path(self.unit.path)).can_open(path):
            return None
        try:
            return read_regular(path).decode("utf-8", "replace")
        except OSError:
            return None


def _digest_text(text: str) -> str:
    return hashlib.blake2b(text.encode("utf-8", "surrogatepass"), digest_size=16).hexdigest()


def choose_simulation(policy: Policy, options: AuditOptions) -> str:
    """Return how long the simulator may run for a model: none | brief | full.

    A command asks for it, or the model is for MuJoCo, which is installed, and one of the rules that need it is selected.
    """
    if options.drop:
        return "full"
    if not options.simulate or SIMULATOR not in policy.targets or policy.tier != TIERS[-1]:
        return "none"
    is_wanted = any(code in policy.codes for code in list_simulated_rules())
    return "brief" if is_wanted and find_library_origin(SIMULATOR) is not None else "none"


@cache
def list_simulated_rules() -> tuple[str, ...]:
    """List the codes of the rules about models that need a simulator."""
    return tuple(c for c, rule in load_rules().items() if "simulator" in rule.needs and "model" in rule.scopes)


def _find_undeclared_arguments(source: Source) -> dict[str, str] | None:
    """Return what :attr:`UnitReport.undeclared` holds."""
    if source.root is None and not (source.is_xacro and source.trees):
        return None
    elements = iter_elements_by_tag(source.trees, "xacro:arg") if source.is_xacro else ()
    declared = {name for element in elements if (name := element.get("name")) is not None}
    from difflib import get_close_matches

    similar = {name: get_close_matches(name, declared, n=1) for name in source.arguments if name not in declared}
    return {
        name: found[0] if found else ""
        for name, found in similar.items()
        if name not in source.arguments_read  # $(arg name) works without a declaration
    }


@cache  # each unit asks about each rule
def find_missing_tier(needs: tuple[str, ...], tier: str) -> str | None:
    """Return the tier that the ``needs`` of a rule ask for, if more than ``tier``."""
    wanted = max((TIERS.index(_TIER_OF_NEED[need]) for need in needs), default=0)
    return TIERS[wanted] if wanted > TIERS.index(tier) else None


def _locate_found_arguments(source: Source) -> dict[str, str]:
    """Return the arguments that were found, not given, with the places, ``file:line``, that pass them."""
    places = {name: location.span for name, location in source.found_arguments.items()}
    return {name: f"{span.file}:{span.line}" for name, span in places.items() if span is not None}


def _describe_model(unit: Unit, source: Source, model: Model) -> ModelInfo:
    """Return the model's line in the report."""
    masses = [link.inertial.mass for link in model.links if link.inertial is not None]
    known_masses = [mass for mass in masses if mass is not None]
    return ModelInfo(
        path=format_path(Path(unit.path)),
        robot=model.name,
        args=dict(source.arguments),
        found_args=_locate_found_arguments(source),
        links=len(model.links),
        joints=len(model.joints),
        mass=round(sum(known_masses), 9) if known_masses else None,
        status="checked",
        id=unit.id,
    )
