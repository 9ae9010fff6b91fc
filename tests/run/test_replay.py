"""What an earlier run found is told again only where a run without a cache would find it too.

``URDFCHECK_REPLAY_EDITS``: how many random edits are tried; 2,000 before a release.
"""

from __future__ import annotations

import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
import zlib
from collections.abc import Callable
from pathlib import Path

import pytest
import trimesh
from conftest import FIXTURES, command
from conftest import check as check_here

from urdfcheck.run import pipeline
from urdfcheck.run.replay import entries, outcomes
from urdfcheck.system.observing import observations

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform == "win32", reason="nothing is kept where Python asks in other ways"),
]

EDITS = int(os.environ.get("URDFCHECK_REPLAY_EDITS", "25"))
NS = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
LINK = """<link name="{name}"><inertial><mass value="1.5"/>
<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.05"/></inertial>
<visual><geometry><mesh filename="{mesh}"/></geometry></visual>
<collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>"""
JOINT = """<joint name="{name}" type="revolute"><parent link="base"/><child link="{child}"/><origin xyz="0 0 0.3"/>
<axis xyz="0 0 1"/><limit lower="-1.5" upper="1.5" effort="10" velocity="2"/></joint>"""
FILES = {
    "arm_description/package.xml": "<package format='3'><name>arm_description</name><version>1.0.0</version>"
    "<depend>parts_description</depend></package>",
    "arm_description/urdf/arm.urdf.xacro": f"""<robot name="arm" {NS}>
<xacro:include filename="$(find parts_description)/urdf/parts.xacro"/>
<xacro:property name="values" value="${{xacro.load_yaml('$(find arm_description)/config/values.yaml')}}"/>
<xacro:arg name="tool" default="$(optenv ROS_DISTRO jazzy)"/>
{LINK.format(name="base", mesh="package://arm_description/meshes/base.stl")}
<xacro:part name="upper" mass="${{values['mass']}}"/>
<link name="$(arg tool)_tool"/>
<joint name="tool" type="fixed"><parent link="upper"/><child link="$(arg tool)_tool"/></joint>
</robot>""",
    "arm_description/config/values.yaml": "mass: 2.5\n",
    "arm_description/config/arm.srdf": "<robot name='arm'><group name='all'><joint name='upper_joint'/></group></robot>",
    "arm_description/config/controllers.yaml": "arm_controller:\n  ros__parameters:\n    joints: [upper_joint]\n",
    "arm_description/launch/show.launch.xml": "<launch><node pkg='robot_state_publisher' exec='robot_state_publisher'>"
    "<param name='robot_description' value=\"$(command 'xacro $(find-pkg-share arm_description)/urdf/arm.urdf.xacro')\"/>"
    "</node></launch>",
    "parts_description/package.xml": "<package format='3'><name>parts_description</name><version>1.0.0</version></package>",
    "parts_description/urdf/parts.xacro": f"""<robot {NS}><xacro:macro name="part" params="name mass">
{LINK.format(name="${name}", mesh="package://parts_description/meshes/part.stl").replace("1.5", "${mass}")}
{JOINT.format(name="${name}_joint", child="${name}")}
</xacro:macro></robot>""".replace("$name", "${name}"),
    "loose/plain.urdf": f"""<robot name="plain">{LINK.format(name="base", mesh="part.stl")}
{LINK.format(name="end", mesh="../arm_description/meshes/base.stl")}{JOINT.format(name="turn", child="end")}</robot>""",
    "urdfcheck.toml": "fail-on = 'warning'\n",
}
ASKED = ((".",), (".",), ("loose/plain.urdf", "--pedantic"), ("arm_description/urdf/arm.urdf.xacro",))
MESHES = ("arm_description/meshes/base.stl", "parts_description/meshes/part.stl", "loose/part.stl")


def write(path: Path, text: str | bytes) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    if isinstance(text, str):
        path.write_text(text, encoding="utf-8")
    else:
        path.write_bytes(text)


