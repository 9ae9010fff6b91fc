"""Faults of the machine: killed workers, damaged and full disks, an interrupt, many runs at once. Nothing is lost and nothing
is wrong: what could be checked is reported as always, and what could not is named."""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from conftest import FIXTURES, command

from urdfcheck.run import pipeline

QUICK = ["--tier", "mesh", "--format", "json", "--fail-on", "never"]
# As many runs on one cache at the same time; 200 were tried with URDFCHECK_RUNS=200.
RUNS = int(os.environ.get("URDFCHECK_RUNS", "4"))

pytestmark = [
    pytest.mark.slow,
    pytest.mark.long,
    pytest.mark.skipif(sys.platform == "win32", reason="signals, mounts and process files are those of POSIX"),
]


@pytest.fixture(scope="module")
def models(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four robots: the real one with its meshes, each with a name of its own."""
    folder = tmp_path_factory.mktemp("faults") / "models"
    for index in range(4):
        one = folder / f"robot_{index:02}"
        shutil.copytree(FIXTURES / "car-3" / "meshes", one / "meshes")
        text = (FIXTURES / "car-3" / "urdf" / "car-3.urdf").read_text(encoding="utf-8")
        text = text.replace("package://car-3/", "").replace('name="car-3"', f'name="car_{index}"')
        (one / "robot.urdf").write_text(text, encoding="utf-8")
    return folder


def checked(*words: object, cache: Path) -> subprocess.CompletedProcess[str]:
    return command(*map(str, words), *QUICK, **environment(cache))


def started(*words: object, cache: Path, **options: Any) -> subprocess.Popen[str]:
    """The command in a process of its own, which can be ended."""
    return subprocess.Popen(
        [sys.executable, "-m", "urdfcheck", *map(str, words)],
        env={**os.environ, **environment(cache)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        **options,
    )


def environment(cache: Path) -> dict[str, str]:
    return {"URDFCHECK_CACHE_DIR": str(cache), "SOURCE_DATE_EPOCH": "0"}


def report(done: subprocess.CompletedProcess[str] | str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(done if isinstance(done, str) else done.stdout)
    return found


@pytest.fixture(scope="module")
def all_of_them(models: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What an undisturbed run says of all robots."""
    return report(checked(models, "--jobs", 2, cache=tmp_path_factory.mktemp("undisturbed")))


@pytest.fixture(scope="module")
def one_of_them(models: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What an undisturbed run says of the first."""
    return report(checked(models / "robot_00", "--no-cache", cache=tmp_path_factory.mktemp("undisturbed")))


def children(pid: int) -> list[int]:
    try:
        return [int(word) for word in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except OSError:
        return []


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="the workers of a process are found in /proc")
@pytest.mark.parametrize("finished", [0, 1])
def test_a_worker_that_is_killed_takes_one_model_along_and_no_other(
    models: Path, all_of_them: dict[str, Any], tmp_path: Path, finished: int
) -> None:
    """At the start, and when so many models are finished."""
    whole, cache = all_of_them, tmp_path / "cache"
    process = started(models, "--jobs", 2, *QUICK, cache=cache)
    while process.poll() is None and not (children(process.pid) and kept(cache) >= finished):
        time.sleep(0.01)
    hit = [pid for pid in children(process.pid)[-1:] if _kill(pid)]
    out, said = process.communicate(timeout=120)
    assert "Traceback" not in said
    if not out:  # it was the process that looks for models: then nothing is known of any
        assert process.returncode == 2
        assert "the process that looks for models was killed (SIGKILL" in said
        return
    found = report(out)
    failed = {m["id"] for m in found["models"] if m["status"] == "failed"}
    assert len(failed) <= len(hit)
    assert process.returncode == (2 if failed else 0)
    assert [f for f in found["failures"] if "SIGKILL" not in f] == []
    # What is said of all others is what is always said.
    assert [f for f in found["findings"] if f["model"]] == [
        f for f in whole["findings"] if f["model"] and f["model"] not in failed
    ]
    # And the next run finds nothing that the killed one left half done.
    assert report(checked(models, cache=cache)) == whole


def killed(*_: object) -> None:
    _kill(os.getpid())


def test_of_models_that_were_not_found_nothing_is_known(
    models: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pipeline, "_discover_bounded", killed)
    done = checked(models, cache=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert "the process that looks for models was killed (SIGKILL" in done.stderr


def kept(cache: Path) -> int:
    """How many models are finished: their findings are in the cache."""
    return len(list(cache.glob("*/findings/*/*")))


def _kill(pid: int) -> bool:
    try:
        os.kill(pid, signal.SIGKILL)
    except ProcessLookupError:
        return False
    return True


def test_an_interrupt_reports_what_was_finished(models: Path, tmp_path: Path) -> None:
    many = tmp_path / "models"
    for index in range(30):
        shutil.copytree(models / "robot_00", many / f"robot_{index:02}", copy_function=os.link)
    process = started(
        *(many, "--jobs", 2, "--format", "json"),
        cache=tmp_path / "cache",
        start_new_session=True,
    )
    for _ in range(600):  # until some are finished
        if kept(tmp_path / "cache") > 3:
            break
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGINT)
    out, said = process.communicate(timeout=60)
    assert process.returncode == 2, said
    found = report(out)
    assert found["partial"] is True
    assert 0 < len(found["models"]) < 30
    assert {m["status"] for m in found["models"]} == {"checked"}
    assert f"{len(found['models'])} of 30" in found["failures"][-1]


def damage(path: Path, chance: random.Random) -> None:
    data = path.read_bytes()
    how = chance.randrange(4)
    if how == 0:
        path.write_bytes(data[: chance.randrange(len(data) + 1)])
    elif how == 1:
        path.write_bytes(chance.randbytes(len(data)))
    elif how == 2:
        place = chance.randrange(max(len(data), 1))
        path.write_bytes(data[:place] + chance.randbytes(8) + data[place + 8 :])
    else:
        path.unlink()
        path.mkdir()


@pytest.mark.smoke
def test_a_damaged_cache_changes_nothing(models: Path, tmp_path: Path) -> None:
    cache = tmp_path / "cache"
    whole = report(checked(models / "robot_00", models / "robot_01", cache=cache))
    chance = random.Random(1)
    for path in sorted(p for p in cache.rglob("*") if p.is_file()):
        if chance.random() < 0.6:
            damage(path, chance)
    assert report(checked(models / "robot_00", models / "robot_01", cache=cache)) == whole
    assert report(checked(models / "robot_00", models / "robot_01", cache=cache)) == whole


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of 64 kB."""
    place = tmp_path / "disk"
    place.mkdir()
    made = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", place], capture_output=True, check=False)
    if made.returncode:
        pytest.skip("only root may mount a small disk")
    yield place
    subprocess.run(["umount", "-l", place], check=True)


def test_a_cache_on_a_full_disk_changes_nothing(models: Path, one_of_them: dict[str, Any], small_disk: Path) -> None:
    for _ in range(2):
        assert report(checked(models / "robot_00", cache=small_disk)) == one_of_them


def test_a_read_only_cache_changes_nothing(models: Path, one_of_them: dict[str, Any], small_disk: Path) -> None:
    assert report(checked(models / "robot_00", cache=small_disk)) == one_of_them
    subprocess.run(["mount", "-o", "remount,ro", small_disk], check=True)
    assert report(checked(models / "robot_00", cache=small_disk)) == one_of_them


def test_a_report_is_whole_or_not_there(models: Path, tmp_path: Path, small_disk: Path) -> None:
    report_file = small_disk / "report.html"
    report_file.write_text("the report before")
    done = checked(models / "robot_00", "-o", f"html={report_file}", cache=tmp_path / "cache")
    assert done.returncode == 2
    assert "No space left on device" in done.stderr
    assert [p.name for p in small_disk.iterdir()] == ["report.html"]
    assert report_file.read_text() == "the report before"


def test_many_runs_share_one_cache(models: Path, one_of_them: dict[str, Any], tmp_path: Path) -> None:
    """All begin at once on an empty cache, while another process keeps deleting from it."""
    cache = tmp_path / "cache"
    runs = [started(models / "robot_00", *QUICK, cache=cache) for _ in range(RUNS)]
    chance = random.Random(1)
    while any(run.poll() is None for run in runs[:4]):
        for path in [p for p in cache.rglob("*.npz") if chance.random() < 0.1]:
            path.unlink(missing_ok=True)
        time.sleep(0.05)
    for run in runs:
        out, said = run.communicate(timeout=600)
        assert (run.returncode, said) == (0, "")
        assert report(out) == one_of_them
    left = [p.name for p in cache.rglob("*") if p.name.startswith(".")]
    assert left == []
