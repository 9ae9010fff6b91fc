"""What all tests share."""

from __future__ import annotations

import contextlib
import gc
import io
import itertools
import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import warnings
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, NoReturn, TypeVar

import pytest
from filelock import FileLock
from hypothesis import settings

from urdfcheck import cli
from urdfcheck.core import Run
from urdfcheck.core.findings import iter_occurrences
from urdfcheck.policy.policy import Policy
from urdfcheck.rules import has_check, load_check, load_rules
from urdfcheck.run.jobs import AuditOptions, PackageFolders, Request
from urdfcheck.run.pipeline import IN_THIS_PROCESS, run
from urdfcheck.run.preload import preload_modules
from urdfcheck.source.package.finder import LEVELS_UP
from urdfcheck.system import process_pool, sandbox
from urdfcheck.system.plain_pickle import load_plain

REPOSITORY = Path(__file__).parent.parent
FIXTURES = REPOSITORY / "fixtures"

# Whether tests take every real robot and mesh, and more examples of each property.
IS_FULL = bool(os.environ.get("URDFCHECK_FULL"))

# No test fails because a machine is slow. Each run tries other examples; what one misses, one of the next finds.
settings.register_profile("urdfcheck", deadline=None, max_examples=40 if IS_FULL else 15)
settings.load_profile("urdfcheck")

# Many tests start a Python: none of them compiles our modules anew.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# The processes of the tests share the cores as those of the command do: threads of BLAS would only compete.
process_pool.limit_threads()

# Thousands of tests are made and none is thrown away: looking for garbage among them takes a fifth of the collection.
gc.disable()


def make_request(*paths: Path, codes: Iterable[str] | None = None, **settings: Any) -> Request:
    """A request for paths, with all rules or the given codes; each further setting goes where it belongs: to the policy, the
    options of the audit or the request itself."""
    packages = PackageFolders(settings.pop("packages", {}), settings.pop("package_paths", ()))
    policy, options = (
        {field.name: settings.pop(field.name) for field in fields(kind) if field.name in settings}
        for kind in (Policy, AuditOptions)
    )
    root = paths[0] if paths[0].is_dir() else paths[0].parent
    return Request(
        paths=paths,
        root=settings.pop("root", root),
        policy=Policy(codes=frozenset(load_rules() if codes is None else codes), **policy),
        options=AuditOptions(**options),
        packages=packages,
        **settings,
    )


def check(*paths: Path, codes: set[str] | None = None, **settings: object) -> Run:
    """Check paths in this process, with all rules or the given codes; see `make_request`."""
    checked = run(make_request(*paths, codes=codes, **settings), IN_THIS_PROCESS)
    for finding in iter_occurrences(checked.findings):
        # Words that refer to the edits need some.
        assert finding.fix is None or finding.fix.edits or "the computed numbers" not in finding.fix.title, finding
    return checked


def list_machine_paths(run_: Run, folder: Path) -> list[str]:
    """Return the texts of a run's findings that hold the absolute path of a folder."""
    absolute = re.compile(rf"(?<![\w.]){re.escape(str(folder))}")  # not the end of a relative one

    def walk(value: object) -> Iterator[str]:
        if isinstance(value, (str, Path)):
            yield str(value)
        elif isinstance(value, Mapping):
            yield from walk([*value, *value.values()])
        elif isinstance(value, (list, tuple, set, frozenset)):
            for inner in value:
                yield from walk(inner)
        elif is_dataclass(value):
            yield from walk([getattr(value, field.name) for field in fields(value)])

    return [text for finding in (*run_.findings, *run_.skipped) for text in walk(finding) if absolute.search(text)]


