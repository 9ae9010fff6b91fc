"""Nothing is written or read through links, pipes and devices of what is checked."""

from __future__ import annotations

import json
import os
import sys
import threading
from pathlib import Path

import pytest
from conftest import command as urdfcheck

from urdfcheck import cli
from urdfcheck.cli.output_files import CheckedFolders

pytestmark = [
    pytest.mark.slow,
    pytest.mark.usefixtures("one_process"),
    pytest.mark.skipif(sys.platform == "win32", reason="links need rights on Windows"),
]

SOUND = '<robot name="r"><link name="base"/></robot>'
QUICK = ("--tier", "source")


@pytest.fixture
def elsewhere(tmp_path: Path) -> Path:
    """A folder that is none of the repository's business."""
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    return folder


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """A stranger's repository."""
    folder = tmp_path / "repository"
    (folder / ".git").mkdir(parents=True)
    (folder / "robot.urdf").write_text(SOUND)
    return folder


@pytest.mark.parametrize(
    ("link", "words"),
    [
        ("pages", ["robot.urdf", "-o", "html=pages/"]),
        ("pages", [".", "-o", "html=pages"]),
        ("reports", ["robot.urdf", "-o", "json=reports/robot.json"]),
        ("reports", ["robot.urdf", "-o", "json=reports/deep/er/robot.json"]),
        ("reports", ["robot.urdf", "-o", "json={repository}/reports/robot.json"]),
        ("reports", ["robot.urdf", "-o", "json=reports/../robot.json"]),
        ("reports", ["drop", "robot.urdf", "-o", "json=reports/robot.json"]),
        ("reports", ["srdf", "robot.urdf", "-o", "reports/robot.srdf"]),
        ("reports", ["baseline", "write", ".", "--baseline", "reports/baseline.json"]),
        ("urdfcheck-audit", ["audit", "."]),
        ("deep/urdfcheck-audit", ["audit", ".", "-o", "deep/urdfcheck-audit/x"]),
    ],
    ids=str,
)
def test_no_report_goes_through_a_link_of_the_repository(
    repository: Path, elsewhere: Path, link: str, words: list[str]
) -> None:
    (repository / link).parent.mkdir(exist_ok=True)
    (repository / link).symlink_to(elsewhere)
    if words[0] == "drop":
        pytest.importorskip("mujoco")
    if words[0] == "srdf":  # a robot with pairs of links
        box = '<collision><geometry><box size="1 1 1"/></geometry></collision>'
        joint = '<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>'
        (repository / "robot.urdf").write_text(
            f'<robot name="r"><link name="a">{box}</link><link name="b">{box}</link>{joint}</robot>'
        )
    done = urdfcheck(*(word.format(repository=repository) for word in words), cwd=repository)
    assert done.returncode == cli.FAILED
    assert f"{Path(link).name} is a link that leads out of the folders that are checked" in done.stderr
    assert "name another place" in done.stderr
    assert not list(elsewhere.iterdir())
    assert sorted(path.name for path in repository.iterdir()) == sorted([".git", "robot.urdf", Path(link).parts[0]])


def test_a_link_that_stays_inside_or_is_the_users_own_is_followed(repository: Path, elsewhere: Path) -> None:
    (repository / "kept").mkdir()
    (repository / "reports").symlink_to("kept")
    (elsewhere / "mine").mkdir()
    (elsewhere / "link").symlink_to("mine")
    inside, outside = "json=reports/r.json", f"json={elsewhere}/link/r.json"
    assert urdfcheck("robot.urdf", *QUICK, "-o", inside, "-o", outside, cwd=repository).returncode == cli.OK
    assert (repository / "kept/r.json").is_file()
    assert (elsewhere / "mine/r.json").is_file()
    # The folder with the link is not what is checked.
    assert urdfcheck(str(repository), *QUICK, "-o", "json=link/s.json", cwd=elsewhere).returncode == cli.OK
    assert (elsewhere / "mine/s.json").is_file()


