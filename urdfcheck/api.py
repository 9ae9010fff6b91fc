"""Checks from Python: what the command does, with values instead of words and a `Run` instead of a report."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict

from urdfcheck.core import Run, UrdfcheckError
from urdfcheck.policy.consumers import ASKED_ENGINES
from urdfcheck.run.jobs import SAMPLES, Request
from urdfcheck.run.pipeline import AuditedRun, Execution, run_audit
from urdfcheck.run.preload import start_warm_worker
from urdfcheck.run.request import AnyPath, RunOptions, make_request, split_words
from urdfcheck.system import libraries
from urdfcheck.system.process_pool import WORKER_VARIABLES

if TYPE_CHECKING:
    from typing_extensions import Unpack  # of typing since Python 3.11

    from urdfcheck.core.model_diff import Diff

Words = str | Iterable[str]
Paths = AnyPath | Iterable[AnyPath]


def check(
    paths: Paths,
    *,
    select: Words | None = None,
    ignore: Words = (),
    target: Words | None = None,
    pedantic: bool = False,
    tier: str | None = None,
    unchecked: str | None = None,
    arguments: Mapping[str, str] | None = None,
    all_arguments: bool = False,
    packages: Mapping[str, AnyPath] | None = None,
    package_paths: Paths = (),
    allow_read: Paths = (),
    environment: Words = (),
    config: AnyPath | None = None,
    exclude: Iterable[str] = (),
    baseline: AnyPath | None = None,
    isolated: bool = False,
    samples: int = SAMPLES,
    jobs: int | None = None,
    cache: bool = True,
    timeout: float | None = None,
    memory: int | None = None,
    scene: bool = False,
) -> Run:
    """Check robot models, like ``urdfcheck check``, and return the outcome.

    The configuration of each file (``urdfcheck.toml``, ``pyproject.toml``) counts as it does for the command; what is given
    here wins over it. The models are checked in separate processes, which are forked where the platform supports it:
    call it from a notebook, from a test or from a script. On Windows they are spawned, and a script needs
    ``if __name__ == "__main__":`` as for :mod:`multiprocessing`.

    >>> import urdfcheck
    >>> run = urdfcheck.check("fixtures/car-3/urdf/car-3.urdf", select=["SYM001", "INR003"])
    >>> [model.robot for model in run.models]
    ['car-3']
    >>> for finding in run.active_findings:
    ...     print(finding.code, finding.severity, finding.location.span.line, *finding.subjects)
    SYM001 warning 88 joint[wheel_1_to_base_link]/origin@rpy

    :param paths: models (URDF, xacro), launch files, meshes, packages and folders, or a single one of them. Paths in the
        outcome are relative to the working directory.
    :param select: codes, prefixes, names and tags of the only rules to run; comma-separated or one by one.
    :param ignore: those of the rules not to run.
    :param target: programs that will read the models (gazebo, mujoco, drake, moveit, …): what one of them rejects or drops
        is an error. None: the configuration decides.
    :param pedantic: whether to report every note, and as warnings those that most maintainers would switch off.
    :param tier: how much is computed: ``source`` (the text), ``mesh`` (and the mesh files) or ``full`` (and the motion). None:
        the configuration decides; by default ``full``.
    :param unchecked: how bad it is that a model cannot be checked: ``error`` or ``warning``, which accepts it. None: the
        configuration decides; by default ``error``.
    :param arguments: values of xacro arguments, for all models.
    :param all_arguments: whether to expand each xacro with all values that its text gives for its arguments.
    :param packages: folder of each ROS package that would not be found, by its name.
    :param package_paths: folders that hold packages.
    :param allow_read: folders whose files may be opened, besides those around the paths and packages.
    :param environment: names of environment variables that a xacro may read.
    :param config: the configuration of everything that is checked; None: the nearest one above each file.
    :param exclude: patterns of files and folders that are skipped too when a folder is checked, relative to the working
        directory.
    :param baseline: file of accepted findings; None: the one beside the configuration.
    :param isolated: whether to ignore configurations, comments and baselines of the repository, which may be untrusted.
    :param samples: number of joint configurations (joint positions drawn within the limits) in which motion is examined.
    :param jobs: number of models checked at the same time; None: the number of cores.
    :param cache: whether to keep measurements of meshes and findings between runs.
    :param timeout: seconds for one model; 0: unlimited; None: 300.
    :param memory: MiB for one model, at least 512; None: 4096.
    :param scene: whether the outcome holds what graphical formats draw (``html``, ``png``).
    :returns: the outcome. `Run.findings` holds all findings, `Run.active_findings` those that are not suppressed;
        `Run.unchecked_models` are the models of which nothing is known, and `Run.failures` says what else went wrong, paths
        that do not exist included: only where both are empty, no finding is good news.
    :raises UrdfcheckError: for a wrong argument or configuration. What is wrong with a model is a finding.
    :raises KeyboardInterrupt: when the user interrupts.
    """
    options = _make_options(
        _list_paths(paths),
        select=select,
        ignore=ignore,
        target=target,
        arguments=arguments,
        packages=packages,
        package_paths=package_paths,
        allow_read=allow_read,
        environment=environment,
        pedantic=pedantic,
        tier=tier,
        unchecked=unchecked,
        all_arguments=all_arguments,
        config=config,
        exclude=tuple(exclude),
        baseline=baseline,
        isolated=isolated,
        samples=samples,
        jobs=jobs,
        cache=cache,
        timeout=timeout,
        memory=memory,
    )
    return _run(options, scene=scene)


def diff(
    before: AnyPath,
    after: AnyPath,
    *,
    select: Words | None = None,
    ignore: Words = (),
    target: Words | None = None,
    tier: str | None = None,
    arguments: Mapping[str, str] | None = None,
    all_arguments: bool = False,
    packages: Mapping[str, AnyPath] | None = None,
    package_paths: Paths = (),
    allow_read: Paths = (),
    environment: Words = (),
    isolated: bool = False,
    jobs: int | None = None,
    cache: bool = True,
    timeout: float | None = None,
    memory: int | None = None,
) -> Diff:
    """Compare two versions of a robot, like ``urdfcheck diff``: structure, motion, limits, mass, shapes and findings.

    Like :func:`check` it reads the models in separate processes.

    >>> import urdfcheck
    >>> found = urdfcheck.diff("fixtures/car-3/urdf/car-3.urdf", "fixtures/car-3/urdf/car-3.urdf", select="INR003")
    >>> found.verdict
    'identical'

    :param before: the first version: a model, a package or a folder.
    :param after: the second version. Models of two folders are matched by path, then by name, then by structure.
    :returns: the differences. `Diff.verdict` is the word of the most important one: ``structure``, ``kinematic``, ``limits``,
        ``dynamic``, ``collision``, ``visual``, ``extension``, ``cosmetic``, ``identical``, or ``unknown`` where a version gives
        no robot, which `Diff.failures` explains. `Diff.models` holds the changes of each model, `Diff.findings` what the
        checks of the two versions report differently. The other parameters are those of :func:`check` and hold for both
        versions.
    :raises UrdfcheckError: for a wrong argument or configuration, and for a path that does not exist or has no model.
    :raises KeyboardInterrupt: when the user interrupts.
    """
    from urdfcheck.changes.compare_versions import compare_versions

    sides = [
        _make_options(
            (path,),
            select=select,
            ignore=ignore,
            target=target,
            arguments=arguments,
            packages=packages,
            package_paths=package_paths,
            allow_read=allow_read,
            environment=environment,
            tier=tier,
            all_arguments=all_arguments,
            isolated=isolated,
            jobs=jobs,
            cache=cache,
            timeout=timeout,
            memory=memory,
        )
        for path in (before, after)
    ]
    if any(not os.fspath(path) for path in (before, after)):
        raise UrdfcheckError("a path is empty ('.' is the working directory)")
    requests = [make_request(options)[0] for options in sides]
    with prepare_worker_surroundings():
        warm_worker = start_warm_worker()
        try:
            return compare_versions(requests[0], requests[1], Execution(warm_worker=warm_worker))
        finally:
            if warm_worker is not None:
                warm_worker.end()


class DiffSettings(TypedDict, total=False):
    """What :func:`diff_commits` takes of the parameters of :func:`diff`, which explains them."""

    select: Words | None
    ignore: Words
    target: Words | None
    tier: str | None
    arguments: Mapping[str, str] | None
    all_arguments: bool
    packages: Mapping[str, AnyPath] | None
    package_paths: Paths
    allow_read: Paths
    environment: Words
    isolated: bool
    jobs: int | None
    cache: bool
    timeout: float | None
    memory: int | None


def diff_commits(
    revisions: str = "", paths: Paths = (), *, repository: AnyPath = ".", **settings: Unpack[DiffSettings]
) -> Diff:
    """Compare two states of a git repository, like ``urdfcheck diff REV..REV -- PATH``.

    Only models that a change can touch are read. Nothing is checked out, and nothing of the repository is run.

    :param revisions: ``REV`` to compare a revision with the work tree, ``REV..REV`` to compare two, ``REV...REV`` to begin at
        their common ancestor; empty for HEAD.
    :param paths: the only models, packages and files that models use; none for all.
    :param repository: a folder in the repository.
    :param settings: further parameters of :func:`diff`. Paths in the repository lead to each of the two states.
    :returns: see :func:`diff`.
    :raises UrdfcheckError: for a wrong argument or configuration, and where there is no repository or revision.
    :raises KeyboardInterrupt: when the user interrupts.
    """
    from urdfcheck.changes.commits.compare_states import compare_states

    def make_state_request(folder: Path, translate: Callable[[str], str]) -> Request:
        def move(path: AnyPath) -> str:
            return translate(os.fspath(path))

        packages = {name: move(place) for name, place in (settings.get("packages") or {}).items()}
        moved: dict[str, Any] = {
            "select": None,
            "ignore": (),
            "target": None,
            "arguments": None,
            "environment": (),
            **settings,
            "packages": packages,
            "package_paths": tuple(map(move, _list_paths(settings.get("package_paths", ())))),
            "allow_read": tuple(map(move, allowed)),
        }
        return make_request(_make_options((folder,), **moved))[0]

    allowed = _list_paths(settings.get("allow_read", ()))
    with prepare_worker_surroundings():
        return compare_states(
            revisions,
            [os.fspath(path) for path in _list_paths(paths)],
            make_state_request,
            around=Path(repository),
            allowed=[os.fspath(path) for path in allowed],
        )


def run_and_ask(request: Request, execution: Execution) -> Run:
    """Check what the request's paths lead to, and ask the engines that are targets, which no other run does."""
    return ask_engines(run_audit(request, execution))