def check_text(folder: Path, text: str, name: str = "robot.urdf", **request: object) -> Run:
    """Check one file with this text."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return check(path, **request)  # type: ignore[arg-type]


def command(*words: str, cwd: Path | None = None, **environment: str) -> subprocess.CompletedProcess[str]:
    """The command, called in this process, with workers of its own: what it wrote, what it said, and its exit code."""
    out, said = io.StringIO(), io.StringIO()
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(out), contextlib.redirect_stderr(said):
        if cwd is not None:
            patch.chdir(cwd)
        for name, value in environment.items():
            patch.setenv(name, value)
        try:
            code = cli.main(words)
        except SystemExit as end:  # argparse's
            code = int(end.code or 0)
    return subprocess.CompletedProcess(words, code, out.getvalue(), said.getvalue())


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--accept", action="store_true", help="write the goldens anew; review them as a diff")


def pytest_collection_finish() -> None:
    """Many tests fork: what a worker process loads is loaded once, and no process looks through thousands of tests for
    garbage."""
    preload_modules()
    for rule in load_rules().values():
        if has_check(rule):
            load_check(rule)
    gc.collect()
    gc.freeze()
    gc.set_threshold(200_000, 30, 30)  # as the command does
    gc.enable()


def pytest_xdist_auto_num_workers() -> int:
    """As many processes as cores: many tests start processes themselves, and on two cores three took 18 % longer than two.

    With folders of real robots half as many again: their tests wait for each other, and two took 66 % longer than three.
    """
    cores = os.cpu_count() or 1
    return cores * 3 // 2 if CORPORA else cores


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with what takes long, so that no process is left alone with it at the end: real robots, which tests of all
    processes share, then the modules that are marked slow; of these first the ones about the whole program, beside this file:
    a single run on all hostile files takes half a minute.

    Each process begins with an equal stretch of the list, so each stretch gets its share of all of them.
    """

    def rank(item: pytest.Item) -> int:
        if {"corpus", "robots"} & set(getattr(item, "fixturenames", ())):
            return 0
        if not item.get_closest_marker("slow"):
            return 3
        return 1 if item.path.parent == REPOSITORY / "tests" else 2

    processes = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    kinds: list[list[pytest.Item]] = [[], [], [], []]
    for item in items:
        kinds[rank(item)].append(item)
    items[:] = [
        item
        for process in range(processes)
        for kind in kinds
        for item in kind[process * len(kind) // processes : (process + 1) * len(kind) // processes]
    ]


FAILED = pytest.StashKey[bool]()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    item.stash[FAILED] = item.stash.get(FAILED, False) or report.failed
    return report


class DeepFolders:
    """Folders for the tests of this process, one after the other, deeper than packages are looked for around a model: not
    among those of other tests.

    The levels above a test's folder serve all tests: to make and remove them for each takes as long as most tests do. They are
    left behind where a test failed, with its folder in them, or put something else there.
    """

    def __init__(self, top: Path) -> None:
        self.top = top
        self.numbers = itertools.count()
        self.above: Path | None = None

    def make(self) -> Path:
        """Make the folder of a test."""
        if self.above is None:
            self.above = self.top.joinpath(f"deep_{next(self.numbers)}", *"abcdef"[: LEVELS_UP - 1])
            self.above.mkdir(parents=True)
        folder = self.above / f"test_{next(self.numbers)}"
        folder.mkdir()
        return folder

    def remove(self, folder: Path, *, failed: bool) -> None:
        """Remove the folder of a test, unless it failed."""
        if not failed:
            shutil.rmtree(folder, ignore_errors=True)
        if os.listdir(folder.parent):
            self.above = None


@pytest.fixture(scope="session")
def deep_folders(tmp_path_factory: pytest.TempPathFactory) -> DeepFolders:
    return DeepFolders(tmp_path_factory.getbasetemp())


@pytest.fixture
def tmp_path(request: pytest.FixtureRequest, deep_folders: DeepFolders) -> Iterator[Path]:
    """A folder of the test's own. It stays where the test failed.

    Removed here, because pytest's own removal of the last run but two comes at the end and takes ten seconds of one core.
    """
    folder = deep_folders.make()
    yield folder
    deep_folders.remove(folder, failed=request.node.stash.get(FAILED, False))


@pytest.fixture(autouse=True)
def _no_ros(monkeypatch: pytest.MonkeyPatch) -> None:
    """A sourced ROS installation must not decide a test."""
    for variable in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
        monkeypatch.delenv(variable, raising=False)


@pytest.fixture(autouse=True, scope="session")
def _own_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """No test reads or writes what the user's runs keep."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("URDFCHECK_CACHE_DIR", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(autouse=True, scope="session")
def _interruptible() -> Iterator[None]:
    """Let SIGINT raise KeyboardInterrupt here and in every program that a test starts. Python installs no handler where the
    signal is ignored at its start, as it is for what a shell runs in the background (``nohup make test &``)."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture
def one_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """The command does all of its work in this process, for tests whose point is not the workers. What goes to one and comes
    back goes through the same gate; that this process gives nothing up is the only difference."""

    def in_turn(
        function: Callable[..., Any], jobs: Sequence[Sequence[object]], *_: object, **__: object
    ) -> Iterator[tuple[int, Any]]:
        for index, job in enumerate(jobs):
            called, words = pickle.loads(pickle.dumps((function, job)))
            yield index, load_plain(io.BytesIO(pickle.dumps(called(*words))))

    monkeypatch.setattr(process_pool, "FORKS", False)
    for module in ("run.pipeline", "changes.compare_versions", "fix.repair.repair_model"):
        monkeypatch.setattr(f"urdfcheck.{module}.map_in_processes", in_turn)
    monkeypatch.setattr(sandbox, "confine", lambda *_: None)
    monkeypatch.setattr(sandbox, "limit_memory", lambda _: None)


T = TypeVar("T")


def get_shared_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of all processes of the tests."""
    base = tmp_path_factory.getbasetemp()
    return base.parent if "PYTEST_XDIST_WORKER" in os.environ else base


def make_once(name: str, make: Callable[[Path], T], tmp_path_factory: pytest.TempPathFactory) -> T:
    """What ``make`` returns, for all tests of all processes: the first that asks makes it, in a folder that stays."""
    kept = get_shared_folder(tmp_path_factory) / f"{name}.pickle"
    with FileLock(f"{kept}.lock"):
        if not kept.exists():
            kept.write_bytes(pickle.dumps(make(tmp_path_factory.mktemp(name))))
    found: T = pickle.loads(kept.read_bytes())
    return found


def unproven(what: str) -> NoReturn:
    """Skip what cannot be proven here, and say so louder than a skip does."""
    warnings.warn(f"NOT TESTED: {what}", stacklevel=2)
    pytest.skip(what)


@pytest.fixture(scope="module")
def launch() -> Iterator[Callable[..., Any]]:
    """Starts a browser: the one that URDFCHECK_BROWSER names, the system's Chromium or Chrome, else Playwright's own."""
    playwright = pytest.importorskip("playwright.sync_api")
    names = ("chromium", "chromium-browser", "google-chrome")
    found = os.environ.get("URDFCHECK_BROWSER") or next(filter(None, map(shutil.which, names)), None)
    with playwright.sync_playwright() as p:

        def start(*flags: str) -> Any:
            try:
                return p.chromium.launch(executable_path=found, args=["--no-sandbox", *flags])
            except playwright.Error as error:
                if "CI" in os.environ:
                    raise
                reason = str(error).strip().splitlines()[0]
                return unproven(
                    f"the report in a browser: {reason} (sudo apt install chromium, or playwright install chromium)"
                )

        yield start


@pytest.fixture(scope="module")
def browser(launch: Callable[..., Any]) -> Iterator[Any]:
    """A browser that draws WebGL without a graphics card."""
    browser = launch("--enable-unsafe-swiftshader")
    yield browser
    browser.close()


@contextlib.contextmanager
def open_watched(browser: Any, report: Path) -> Iterator[Any]:
    """Open a report with a robot in 3D; a script of it that fails, or asks for anything outside of it, fails the test."""
    page = browser.new_page(viewport={"width": 1280, "height": 800}, reduced_motion="reduce", color_scheme="light")
    wrong: list[str] = []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("request", lambda request: None if is_inside(request.url) else wrong.append(request.url[:80]))
    page.goto(report.as_uri())
    page.wait_for_selector("body[data-ready='1']")
    yield page
    page.close()
    assert wrong == []


def is_inside(address: str) -> bool:
    """Whether an address is of the page itself, and not of another server."""
    return address.startswith(("file:", "blob:", "data:"))


CORPORA = [Path(folder) for folder in os.environ.get("URDFCHECK_CORPUS", "").split(os.pathsep) if folder]


@pytest.fixture(scope="session", params=CORPORA or [None], ids=lambda folder: folder.name if folder else "no-corpus")
def corpus(request: pytest.FixtureRequest) -> Path:
    """Each folder of real robots that URDFCHECK_CORPUS names, separated as in PATH; without one its tests are skipped.

    Of a folder without a corpus.json, such as one of whole repositories, only engines are asked (test_simulators).
    """
    folder: Path | None = request.param
    if folder is None:
        pytest.skip("URDFCHECK_CORPUS names no folder with a corpus.json")
    assert folder.is_dir(), f"URDFCHECK_CORPUS names {folder}, which is no folder"
    if not (folder / "corpus.json").is_file():
        pytest.skip(f"{folder} has no corpus.json")
    return folder
