"""The command as a process: interrupted, terminated, without a reader, in a hostile folder."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import FIXTURES

COMMAND = [sys.executable, "-m", "urdfcheck"]
CAR = str(FIXTURES / "car-3" / "urdf" / "car-3.urdf")

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform == "win32", reason="signals and forks are those of POSIX"),
]


def many_models(folder: Path) -> Path:
    """Robots that take a while: every pair of links of each is compared."""
    links = "".join(
        f'<link name="l{i}"><collision><geometry><sphere radius="2"/></geometry></collision></link>' for i in range(60)
    )
    joints = "".join(
        f'<joint name="j{i}" type="continuous"><parent link="l{i - 1}"/><child link="l{i}"/></joint>'
        for i in range(1, 60)
    )
    for index in range(200):
        (folder / f"{index}.urdf").write_text(f'<robot name="r{index}">{links}{joints}</robot>')
    return folder


def ended(group: int) -> bool:
    """Whether no process of a group is left, at the latest after five seconds."""
    for _ in range(50):
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.1)
    return False


@pytest.mark.parametrize("signum", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("after", [0.05, 0.8])
def test_an_interrupted_run_leaves_neither_words_nor_files_nor_processes(
    tmp_path: Path, signum: signal.Signals, after: float
) -> None:
    temporary = tmp_path / "tmp"
    temporary.mkdir()
    models = tmp_path / "models"
    models.mkdir()
    process = subprocess.Popen(
        [*COMMAND, str(many_models(models)), "--no-cache", "--jobs", "2"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "TMPDIR": str(temporary)},
        start_new_session=True,
    )
    time.sleep(0.4 + after)  # Python itself cannot be interrupted quietly before it is there
    os.killpg(process.pid, signum)
    _, said = process.communicate(timeout=20)
    assert process.returncode not in {0, 1}
    assert "Traceback" not in said
    assert list(temporary.iterdir()) == []
    assert ended(process.pid)


def test_an_empty_entry_of_the_python_path_is_not_the_checked_folder(tmp_path: Path) -> None:
    for name in ("multiprocessing", "struct", "numpy", "rich", "platformdirs", "coal", "signal", "argparse"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('planted')")
    script = Path(sys.executable).with_name("urdfcheck")
    if not script.exists():
        pytest.skip("urdfcheck is not installed as a command")
    done = subprocess.run(
        [script, CAR, "--fail-on", "never"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": f"{tmp_path / 'nothing'}{os.pathsep}"},
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_a_full_disk_is_said_and_no_finding() -> None:
    with open("/dev/full", "w") as full:
        done = subprocess.run([*COMMAND, CAR], stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 2
    assert done.stderr == "urdfcheck: cannot write the output: No space left on device\n"