def ask_engines(audited: AuditedRun) -> Run:
    """Return the outcome of a run with the answers of the engines that are targets."""
    outcome = audited.outcome
    targets = {*outcome.targets, *(name for names in outcome.targets_by_unit.values() for name in names)}
    if targets.isdisjoint(ASKED_ENGINES) or outcome.partial:
        return outcome
    from urdfcheck.simulators.target_answers import ask_targets

    return ask_targets(audited)


def _run(options: RunOptions, *, scene: bool) -> Run:
    """Check the options, then run what they describe.

    :raises UrdfcheckError: for a wrong argument or configuration.
    :raises KeyboardInterrupt: when the user interrupts.
    """
    if not options.paths:
        raise UrdfcheckError("paths: name at least one model, launch file, package or folder")
    if any(not os.fspath(path) for path in options.paths):
        raise UrdfcheckError("a path is empty ('.' is the working directory)")
    if options.samples < 1:
        raise UrdfcheckError(f"samples {options.samples}: at least 1")
    request, _ = make_request(options, scene=scene)
    with prepare_worker_surroundings():
        warm_worker = start_warm_worker(options.tier)
        try:
            outcome = run_and_ask(request, Execution(warm_worker=warm_worker))
        finally:
            if warm_worker is not None:
                warm_worker.end()
    if outcome.partial:
        raise KeyboardInterrupt
    return outcome


