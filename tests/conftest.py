"""What all tests share."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from urdfcheck.core import Run
from urdfcheck.engine import Request, run
from urdfcheck.source.packages import LEVELS_UP
from urdfcheck.worker import audit

REPOSITORY = Path(__file__).parent.parent
FIXTURES = REPOSITORY / "fixtures"


def check(*paths: Path, codes: set[str] | None = None, **request: object) -> Run:
    """Check paths in this process, with all rules or the given codes."""
    from urdfcheck import catalogue

    selected = frozenset(catalogue.rules()) if codes is None else frozenset(codes)
    root = paths[0] if paths[0].is_dir() else paths[0].parent
    return run(Request(tuple(paths), root, selected, **request), audit=audit)  # type: ignore[arg-type]


def check_text(folder: Path, text: str, name: str = "robot.urdf", **request: object) -> Run:
    """Check one file with this text."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return check(path, **request)  # type: ignore[arg-type]


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--accept", action="store_true", help="write the goldens anew; review them as a diff")


@pytest.fixture
def tmp_path(tmp_path: Path) -> Path:
    """A folder of the test's own, and deeper than packages are looked for around a model: not among those of other tests."""
    deep = tmp_path.joinpath(*"abcdefg"[: LEVELS_UP + 1])
    deep.mkdir(parents=True)
    return deep


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


@pytest.fixture(scope="session")
def corpus() -> Path:
    """The folder of real robots named by URDFCHECK_CORPUS; tests that need it are skipped without it."""
    folder = os.environ.get("URDFCHECK_CORPUS")
    if not folder or not (Path(folder) / "corpus.json").is_file():
        pytest.skip("URDFCHECK_CORPUS names no folder with a corpus.json")
    return Path(folder)