def make_box(*size: float) -> bytes:
    data: bytes = trimesh.creation.box(size).export(file_type="stl")
    return data


@pytest.fixture(name="workspace")
def make_workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, one_process: None) -> Path:
    """A workspace of two packages and a loose model, as the working directory."""
    folder = tmp_path / "src"
    for name, text in FILES.items():
        write(folder / name, text)
    for name in MESHES:
        write(folder / name, make_box(0.1, 0.1, 0.1))
    for variable in ("ROS_DISTRO", "ROS_PACKAGE_PATH"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setenv("URDFCHECK_CACHE_DIR", str(tmp_path / "kept"))
    monkeypatch.chdir(folder)
    # As if every file were old; the edits below are further apart than the clock of a file system is coarse.
    monkeypatch.setattr(observations, "SETTLED_NS", -1)
    return folder


class Counted:
    """How often a whole run and a single unit were told again, and how often a unit was audited."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.recalled: list[str] = []
        self.audited: list[str] = []
        recall, audit = entries.Replays.recall, pipeline.audit_unit

        def count_recalled(replays: entries.Replays, key: str) -> object:
            found = recall(replays, key)
            if found is not None:
                self.recalled.append(type(found[0]).__name__)
            return found

        def count_audited(unit: pipeline.Unit, settings: pipeline.AuditSettings) -> object:
            self.audited.append(unit.id)
            return audit(unit, settings)

        monkeypatch.setattr(entries.Replays, "recall", count_recalled)
        monkeypatch.setattr(pipeline, "audit_unit", count_audited)

    def clear(self) -> None:
        self.recalled.clear()
        self.audited.clear()


@pytest.fixture(name="counted")
def make_counted(monkeypatch: pytest.MonkeyPatch) -> Counted:
    return Counted(monkeypatch)


def check(*words: str) -> tuple[object, str, int]:
    """What the command says, apart from the time that it took."""
    done = command("check", *(words or (".",)), "--format", "json")
    document = json.loads(done.stdout) if done.stdout else {"models": (), "seconds": 0}
    for timed in (document, *document["models"]):
        timed.pop("seconds", None)
    return document, done.stderr, done.returncode


def without_seconds(text: str) -> str:
    return re.sub(r"\d+\.\d+ s\b", "", text)


def check_alike(*words: str) -> None:
    assert check(*words) == check(*(words or (".",)), "--no-cache")


# -- whole runs and units ----------------------------------------------------------------------------------------------


def test_an_unchanged_run_is_told_again(workspace: Path, counted: Counted) -> None:
    first = check()
    assert counted.audited
    assert first[0]["findings"]  # type: ignore[index]
    counted.clear()
    assert check() == first
    assert counted.recalled == ["tuple"]
    assert not counted.audited
    counted.clear()
    check(".", "--select", "INR")
    assert counted.audited


def test_an_unchanged_run_loads_nothing_that_audits(tmp_path: Path) -> None:
    model = tmp_path / "car-3.urdf"
    model.write_bytes((FIXTURES / "car-3" / "urdf" / "car-3.urdf").read_bytes())
    os.utime(model, (1, 1))
    time.sleep(2.1)  # what is this new is read again
    script = (
        "import json, sys; from urdfcheck import cli; cli.main(['check', sys.argv[1], '--tier', 'source', '--select', 'INR,JNT'])"
        "; print(json.dumps(sorted(sys.modules)), file=sys.stderr)"
    )
    for _ in range(2):
        done = subprocess.run(
            [sys.executable, "-I", "-c", script, str(model)],
            env={**os.environ, "URDFCHECK_CACHE_DIR": str(tmp_path / "kept")},
            capture_output=True,
            text=True,
            check=True,
        )
    loaded = set(json.loads(done.stderr))
    heavy = {"numpy", "tomli", "multiprocessing", "urdfcheck.rules", "urdfcheck.run.jobs", "urdfcheck.source.discover"}
    assert loaded & heavy == set()
    assert "1 warning" in done.stdout


def test_of_two_models_only_the_changed_one_is_audited(workspace: Path, counted: Counted) -> None:
    check_alike()
    counted.clear()
    path = workspace / "loose" / "plain.urdf"
    write(path, path.read_text(encoding="utf-8").replace("1.5", "1.6"))
    check()
    assert counted.audited == ["loose/plain.urdf"]
    assert counted.recalled == ["UnitReport"] * len(counted.recalled) != []
    check_alike()


@pytest.mark.long
@pytest.mark.parametrize(
    "words",
    [
        ("--tier", "source"),
        ("--target", "gazebo"),
        ("--arg", "tool:=hand"),
        ("--pedantic",),
        ("-v",),
        ("--fail-on", "never"),
        ("--ignore", "INR,PKG"),
        ("--package", "parts_description=arm_description"),
        ("--isolated",),
        ("--all-args",),
    ],
    ids=" ".join,
)
def test_options_are_part_of_what_is_asked(workspace: Path, words: tuple[str, ...]) -> None:
    check()
    for _ in range(2):
        check_alike(".", *words)


def test_reports_in_another_form_need_no_new_run(workspace: Path, counted: Counted) -> None:
    check()
    counted.clear()
    for words in (("--format", "sarif"), ("--format", "concise"), ("--statistics",), ("-q",)):
        known = command("check", ".", *words)
        assert not counted.audited
        anew = command("check", ".", *words, "--no-cache")
        assert (without_seconds(known.stdout), known.returncode) == (without_seconds(anew.stdout), anew.returncode)
        counted.clear()


def test_a_failure_is_not_told_again(workspace: Path, counted: Counted, monkeypatch: pytest.MonkeyPatch) -> None:
    check(".", "nowhere.urdf")
    counted.clear()
    check(".", "nowhere.urdf")
    assert "tuple" not in counted.recalled

    def crash(*_: object) -> None:
        raise RuntimeError("a check crashed")

    with monkeypatch.context() as patch:
        patch.setattr("urdfcheck.model.robot.Model.links", property(crash))
        patch.setattr(entries, "compute_installation_stamp", lambda: "with a mistake in it")
        crashed = check("loose/plain.urdf")
        counted.clear()
        assert check("loose/plain.urdf") == crashed
        assert crashed[2] == 2
        assert counted.audited


def test_another_installation_looks_anew(workspace: Path, counted: Counted, monkeypatch: pytest.MonkeyPatch) -> None:
    check()
    counted.clear()
    monkeypatch.setattr(entries, "compute_installation_stamp", lambda: "two versions at once")
    check()
    assert not counted.recalled
    monkeypatch.undo()


# -- what becomes of the files -----------------------------------------------------------------------------------------


def list_kept(folder: Path) -> list[Path]:
    return sorted(path for path in (folder.parent / "kept").rglob("*") if "replays" in path.parts and path.is_file())


def flip_bit(data: bytes) -> bytes:
    """Flip a bit near the middle that changes what is read: another distance back may lead to the same text."""
    for place in range(len(data) // 2, len(data)):
        flipped = bytearray(data)
        flipped[place] ^= 8
        try:
            if zlib.decompress(flipped[64:]) != zlib.decompress(data[64:]):
                return bytes(flipped)
        except zlib.error:
            return bytes(flipped)
    raise AssertionError("no bit counts")


@pytest.mark.parametrize("damage", ["cut", "empty", "flipped", "other", "pickle"])
def test_a_damaged_entry_is_found_anew(workspace: Path, counted: Counted, damage: str) -> None:
    first = check()
    kept = list_kept(workspace)
    contents = [path.read_bytes() for path in kept]
    for path, data, other in zip(kept, contents, [*contents[1:], contents[0]], strict=True):
        evil = data[:64] + zlib.compress(b"cos\nsystem\n(S'false'\ntR.")
        path.write_bytes(
            {"cut": data[:-9], "empty": b"", "flipped": flip_bit(data), "other": other, "pickle": evil}[damage]
        )
    counted.clear()
    assert check() == first
    assert not counted.recalled
    assert check() == first
    assert counted.recalled == ["tuple"]


def test_an_entry_without_its_check_sum_is_not_read(tmp_path: Path) -> None:
    """A flipped bit can move the end of the compressed text beyond the file: all of it is read then, and the sum never."""
    key, kept = "0123456789abcdef" * 4, ["link[arm]", 0.25]
    entries.keep_result(tmp_path, key, kept, observations.Observations())
    assert entries.Replays(tmp_path).recall(key) == (kept, observations.Observations())
    (path,) = (path for path in tmp_path.rglob("*") if path.is_file())
    path.write_bytes(path.read_bytes()[:-4])
    assert entries.Replays(tmp_path).recall(key) is None


@pytest.mark.long
def test_a_folder_that_cannot_be_written_is_no_error(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (workspace.parent / "file").write_bytes(b"")
    monkeypatch.setenv("URDFCHECK_CACHE_DIR", str(workspace.parent / "file"))
    assert check()[0] == check(".", "--no-cache")[0]


@pytest.mark.slow
@pytest.mark.long
def test_a_run_that_is_killed_leaves_nothing_wrong(tmp_path: Path) -> None:
    """Killed at any moment, also while it writes."""
    model = tmp_path / "car-3.urdf"
    model.write_bytes((FIXTURES / "car-3" / "urdf" / "car-3.urdf").read_bytes())
    words = [sys.executable, "-m", "urdfcheck", str(model), "--format", "json", "--tier", "source"]
    surroundings = {**os.environ, "URDFCHECK_CACHE_DIR": str(tmp_path / "kept"), "SOURCE_DATE_EPOCH": "0"}
    expected = subprocess.run([*words, "--no-cache"], env=surroundings, capture_output=True).stdout
    started = time.monotonic()
    assert subprocess.run(words, env=surroundings, capture_output=True).stdout == expected
    length = time.monotonic() - started
    for turn in range(6):
        shutil.rmtree(tmp_path / "kept", ignore_errors=True)
        process = subprocess.Popen(words, env=surroundings, stdout=subprocess.DEVNULL)
        time.sleep(length * (0.4 + 0.1 * turn))
        process.send_signal(signal.SIGKILL)
        process.wait()
        assert subprocess.run(words, env=surroundings, capture_output=True).stdout == expected


# -- random edits ------------------------------------------------------------------------------------------------------


class Editor:
    """Changes a workspace and its surroundings at random."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
        self.folder = folder
        self.environment = monkeypatch
        self.random = random.Random(seed)
        self.edits: tuple[Callable[[], str], ...] = (
            *(self.change_number, self.change_number, self.change_word, self.change_in_secret),
            *(self.remove_file, self.restore_file, self.restore_file, self.restore_all, self.move_file, self.link_file),
            *(self.change_mesh, self.add_file, self.add_file, self.add_package, self.remove_package, self.touch),
            *(self.set_variable, self.unset_variable, self.configure, self.configure, self.leave),
        )

    def edit(self) -> str:
        """Do something, and say what."""
        edit = self.random.choice(self.edits)
        return f"{edit.__name__} {edit()}"

    def choose_text(self) -> Path:
        texts = [path for path in map(self.folder.joinpath, FILES) if path.is_file()]
        return self.random.choice(texts or [self.folder / "urdfcheck.toml"])

    def change_number(self) -> str:
        path = self.choose_text()
        text = path.read_text(encoding="latin-1") if path.is_file() else ""  # it may lead to a mesh
        places = [place for place, letter in enumerate(text) if letter.isdigit()]
        if places:
            place = self.random.choice(places)
            write(path, (text[:place] + self.random.choice("0123456789") + text[place + 1 :]).encode("latin-1"))
        return str(path)

    def change_word(self) -> str:
        path = self.choose_text()
        before, after = self.random.choice(
            [
                ("upper", "lower"),
                ("base.stl", "part.stl"),
                ("part.stl", "none.stl"),
                ("revolute", "fixed"),
                ("arm", "leg"),
            ]
        )
        if path.is_file():
            write(path, path.read_bytes().replace(before.encode(), after.encode(), 1))
        return f"{path} {before} {after}"

    def change_in_secret(self) -> str:
        path = self.choose_text()
        times = path.stat() if path.is_file() else None
        self.change_number()
        if times is not None:
            os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
        return str(path)

    def choose_any(self) -> str:
        return self.random.choice([*FILES, *MESHES])

    def remove_file(self) -> str:
        name = self.choose_any()
        path = self.folder / name
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        path.unlink(missing_ok=True)
        return name

    def restore_file(self) -> str:
        name = self.choose_any()
        self.remove_path(self.folder / name)
        write(self.folder / name, FILES.get(name) or make_box(0.1, 0.1, 0.1))
        return name

    def restore_all(self) -> str:
        for name in (*FILES, *MESHES):
            self.remove_path(self.folder / name)
            write(self.folder / name, FILES.get(name) or make_box(0.1, 0.1, 0.1))
        return ""

    def remove_path(self, path: Path) -> None:
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        path.unlink(missing_ok=True)

    def move_file(self) -> str:
        name = self.choose_any()
        path = self.folder / name
        other = path.with_name(self.random.choice(["other.urdf", "OTHER.stl", path.name.upper(), "package.xml"]))
        if path.exists() and not other.exists():
            path.rename(other)
        return f"{name} {other.name}"

    def link_file(self) -> str:
        name, target = self.choose_any(), self.folder / self.choose_any()
        path = self.folder / name
        if path != target:
            self.remove_path(path)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.symlink_to(target)
        return f"{name} {target}"

    def change_mesh(self) -> str:
        name = self.random.choice(MESHES)
        self.remove_path(self.folder / name)
        write(self.folder / name, make_box(0.1, self.random.choice([0.1, 0.2]), self.random.choice([0.1, 0.3])))
        return name

    def add_file(self) -> str:
        name, text = self.random.choice(
            [
                ("loose/new.urdf", FILES["loose/plain.urdf"].replace("plain", "new")),
                ("arm_description/urdf/meshes/base.stl", make_box(0.2, 0.2, 0.2)),
                ("arm_description/README.md", "See urdf/arm.urdf.xacro.\n"),
                ("arm_description/COLCON_IGNORE", ""),
                ("arm_description/CMakeLists.txt", "install(DIRECTORY urdf DESTINATION share/${PROJECT_NAME})\n"),
                ("parts_description/urdf/more.xacro", f"<robot {NS}><xacro:macro name='more'/></robot>"),
                ("loose/more.launch.xml", "<launch><arg name='unused' default='1'/></launch>"),
                ("loose/controllers.yaml", "c:\n  ros__parameters:\n    joints: [turn, none]\n"),
                (
                    "loose/plain.srdf",
                    "<robot name='plain'><disable_collisions link1='base' link2='no' reason='User'/></robot>",
                ),
                ("loose/package.xml", FILES["parts_description/package.xml"]),
                (".git/HEAD", "ref: refs/heads/main\n"),
                (".gitignore", "loose/\n"),
                ("urdfcheck-baseline.json", "{}"),
            ]
        )
        path = self.folder / name
        if path.exists():
            self.remove_path(path)
        else:
            write(path, text)
        return name

    def add_package(self) -> str:
        place = self.random.choice(["nearer", "arm_description/parts", "../beside"])
        for name in ("package.xml", "urdf/parts.xacro"):
            text = FILES[f"parts_description/{name}"].replace("0.3", "0.4")
            write(self.folder / place / name, text)
        return place

    def remove_package(self) -> str:
        place = self.random.choice(["nearer", "arm_description/parts", "../beside", "parts_description"])
        self.remove_path(self.folder / place)
        return place

    def touch(self) -> str:
        name = self.choose_any()
        if (self.folder / name).is_file():
            os.utime(self.folder / name)
        return name

    def set_variable(self) -> str:
        name, value = self.random.choice(
            [
                ("ROS_DISTRO", "humble"),
                ("ROS_DISTRO", "rolling"),
                ("ROS_PACKAGE_PATH", str(self.folder.parent / "beside")),
            ]
        )
        self.environment.setenv(name, value)
        return f"{name} {value}"

    def unset_variable(self) -> str:
        name = self.random.choice(["ROS_DISTRO", "ROS_PACKAGE_PATH"])
        self.environment.delenv(name, raising=False)
        return name

    def configure(self) -> str:
        text = self.random.choice(
            [
                "fail-on = 'warning'\n",
                "ignore = ['INR']\n",
                "tier = 'source'\n",
                "exclude = ['loose']\n",
                "target = ['gazebo']\n",
                "[severity]\nPKG = 'info'\n",
                "[packages]\nparts_description = 'loose'\n",
                "select = [\n",
            ]
        )
        place = self.random.choice(["", "arm_description/", "../"])
        write(self.folder / f"{place}urdfcheck.toml", text)
        return f"{place} {text}"

    def leave(self) -> str:
        return ""


@pytest.mark.slow
def test_random_edits_are_noticed(workspace: Path, counted: Counted, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is kept and what is found anew is the same after every edit, of a folder and of one file."""
    seed = int(os.environ.get("URDFCHECK_REPLAY_SEED", "1"))
    editor = Editor(workspace, monkeypatch, seed)
    said: list[str] = []
    told = {"tuple": 0, "UnitReport": 0}
    for number in range(EDITS):
        said.append(f"{number} {editor.edit()}")
        words = editor.random.choice(ASKED)
        counted.clear()
        kept = check(*words)
        for kind in counted.recalled:
            told[kind] += 1
        assert kept == check(*words, "--no-cache"), (seed, words, said[-12:])
    assert EDITS < 20 or (told["UnitReport"] > 1 and told["tuple"] > 1), told


@pytest.mark.long
def test_every_file_that_is_opened_is_noted(tmp_path: Path) -> None:
    """What Python itself says of each file that it opens and each folder that it lists, is among the observations."""
    folder = tmp_path / "car-3"
    shutil.copytree(FIXTURES / "car-3", folder)
    asked: dict[str, set[str]] = {"open": set(), "os.listdir": set(), "os.scandir": set()}
    is_listening = True

    def listen(event: str, arguments: tuple[object, ...]) -> None:
        if is_listening and event in asked and isinstance(arguments[0], (str, Path)):
            asked[event].add(os.path.abspath(arguments[0]))

    sys.addaudithook(listen)  # it cannot be removed
    with observations.observe() as seen:
        assert check_here(folder).findings
    is_listening = False
    inside = {event: {path for path in paths if Path(path).is_relative_to(folder)} for event, paths in asked.items()}
    assert len(inside["open"]) > 10
    assert inside["open"] <= {os.path.normpath(path) for path in seen.contents}
    assert inside["os.listdir"] <= {os.path.normpath(path) for path in (*seen.names, *seen.kinds)}
    assert inside["os.scandir"] <= {os.path.normpath(path) for path in (*seen.entries, *seen.kinds)}


def test_a_key_holds_all_that_is_asked() -> None:
    base = {"paths": ["a"], "tier": None, "codes": frozenset({"A", "B"})}
    keys = {
        outcomes.make_outcome_key({**base, **change})
        for change in ({}, {"paths": ["b"]}, {"tier": "full"}, {"codes": frozenset({"A"})}, {"more": 1})
    }
    assert len(keys) == 5
    assert outcomes.make_outcome_key({**base, "codes": frozenset({"B", "A"})}) in keys
    assert entries.make_key(object()) == ""