def _make_options(
    paths: tuple[AnyPath, ...],
    *,
    select: Words | None,
    ignore: Words,
    target: Words | None,
    arguments: Mapping[str, str] | None,
    packages: Mapping[str, AnyPath] | None,
    package_paths: Paths,
    allow_read: Paths,
    environment: Words,
    **others: Any,
) -> RunOptions:
    """Return what a caller asks for; ``others`` are fields of `RunOptions` as they are."""
    return RunOptions(
        paths=paths,
        select=None if select is None else _list_words(select),
        ignore=_list_words(ignore),
        target=None if target is None else _list_words(target),
        arguments={name: str(value) for name, value in (arguments or {}).items()},
        packages=packages or {},
        package_paths=_list_paths(package_paths),
        allow_read=_list_paths(allow_read),
        environment=_list_words(environment),
        **others,
    )


def _list_words(words: Words) -> tuple[str, ...]:
    return split_words([words] if isinstance(words, str) else words)


def _list_paths(paths: Paths) -> tuple[AnyPath, ...]:
    return (paths,) if isinstance(paths, (str, os.PathLike)) else tuple(paths)


@contextlib.contextmanager
def prepare_worker_surroundings() -> Iterator[None]:
    """Give worker processes the import path and the variables that they need, and the caller its own back."""
    path = [*sys.path]
    unset = [name for name in WORKER_VARIABLES if name not in os.environ]
    libraries.prefer_own_folders()
    try:
        yield
    finally:
        sys.path[:] = path
        for name in unset:
            os.environ.pop(name, None)
