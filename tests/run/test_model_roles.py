"""What a file is once it is expanded: no set of macros and no part is an error, and no model hides as one."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

import pytest
from conftest import check

from urdfcheck.cli import FINDINGS, NOTHING, OK, compute_exit_code
from urdfcheck.core import Run, Severity
from urdfcheck.policy.config_resolver import ConfigResolver

pytestmark = pytest.mark.slow

NAMESPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'

XMLNS = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
INERTIA = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
BAD_LINK = f'<link name="a"><inertial><mass value="-1"/>{INERTIA}</inertial></link>'
MACRO = '<xacro:macro name="wheel"><link name="w"/></xacro:macro>'


def xacro(body: str, name: str = ' name="r"') -> str:
    return f"<robot{name} {XMLNS}>{body}</robot>"


def include(path: str) -> str:
    return f'<xacro:include filename="{path}"/>'


def joint(parent: str, child: str) -> str:
    return f'<joint name="to_{child}" type="fixed"><parent link="{parent}"/><child link="{child}"/></joint>'


def unless_asked(body: str) -> str:
    return f'<xacro:if value="0">{body}</xacro:if>'


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "package.xml").write_text("<package><name>car</name></package>")
    return tmp_path


def write(folder: Path, files: Mapping[str, str]) -> None:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)


def list_errors(run: Run) -> list[tuple[str, str]]:
    return [(f.code, f.model) for f in run.findings if f.severity.name == "ERROR"]


def list_unchecked(run: Run) -> list[str]:
    return [skip.model for skip in run.skipped if skip.code == "ALL"]


# -- what is no model --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["", ' name="wheels"'])
@pytest.mark.parametrize(
    "more", ["", '<xacro:property name="p" value="1"/><xacro:arg name="a" default="1"/>' + include("more.xacro")]
)
def test_a_library_of_macros_is_no_error_however_it_is_given(package: Path, name: str, more: str) -> None:
    write(package, {"wheels.urdf.xacro": xacro(more + MACRO, name), "more.xacro": xacro(MACRO, "")})
    for run in (check(Path("wheels.urdf.xacro")), check(Path("more.xacro")), check(Path("."))):
        assert (list_errors(run), run.models) == ([], ())
    assert list_unchecked(check(Path("wheels.urdf.xacro"))) == ["wheels.urdf.xacro"]


def test_a_robot_that_includes_one_whose_calls_lack_the_prefix_is_a_robot(package: Path) -> None:
    """Otherwise neither of the two files is checked: the one makes nothing, and the other is a part of it."""
    write(
        package,
        {
            "wheels.xacro": xacro(MACRO, ""),
            "car.urdf.xacro": xacro(include("wheels.xacro") + "<wheel/>"),
            "car_simulated.urdf.xacro": xacro(include("car.urdf.xacro") + '<gazebo reference="wheel"/>'),
        },
    )
    for run in (check(Path("car.urdf.xacro")), check(Path("."))):
        assert {code for code, _ in list_errors(run)} == {"XAC007"}


def test_a_file_of_arguments_with_a_root_of_its_own_is_no_error_however_it_is_given(package: Path) -> None:
    """A xacro may include it by a name that is computed; xacro ignores the root of what it includes."""
    settings = '<tool xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="tcp" default="0 0 0.1"/></tool>'
    write(package, {"config/pg70_tool.xacro": settings, "arm.urdf.xacro": xacro('<link name="base"/>')})
    for run in (check(Path("config/pg70_tool.xacro")), check(Path("arm.urdf.xacro"), Path("config/pg70_tool.xacro"))):
        assert list_errors(run) == []


@pytest.mark.parametrize(("child", "is_model"), [("front_bumpr_mount", True), ("camera_mount", False)])
def test_a_robot_that_misspells_one_of_its_links_is_no_part(package: Path, child: str, is_model: bool) -> None:
    """A file that another one includes is a robot by itself, too, if all that it names is its own but for one letter."""
    links = "".join(f'<link name="{name}"/>' for name in ("base", "wheel", "front_bumper_mount"))
    body = links + joint("base", "wheel") + joint("base", child)
    others = '<link name="body"/>' + unless_asked(include("dingo.urdf.xacro"))
    write(package, {"dingo.urdf.xacro": xacro(body), "all.urdf.xacro": xacro(others)})
    run = check(Path("dingo.urdf.xacro"))
    assert (list_errors(run) == [("KIN002", "dingo.urdf.xacro")]) is is_model
    assert (list_unchecked(run) == []) is is_model


def test_a_library_is_told_only_where_no_model_uses_it(package: Path) -> None:
    write(
        package, {"wheels.xacro": xacro(MACRO, ""), "car.urdf.xacro": xacro(include("wheels.xacro") + "<xacro:wheel/>")}
    )
    run = check(Path("wheels.xacro"))
    assert [m.path for m in run.models] == ["car.urdf.xacro"]
    assert (list_errors(run), list_unchecked(run)) == ([], [])


def test_a_named_library_that_no_checked_model_reads_is_told(package: Path) -> None:
    """Other libraries include it, and a model under a condition that does not hold: nothing of it is checked."""
    write(
        package,
        {
            "wheels.xacro": xacro(MACRO, ""),
            "platform.urdf.xacro": xacro(include("wheels.xacro") + MACRO.replace("wheel", "platform")),
        },
    )
    run = check(Path("wheels.xacro"))
    assert (run.models, list_unchecked(run)) == ((), ["wheels.xacro"])
    assert compute_exit_code(run, "error") == NOTHING
    assert compute_exit_code(run, "error", allow_empty=True) == OK
    write(package, {"car.urdf.xacro": xacro(unless_asked(include("wheels.xacro")) + '<link name="l"/>')})
    run = check(Path("wheels.xacro"))
    assert ([m.path for m in run.models], list_unchecked(run)) == (["car.urdf.xacro"], ["wheels.xacro"])
    assert compute_exit_code(run, "error") == OK


def test_a_semantic_description_by_any_name_is_no_robot_without_links(package: Path) -> None:
    group = '<xacro:macro name="groups"><group name="arm"/></xacro:macro>'
    write(package, {"arm_srdf.xacro": xacro(include("groups.xacro") + "<xacro:groups/>"), "groups.xacro": xacro(group)})
    run = check(Path("."))
    assert (run.models, list_errors(run)) == ((), [])
    run = check(Path("arm_srdf.xacro"))
    assert [skip.reason.partition(",")[0] for skip in run.skipped if skip.code == "ALL"] == [
        "describes another robot (SRDF)"
    ]
    assert compute_exit_code(run, "error") == NOTHING


def test_a_named_library_of_which_only_the_package_was_checked_is_nothing(package: Path) -> None:
    """Only the expansion of a file that includes others shows that it is a library: its package was checked by then."""
    write(package, {"wheels.urdf.xacro": xacro(include("more.xacro") + MACRO), "more.xacro": xacro(MACRO, "")})
    run = check(Path("wheels.urdf.xacro"))
    assert (run.models, list_unchecked(run)) == ((), ["wheels.urdf.xacro"])
    assert run.units, "its package is checked"
    assert compute_exit_code(run, "error") == NOTHING


@pytest.mark.parametrize("body", [MACRO, '<link name="w"/>'])
def test_what_others_include_may_have_any_root(package: Path, body: str) -> None:
    """xacro ignores the root of an included file: PR2 has libraries with <root>."""
    call = "<xacro:wheel/>" if body == MACRO else ""
    write(
        package,
        {
            "wheel.urdf.xacro": xacro(body, "").replace("robot", "root"),
            "car.urdf.xacro": xacro(include("wheel.urdf.xacro") + call),
        },
    )
    for path in ("wheel.urdf.xacro", "."):
        run = check(Path(path))
        assert ([m.path for m in run.models], list_errors(run), list_unchecked(run)) == (["car.urdf.xacro"], [], [])


@pytest.mark.parametrize(
    ("root", "body", "errors"),
    [
        ("root", MACRO, []),
        ("root", '<property name="a" value="1"/><material name="m"/>' + MACRO, []),
        ("root", include("none.xacro") + MACRO, []),
        ("root", include("none.xacro") + MACRO + "<xacro:wheel/>", ["XAC001"]),
        ("root", '<property name="a" value="1"/><link name="w"/>', ["XML002"]),
        ("root", '<property name="a" value="1"/><include filename="none.xacro"/>', ["XML002", "XAC007"]),
        ("robt", '<link name="w"/>', ["XML002"]),
        ("robt", MACRO + "<xacro:wheel/>", ["XML002"]),
        ("sdf", MACRO, ["XML002"]),
    ],
)
def test_what_none_includes_is_a_model_of_a_wrong_root_unless_it_only_defines_macros(
    package: Path, root: str, body: str, errors: list[str]
) -> None:
    write(package, {"wheel.urdf.xacro": xacro(body).replace("robot", root)})
    assert [code for code, _ in list_errors(check(Path("wheel.urdf.xacro")))] == errors


def test_a_library_whose_includes_are_not_installed_is_still_one(package: Path) -> None:
    write(package, {"lidar.urdf.xacro": xacro(include("$(find elsewhere)/urdf/lidar.xacro") + MACRO, "")})
    assert list_errors(check(Path("lidar.urdf.xacro"))) == []
    write(package, {"robot.urdf.xacro": xacro(include("$(find elsewhere)/urdf/lidar.xacro") + MACRO)})
    assert list_errors(check(Path("robot.urdf.xacro"))) == [("PKG001", "robot.urdf.xacro")]


def test_a_macro_that_a_model_forgets_to_call_leaves_a_library_but_an_idle_condition_does_not(package: Path) -> None:
    write(package, {"idle.urdf.xacro": xacro(unless_asked('<link name="a"/>'))})
    assert list_errors(check(Path("idle.urdf.xacro"))) == [("KIN007", "idle.urdf.xacro")]


def test_what_webots_reads_is_no_robot_without_links(package: Path) -> None:
    write(package, {"a.urdf": '<robot name="r"><webots><plugin type="p.q"/></webots></robot>'})
    assert not check(package, codes={"KIN007"}).findings


@pytest.mark.parametrize(("tool", "count"), [("", 0), (' default="-"', 1)])
def test_a_call_with_an_unknown_argument_is_left_out_if_it_makes_no_link(package: Path, tool: str, count: int) -> None:
    """Another launch file makes a robot of the file: what the first one makes is not known."""
    arguments = '<xacro:arg name="TOOL" default="-"/><xacro:arg name="ARM" default="-"/>'
    arm = "<xacro:if value=\"${'$(arg {})' != '-'}\"><link name=\"{}\"/></xacro:if>"
    load = '<param name="robot_description" command="xacro $(find car)/r.urdf.xacro {}"/>'
    files = {
        "r.urdf.xacro": xacro(arguments + "".join(arm.replace("{}", name) for name in ("TOOL", "ARM"))),
        "tool.launch": f'<launch><arg name="tool"{tool}/>{load.format("SIM:=0 TOOL:=$(arg tool)")}</launch>',
        "arm.launch": f"<launch>{load.format('ARM:=kuka')}</launch>",
    }
    write(package, files)
    assert len(check(package, codes={"KIN007"}).findings) == count


def test_what_completes_another_robot_is_no_robot_without_links(package: Path) -> None:
    control = '<ros2_control name="c" type="system"><joint name="j"/></ros2_control>'
    write(package, {"control.xacro": xacro(f'<xacro:macro name="control">{control}</xacro:macro>', "")})
    write(package, {"control_test.urdf.xacro": xacro(include("control.xacro") + "<xacro:control/>")})
    write(package, {"plugins.urdf": '<robot name="r"><gazebo><plugin name="p" filename="p.so"/></gazebo></robot>'})
    write(package, {"idle.urdf.xacro": xacro("<gazebo/>" + unless_asked('<link name="a"/>'))})
    write(package, {"empty.urdf.xacro": xacro("<gazebo/>" + unless_asked(include("arm.xacro") + "<xacro:arm/>"))})
    assert list_errors(check(Path("empty.urdf.xacro"))) == [("KIN007", "empty.urdf.xacro")]
    assert list_errors(check(Path("control_test.urdf.xacro"))) == []
    assert list_errors(check(Path("plugins.urdf"))) == []
    assert list_errors(check(Path("idle.urdf.xacro"))) == [("KIN007", "idle.urdf.xacro")]


PARTS = {
    "taken": include("part.xacro"),
    "commented": f"<!-- {include('part.xacro')} -->",
    "not taken": unless_asked(include("part.xacro")),
    "named by a variable": include("$(optenv EXTRAS none.xacro)"),
    "named by a variable with a default": unless_asked(include("$(optenv EXTRAS part.xacro)")),
    "named by a needed variable": unless_asked(include("$(env EXTRAS)")),
}


@pytest.mark.parametrize("how", PARTS)
def test_a_part_of_others_is_no_error(package: Path, how: str) -> None:
    part = xacro('<link name="camera"/>' + joint("base", "camera"), "")
    none = {"none.xacro": xacro("", "")}
    write(package, {"car.urdf.xacro": xacro('<link name="base"/>' + PARTS[how]), "part.xacro": part, **none})
    # One that no model was made of is named: it was not checked.
    unchecked = [] if how == "taken" else ["part.xacro"]
    for run in (check(Path("part.xacro")), check(Path("."))):
        assert list_errors(run) == []
        assert list_unchecked(run) == unchecked
    assert [m.path for m in check(Path(".")).models] == ["car.urdf.xacro"]


def test_a_part_with_a_name_that_needs_the_links_of_others_is_no_error(package: Path) -> None:
    part = xacro('<link name="camera"/>' + joint("base", "camera"), ' name="camera"')
    commented = f"<!-- {include('part.xacro')} -->"
    write(package, {"car.urdf.xacro": xacro('<link name="base"/>' + commented), "part.xacro": part})
    run = check(Path("."))
    assert (list_errors(run), list_unchecked(run)) == ([], ["part.xacro"])
    (skip,) = [skip for skip in run.skipped if skip.code == "ALL"]
    assert "joint 'to_camera' names the link 'base'" in skip.reason


def test_a_part_that_cannot_be_read_is_an_error_all_the_same(package: Path) -> None:
    part = '<robot><xacro:camera/><link name="camera"/></robot>'
    write(
        package,
        {"car.urdf.xacro": xacro('<link name="base"/>' + include("$(optenv EXTRAS none.xacro)")), "x.urdf": part},
    )
    write(package, {"none.xacro": xacro("", "")})
    for run in (check(Path("x.urdf")), check(Path("."))):
        assert list_errors(run) == [("XML001", "x.urdf")]


# -- no model hides ----------------------------------------------------------------------------------------------------

DECOY = '<link name="base"/>'
HIDDEN = {
    "in a property": {"bad.xacro": xacro(f'<xacro:property name="b">{BAD_LINK}</xacro:property><xacro:insert_block name="b"/>')},
    "behind a false condition": {
        "bad.xacro": xacro(BAD_LINK),
        "ok.xacro": xacro(DECOY + unless_asked(include("bad.xacro"))),
    },
    "named by an attribute": {
        "bad.xacro": xacro(f'<xacro:attribute name="name" value="bad"/>{BAD_LINK}', ""),
        "ok.xacro": xacro(DECOY + unless_asked(include("bad.xacro"))),
    },
    "made of included files": {
        "bad.xacro": xacro(include("links.xacro")),
        "links.xacro": xacro(BAD_LINK, ""),
        "ok.xacro": xacro(DECOY + unless_asked(include("bad.xacro"))),
    },
    "included where no link counts": {
        "bad.xacro": xacro(include("links.xacro")),
        "links.xacro": xacro(BAD_LINK, ""),
        "ok.xacro": xacro(f"{DECOY}<gazebo>{include('bad.xacro')}</gazebo>"),
    },
    "included with other arguments": {
        "bad.xacro": xacro(f'<xacro:arg name="a" default="1"/><xacro:if value="$(arg a)">{BAD_LINK}</xacro:if>'),
        "ok.xacro": xacro(f'{DECOY}<xacro:arg name="a" default="0"/>{include("bad.xacro")}'),
    },
    "read as text": {
        "bad.xacro": xacro(f'<xacro:attribute name="name" value="bad"/>{BAD_LINK}', ""),
        "ok.xacro": xacro(f'{DECOY}<!-- {include("bad.xacro")} --><xacro:property name="x" value="bad.xacro"/>'),
    },
    "called by another name": {"bad.srdf.xacro": xacro(BAD_LINK)},
    "called by another name, made by a macro": {
        "bad.srdf.xacro": xacro(f'<xacro:macro name="m">{BAD_LINK}</xacro:macro><xacro:m/>')
    },
    "in capital letters": {"BAD.URDF": f'<robot name="r">{BAD_LINK}</robot>'},
    "in a circle": {
        "bad.xacro": xacro(BAD_LINK + unless_asked(include("ok.xacro"))),
        "ok.xacro": xacro(unless_asked(include("bad.xacro"))),
    },
}  # fmt: skip


@pytest.mark.parametrize("how", HIDDEN)
def test_no_model_hides_in_a_folder_or_where_it_is_named(package: Path, how: str) -> None:
    write(package, HIDDEN[how])
    name = next(iter(HIDDEN[how]))
    for run in (check(Path(".")), check(Path(name)), check(*map(Path, HIDDEN[how]))):
        assert ("INR002", name) in list_errors(run), (how, run.findings)


def test_a_model_that_is_a_link_to_outside_is_told_by_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path, {"outside/bad.urdf": f'<robot name="r">{BAD_LINK}</robot>', "in/package.xml": "<package/>"})
    os.symlink("../outside/bad.urdf", tmp_path / "in" / "link.urdf")
    monkeypatch.chdir(tmp_path / "in")
    run = check(Path("."))
    assert list_unchecked(run) == ["link.urdf"]


def test_the_name_of_what_was_not_checked_is_in_the_text(package: Path) -> None:
    from urdfcheck.output import markdown, text

    write(package, {"wheels.xacro": xacro(MACRO)})
    run = check(Path("wheels.xacro"))
    assert "(wheels.xacro)" in text.render(run, width=200)
    assert "wheels.xacro" in markdown.render_job_summary(run)


def test_another_model_format_is_named_as_what_it_is(package: Path) -> None:
    files = {
        "a.sdf": "<sdf/>",
        "B.SDF": "<sdf/>",
        "c.world": "<sdf/>",
        "d.usda": "#usda",
        "e.mjcf": "<mujoco/>",
        "f.model": "<sdf/>",
    }
    write(package, files)
    run = check(*map(Path, files))
    for name, what in zip(
        files,
        (
            "an SDF model",
            "an SDF model",
            "a world for Gazebo (SDF)",
            "a USD model",
            "a MuJoCo model (MJCF)",
            "an SDF model",
        ),
        strict=True,
    ):
        assert f"{name}: this is {what}; urdfcheck reads URDF and xacro" in run.failures


def test_a_part_that_breaks_its_model_is_told_once(tmp_path: Path) -> None:
    """Two parts that include each other, and nothing else, are both told."""
    for name, included in (("a", "b"), ("b", "a")):
        text = f'<robot {NAMESPACE}><xacro:include filename="{included}.xacro"/><link name="{name}"></robot>'
        (tmp_path / f"{name}.xacro").write_text(text, encoding="utf-8")
    assert check(tmp_path, tier="source").unchecked_models
    (tmp_path / "robot.urdf.xacro").write_text(
        f'<robot name="r" {NAMESPACE}><xacro:include filename="a.xacro"/></robot>', encoding="utf-8"
    )
    (unchecked,) = {info.path.rpartition("/")[2] for info in check(tmp_path, tier="source").unchecked_models} - {
        "b.xacro"
    }
    assert unchecked == "robot.urdf.xacro"


@pytest.mark.parametrize(
    ("how", "second_tree"),
    [
        *((how, False) for how in PARTS if how != "taken"),
        *((how, True) for how in ("commented", "not taken", "named by a variable with a default")),
    ],
)
def test_a_part_that_may_be_a_robot_and_is_never_taken_is_a_model_that_was_not_checked(
    package: Path, how: str, second_tree: bool
) -> None:
    """A robot without a name, or a loose link beside it, hides no model: only a joint to elsewhere shows a part."""
    part = xacro(BAD_LINK + '<link name="b"/>', ' name="bad"') if second_tree else xacro(BAD_LINK, "")
    files = {
        "car.urdf.xacro": xacro('<link name="base"/>' + PARTS[how]),
        "part.xacro": part,
        "none.xacro": xacro("", ""),
    }
    write(package, files)
    for run in (check(Path(".")), check(Path("car.urdf.xacro"), Path("part.xacro"))):
        assert [m.path for m in run.unchecked_models] == ["part.xacro"], how
        assert list_errors(run) == [("XML002", "part.xacro")]
        assert compute_exit_code(run, "error") == FINDINGS
    accepted = check(Path("."), unchecked=Severity.WARNING)
    assert compute_exit_code(accepted, "error") == OK


def test_a_part_with_a_name_that_cannot_be_expanded_is_a_model_that_was_not_checked(package: Path) -> None:
    part = xacro('<link name="${prefix}camera"/>', ' name="camera"')
    write(
        package,
        {"car.urdf.xacro": xacro('<link name="base"/>' + unless_asked(include("part.xacro"))), "part.xacro": part},
    )
    for run in (check(Path(".")), check(Path("part.xacro"))):
        assert [m.path for m in run.unchecked_models] == ["part.xacro"]
        assert compute_exit_code(run, "error") == FINDINGS
    write(
        package,
        {
            "car.urdf.xacro": xacro(
                '<link name="base"/><xacro:property name="prefix" value="a_"/>'
                + include("part.xacro")
                + joint("base", "a_camera")
            )
        },
    )
    run = check(Path("."))
    assert (list_errors(run), [m.path for m in run.models]) == ([], ["car.urdf.xacro"])


@pytest.mark.parametrize(
    ("line", "severity"),
    [
        ("<!-- " + include("part.xacro") + " -->", Severity.WARNING),
        ("<!-- " + include("$(find car)/part.xacro") + " -->", Severity.WARNING),
        (unless_asked(include("part.xacro")), Severity.ERROR),
        ("<!-- " + include("part.xacro") + " -->" + unless_asked(include("${'a'}rt.xacro")), Severity.ERROR),
    ],
)
def test_a_part_that_only_comments_include_is_a_warning(package: Path, line: str, severity: Severity) -> None:
    part = xacro('<link name="${prefix}camera"/>', ' name="camera"')
    write(
        package,
        {
            "package.xml": "<package><name>car</name></package>",
            "car.urdf.xacro": xacro('<link name="base"/>' + line),
            "part.xacro": part,
        },
    )
    run = check(Path("."), codes={"XML002"})
    assert [(f.model, f.severity) for f in run.findings] == [("part.xacro", severity)]
    assert [m.path for m in run.unchecked_models] == ["part.xacro"]


def test_a_failed_model_that_names_a_part_in_a_comment_is_not_why_it_was_not_checked(package: Path) -> None:
    failed = xacro('<link name="${wrong}"/><!-- ' + include("arm.xacro") + " -->" + include("camera.xacro"))
    parts = {name: xacro('<link name="${prefix}l"/>', f' name="{name}"') for name in ("arm", "camera")}
    write(package, {"car.urdf.xacro": failed, **{f"{name}.xacro": text for name, text in parts.items()}})
    (package / "urdfcheck.toml").write_text('unchecked = ["car.*"]')
    run = check(Path("."), config_resolver=ConfigResolver())
    told = {f.model: f.message_id for f in run.findings if f.code == "XML002"}
    assert told == {"arm.xacro": "part", "camera.xacro": "part-of-failed"}


def test_a_part_that_makes_transmissions_alone_is_in_the_model(package: Path) -> None:
    """What completes a robot is as much of it as a link, also within a block of ros2_control and two files deep."""
    macro = (
        '<xacro:macro name="geared" params="ratio"><transmission name="t"><r>${ratio}</r></transmission></xacro:macro>'
    )
    part = xacro(macro + '<xacro:geared ratio="${gear}"/>', ' name="t"')
    outer = xacro(f'<ros2_control name="c" type="system">{include("part.xacro")}</ros2_control>', "")
    base = '<link name="base"/><xacro:property name="gear" value="9"/>'
    write(package, {"car.urdf.xacro": xacro(base + include("outer.xacro")), "outer.xacro": outer, "part.xacro": part})
    assert not check(Path("."), codes={"XML002"}).findings
    write(package, {"car.urdf.xacro": xacro(base + unless_asked(include("part.xacro"))), "outer.xacro": xacro("", "")})
    (finding,) = check(Path("."), codes={"XML002"}).findings
    assert finding.model == "part.xacro"


def test_a_part_that_only_chooses_what_is_included_is_in_the_model_that_reads_it(package: Path) -> None:
    choice = (
        '<xacro:property name="tool" value="$(arg tool)"/><xacro:if value="${tool == 0}">'
        + include("tool.xacro")
        + "</xacro:if>"
    )
    tool = xacro('<xacro:macro name="tool"><link name="tool"/></xacro:macro>', "")
    car = '<xacro:arg name="tool" default="0"/>' + include("choice.xacro") + "<xacro:tool/>"
    write(package, {"car.urdf.xacro": xacro(car), "choice.xacro": xacro(choice, ' name="choice"'), "tool.xacro": tool})
    assert not check(Path("."), codes={"XML002"}).findings
    left_out = '<xacro:arg name="tool" default="0"/><link name="base"/>' + unless_asked(include("choice.xacro"))
    write(package, {"car.urdf.xacro": xacro(left_out)})
    assert [finding.model for finding in check(Path("."), codes={"XML002"}).findings] == ["choice.xacro"]


def test_a_condition_that_leaves_a_part_out_is_named(package: Path) -> None:
    part = xacro('<link name="${prefix}camera"/>', ' name="camera"')
    taken = '<xacro:arg name="cam" default="false"/><xacro:property name="prefix" value="a_"/>'
    taken += f'<xacro:if value="$(arg cam)">{include("part.xacro")}{joint("base", "a_camera")}</xacro:if>'
    write(package, {"car.urdf.xacro": xacro('<link name="base"/>' + taken), "part.xacro": part})
    (finding,) = check(Path("."), codes={"XML002"}).findings
    assert finding.message_id == "part-of-variant"
    assert 'car.urdf.xacro includes it under `<xacro:if value="$(arg cam)">`' in finding.message
    # The model has what the part lacks: it is no robot that was missed. The run still says that something was not checked.
    assert finding.severity is Severity.INFO
    assert compute_exit_code(check(Path("."), codes={"XML002"}), "error") == FINDINGS
    assert not check(Path("."), all_arguments=True).unchecked_models


def test_a_part_that_is_included_by_a_computed_name_is_of_another_variant(package: Path) -> None:
    """It has a name as a robot has, but lacks what the model defines that includes it, for other values of the argument."""
    part = xacro('<link name="${prefix}eye"/>', ' name="car"')
    taken = '<xacro:arg name="kind" default="mono"/><xacro:property name="prefix" value="a_"/>'
    model = xacro(
        '<link name="base"/>' + taken + include("car_$(arg kind).xacro") + joint("base", "a_eye"), ' name="car"'
    )
    write(package, {"car.urdf.xacro": model, "car_mono.xacro": part, "car_stereo.xacro": part})
    (finding,) = check(Path("."), codes={"XAC001", "XML002"}).findings
    assert (finding.model, finding.message_id, finding.severity) == (
        "car_stereo.xacro",
        "part-of-variant",
        Severity.INFO,
    )
    assert 'car.urdf.xacro includes it under `<xacro:include filename="…/car_$(arg kind).xacro">`' in finding.message


def test_a_part_of_a_model_that_failed_is_no_second_model(package: Path) -> None:
    """The model stopped before it came to its parts; where it is accepted, they count."""
    files = {
        "car.urdf.xacro": xacro('<link name="${wrong}"/>' + include("arm.xacro") + include("camera.xacro")),
        "arm.xacro": xacro('<link name="${prefix}arm"/>', ' name="arm"'),
        "camera.xacro": xacro('<link name="camera"/>', ""),
    }
    write(package, files)
    run = check(Path("."))
    assert [m.path for m in run.unchecked_models] == ["car.urdf.xacro"]
    assert list_errors(run) == [("XAC001", "car.urdf.xacro")]
    assert list_unchecked(run) == ["arm.xacro", "camera.xacro"]
    (package / "urdfcheck.toml").write_text('unchecked = ["car.*"]')
    accepted = check(Path("."), config_resolver=ConfigResolver())
    assert sorted(m.path for m in accepted.unchecked_models) == ["arm.xacro", "camera.xacro", "car.urdf.xacro"]
    told = {f.model: f.message for f in accepted.findings if f.code == "XML002"}
    assert all(message.startswith("car.urdf.xacro names this file") for message in told.values())
    assert sorted(told) == ["arm.xacro", "camera.xacro"]
    assert compute_exit_code(accepted, "error") == FINDINGS


def test_a_part_that_lacks_a_package_is_told_with_the_model_that_lacks_it_too(package: Path) -> None:
    """Which of two robots a variable of the environment chooses; both need a package that is not installed."""
    lacking = include("$(find elsewhere)/urdf/lidar.xacro")
    files = {
        "other.urdf.xacro": xacro('<link name="o"/>' + include("accessories.xacro"), ' name="other"'),
        "accessories.xacro": xacro(lacking, ""),
        "car.urdf.xacro": xacro(
            f'<link name="base"/><xacro:if value="$(optenv OTHER 0)">{include("other.urdf.xacro")}</xacro:if>'
            + include("accessories.xacro")
        ),
    }
    write(package, files)
    run = check(Path("."))
    assert list_errors(run) == [("PKG001", "car.urdf.xacro")]
    assert [m.path for m in run.unchecked_models] == ["car.urdf.xacro"]
    write(package, {"car.urdf.xacro": files["car.urdf.xacro"].replace(include("accessories.xacro"), "")})
    run = check(Path("."))
    assert [m.path for m in run.unchecked_models] == ["other.urdf.xacro"]
    assert list_errors(run) == [("PKG001", "other.urdf.xacro")]
