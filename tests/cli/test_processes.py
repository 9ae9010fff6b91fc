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

from urdfcheck.cli import FINDINGS, OK
from urdfcheck.system.process_pool import WORKER_VARIABLES

COMMAND = [sys.executable, "-m", "urdfcheck"]
CAR = str(FIXTURES / "car-3" / "urdf" / "car-3.urdf")

pytestmark = [
    pytest.mark.slow,
    pytest.mark.long,
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
@pytest.mark.parametrize("after", [pytest.param(0.05, marks=pytest.mark.smoke), 0.8])
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
    script = Path(sys.executable).with_name("urdfcheck")
    if not script.exists():
        pytest.skip("urdfcheck is not installed as a command")
    # What Python itself imports at its start is beyond us: the command warns of it.
    early = subprocess.run(
        [sys.executable, "-c", "import sys; print(*sys.modules)"], capture_output=True, text=True
    ).stdout
    others = ("numpy", "rich", "platformdirs", "coal", "tomli", "yaml", "xacro", "xml", "py_landlock")
    early += " re _winapi nt"  # the script imports re, and .pth files ask for those of Windows
    names = {*sys.stdlib_module_names, *others} - {name.partition(".")[0] for name in early.split()}
    for name in names:
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'a').write(__name__ + ' ')")
    done = subprocess.run(
        [script, CAR, "--fail-on", "never"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": f"{tmp_path / 'nothing'}{os.pathsep}"},
        capture_output=True,
        text=True,
    )
    assert not (tmp_path / "ran").exists(), (tmp_path / "ran").read_text()
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(
    ("start", "path"),
    [
        (["urdfcheck"], os.pathsep),
        (["urdfcheck"], f"/opt/ros/lib{os.pathsep}"),
        (["urdfcheck"], "lib"),
        (["-m", "urdfcheck"], None),
        (["-P", "-m", "urdfcheck"], os.pathsep),
    ],
    ids=str,
)
def test_modules_that_python_may_have_run_are_told_and_refused_by_a_gate(
    tmp_path: Path, start: list[str], path: str | None
) -> None:
    if "-P" in start and sys.version_info < (3, 11):
        pytest.skip("this Python has no -P")
    folder = tmp_path / "lib" if path == "lib" else tmp_path
    folder.mkdir(exist_ok=True)
    (tmp_path / "robot.urdf").write_text('<robot name="r"><link name="base"/></robot>')
    for name in ("sitecustomize.py", "setup.py", "robot.py"):
        (folder / name).write_text("")
    (folder / "hashlib").mkdir()
    (folder / "hashlib/__init__.py").write_text("from _sha2 import *")

    def check(*words: str) -> subprocess.CompletedProcess[str]:
        script = (
            [str(Path(sys.executable).with_name("urdfcheck"))] if start == ["urdfcheck"] else [sys.executable, *start]
        )
        # A check in this process makes its children safe, too (WORKER_VARIABLES); here it is the user who starts one.
        own = {"PYTHONPATH", *WORKER_VARIABLES}
        environment = {name: value for name, value in os.environ.items() if name not in own}
        environment |= {} if path is None else {"PYTHONPATH": path}
        return subprocess.run([*script, *words], cwd=tmp_path, env=environment, capture_output=True, text=True)

    said = "Python may have run hashlib, sitecustomize.py of the working directory before urdfcheck began"
    done = check("robot.urdf", "--version")  # what comes after the warning does not depend on the start
    assert (done.returncode, said in done.stderr) == (0, True), done.stderr
    assert "start it as python -I -m urdfcheck" in done.stderr
    done = check("robot.urdf", "--isolated")
    assert (done.returncode, said in done.stderr, done.stdout) == (2, True, "")
    if start != ["-m", "urdfcheck"]:
        return
    done = check("robot.urdf", "--tier", "source")
    assert (done.returncode, said in done.stderr, "1 model" in done.stdout) == (0, True, True), done.stderr
    # What is checked lies elsewhere: the working directory is the user's own.
    elsewhere = tmp_path.parent / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "robot.urdf").write_text('<robot name="r"><link name="base"/></robot>')
    done = check(str(elsewhere / "robot.urdf"), "--tier", "source", "--isolated")
    assert (done.returncode, done.stderr) == (0, "")
    (folder / "sitecustomize.py").unlink()
    (folder / "hashlib/__init__.py").unlink()
    done = check("robot.urdf", "--tier", "source", "--isolated")
    assert (done.returncode, done.stderr) == (0, ""), "nothing there that Python would take for its own"


@pytest.mark.skipif(sys.platform != "linux", reason="a signal of Linux")
def test_workers_end_with_a_parent_that_is_killed(tmp_path: Path) -> None:
    words = [str(many_models(tmp_path)), "--no-cache", "--jobs", "2", "--timeout", "0"]
    process = subprocess.Popen(
        [*COMMAND, *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    )
    for _ in range(100):
        time.sleep(0.1)
        listed = subprocess.run(["ps", "-o", "pid=", "-g", str(process.pid)], capture_output=True, text=True).stdout
        if len(listed.split()) >= 3:  # the parent and its workers
            break
    else:
        pytest.fail("it has no workers")
    process.kill()
    process.wait()
    assert ended(process.pid)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_a_full_disk_is_said_and_no_finding() -> None:
    with open("/dev/full", "w") as full:
        done = subprocess.run([*COMMAND, CAR], stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 2
    assert done.stderr == "urdfcheck: cannot write the output: No space left on device\n"


@pytest.mark.skipif(sys.platform == "win32", reason="pipes of POSIX")
@pytest.mark.parametrize(("text", "code"), [("-1", FINDINGS), ("1", OK)])
def test_a_reader_that_exits_does_not_change_the_verdict(text: str, code: int, tmp_path: Path) -> None:
    """``urdfcheck . | head -1`` under pipefail: the gate holds, and a sound robot passes."""
    inertia = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
    links = "".join(
        f'<link name="l{i}"><inertial><mass value="{text}"/>{inertia}</inertial></link>'
        f'<joint name="j{i}" type="fixed"><parent link="base"/><child link="l{i}"/></joint>'
        for i in range(60)
    )
    (tmp_path / "r.urdf").write_text(f'<robot name="r"><link name="base"/>{links}</robot>')
    words = [sys.executable, "-m", "urdfcheck", "r.urdf", "--tier", "source", "--format", "json", "-o", "text=kept.txt"]
    process = subprocess.Popen(words, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert process.stdout is not None
    assert process.stderr is not None
    process.stdout.close()
    said = process.stderr.read()
    process.stderr.close()
    assert (process.wait(60), said) == (code, b"")
    assert (tmp_path / "kept.txt").stat().st_size, "the other reports are written all the same"
    listing = subprocess.Popen(
        [sys.executable, "-m", "urdfcheck", "rule"], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    )
    assert listing.stdout is not None
    listing.stdout.close()
    assert listing.wait(60) == 141, "nothing else is known of it"