def test_a_link_inside_of_a_folder_of_pages_is_not_followed(repository: Path, elsewhere: Path) -> None:
    (repository / "pages").mkdir()
    (repository / "pages/index.html").symlink_to(elsewhere / "index.html")
    assert urdfcheck(".", *QUICK, "-o", "html=pages/", cwd=repository).returncode == cli.OK
    assert not (repository / "pages/index.html").is_symlink(), "the link is replaced"
    assert not list(elsewhere.iterdir())


def test_a_pipe_or_device_of_the_repository_is_refused(repository: Path, elsewhere: Path) -> None:
    os.mkfifo(repository / "r.json")
    (repository / "null.json").symlink_to(os.devnull)
    for name in ("r.json", "null.json"):
        done = urdfcheck("robot.urdf", "-o", f"json={name}", cwd=repository)
        assert done.returncode == cli.FAILED
        assert f"cannot write {name}: it is a pipe or a device in the folders that are checked" in done.stderr


def test_a_pipe_of_the_users_own_is_written_to(repository: Path, elsewhere: Path) -> None:
    os.mkfifo(elsewhere / "pipe")
    read: list[str] = []
    reader = threading.Thread(target=lambda: read.append((elsewhere / "pipe").read_text(encoding="utf-8")))
    reader.start()
    done = urdfcheck("robot.urdf", *QUICK, "-o", f"json={elsewhere}/pipe", "-o", f"json={os.devnull}", cwd=repository)
    reader.join(timeout=60)
    assert done.returncode == cli.OK, done.stderr
    assert json.loads(read[0])["models"]


@pytest.mark.parametrize(
    "action", [["check"], ["baseline", "check"], ["baseline", "prune"], ["baseline", "write"]], ids=str
)
@pytest.mark.parametrize("nested", [False, True])
def test_a_baseline_is_not_read_through_a_link(
    repository: Path, elsewhere: Path, action: list[str], nested: bool
) -> None:
    """Not that of the run, and not that of a folder with a configuration of its own."""
    (elsewhere / "secret").write_text('{"schema": "urdfcheck-baseline/1", "models": {"s3cr3t": []}}')
    folder = repository / "below" if nested else repository
    folder.mkdir(exist_ok=True)
    if nested:
        (folder / "urdfcheck.toml").write_text('fail-on = "error"\n')
        (folder / "arm.urdf").write_text(SOUND)
        (repository / "urdfcheck-baseline.json").write_text('{"schema": "urdfcheck-baseline/1", "models": {}}')
    (folder / "urdfcheck-baseline.json").symlink_to(elsewhere / "secret")
    done = urdfcheck(*action, ".", *QUICK, cwd=repository)
    assert done.returncode == cli.FAILED
    assert "urdfcheck-baseline.json: it is outside the folders that may be read" in done.stderr
    assert "s3cr3t" not in done.stdout + done.stderr
    if action == ["check"] and not nested:
        named = urdfcheck(".", *QUICK, "--baseline", "urdfcheck-baseline.json", cwd=repository)
        assert named.returncode == cli.OK, "who names it knows where it leads"
        assert urdfcheck(".", *QUICK, "--isolated", cwd=repository).returncode == cli.OK


def test_dots_do_not_hide_a_link(tmp_path: Path) -> None:
    (tmp_path / "in/side").mkdir(parents=True)
    (tmp_path / "out/side").mkdir(parents=True)
    (tmp_path / "in/link").symlink_to(tmp_path / "out/side")
    checked = CheckedFolders((os.path.realpath(tmp_path / "in"),))
    for fine in ("in/x", "in/side/x", "in/side/../x", "in/./new/x", "out/x"):
        checked.ensure_own(tmp_path / fine)
    for bad in ("in/link/x", "in/side/../link/x", "in/link/../x", "in/link/../../in/x"):
        with pytest.raises(cli.UrdfcheckError, match="link is a link"):
            checked.ensure_own(tmp_path / bad)


def test_a_picture_of_two_models_is_refused_before_they_are_checked(tmp_path: Path) -> None:
    for name in ("a.urdf", "b.urdf"):
        (tmp_path / name).write_text("<robot name='r'><link name='a'/></robot>")
    done = urdfcheck("a.urdf", "b.urdf", "-o", "png=r.png", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert "a png shows one model, and 2 are named" in done.stderr
