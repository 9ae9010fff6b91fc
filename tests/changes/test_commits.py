"""``urdfcheck diff`` of a git repository: real repositories, honest and hostile."""

from __future__ import annotations

import hashlib
import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import command, make_request
from versions import ARM

import urdfcheck
from urdfcheck.api import DiffSettings
from urdfcheck.changes.commits.compare_states import compare_states
from urdfcheck.changes.commits.state_folders import is_hostile_name
from urdfcheck.cli import FAILED, FINDINGS, OK
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.core.model_diff import Diff
from urdfcheck.output.changes import json as json_output
from urdfcheck.output.changes import text as text_output
from urdfcheck.run.jobs import Request
from urdfcheck.run.pipeline import IN_THIS_PROCESS

QUICK = ("--tier", "source", "--select", "INR003", "--no-cache")
MODEL = "arm_description/urdf/arm.urdf"
LONGER = ARM.replace('<origin xyz="0.3 0 0" rpy="0 0 0"/>', '<origin xyz="0.341 0 0" rpy="0 0 0"/>')
MANIFEST = "<package format='3'><name>{}</name><version>1.0.0</version><description>d</description></package>"
POINTER = "version https://git-lfs.github.com/spec/v1\noid sha256:{}\nsize {}\n"
XACRO = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="car">
  <xacro:include filename="$(find parts)/wheel.xacro"/>
  <link name="base"/>
  <xacro:wheel/>
</robot>
"""
WHEEL = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="reach" value="0.3"/>
  <xacro:macro name="wheel">
    <link name="wheel"/>
    <joint name="axle" type="fixed">
      <parent link="base"/><child link="wheel"/>
      <origin xyz="${reach} 0 0"/>
    </joint>
  </xacro:macro>
</robot>
"""
CUBE = """solid c
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 {} 0
endloop
endfacet
endsolid c
"""
MESHED = """<robot name="box"><link name="base"><visual><geometry>
<mesh filename="package://arm_description/meshes/part.stl"/></geometry></visual></link></robot>
"""


def git(folder: Path, *words: str, text: str | None = None) -> str:
    """Run git as an author does."""
    who = (
        "-c",
        "user.name=a",
        "-c",
        "user.email=a@b",
        "-c",
        "commit.gpgsign=false",
        "-c",
        "protocol.file.allow=always",
    )
    done = subprocess.run(
        ["git", "-C", str(folder), *who, *words], input=text, capture_output=True, text=True, check=True
    )
    return done.stdout.strip()


def write(path: Path, text: str | bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(text.encode() if isinstance(text, str) else text)


def commit(folder: Path) -> None:
    git(folder, "add", "-A")
    git(folder, "commit", "-q", "-m", "m", "--allow-empty")


@pytest.fixture(name="repository")
def make_repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository with one arm, committed, which is the working directory."""
    folder = tmp_path / "robots"
    folder.mkdir()
    git(folder, "init", "-q", "-b", "main")
    write(folder / "arm_description/package.xml", MANIFEST.format("arm_description"))
    write(folder / MODEL, ARM)
    commit(folder)
    monkeypatch.chdir(folder)
    return folder


def compare(revisions: str = "", *paths: str, **options: object) -> Diff:
    """Compare in this process, with a few quick rules."""

    def make(folder: Path, _: Callable[[str], str]) -> Request:
        return make_request(folder, codes={"INR003", "XML001", "KIN001"})

    return compare_states(revisions, paths, make, execution=IN_THIS_PROCESS, **options)  # type: ignore[arg-type]


def show(diff: Diff) -> str:
    shown = text_output.render(diff, show_all=True)
    assert "urdfcheck-" not in shown.replace("urdfcheck-diff/1", "")
    assert "/before/" not in json_output.render(diff)
    assert "/after/" not in json_output.render(diff)
    return shown


# -- what changed ------------------------------------------------------------------------------------------------------


def test_head_is_compared_with_the_work_tree(repository: Path) -> None:
    number = ARM.splitlines().index('    <origin xyz="0.3 0 0" rpy="0 0 0"/>') + 1
    assert compare().verdict == "identical"
    write(repository / MODEL, LONGER)
    diff = compare()
    assert (diff.before, diff.after, diff.failures, diff.notes) == ("HEAD", "work tree", (), ())
    lines = show(diff).splitlines()
    assert lines[0] == "tool0 moves by 41 mm in every configuration"
    assert f'    - HEAD:{MODEL}:{number}  <origin xyz="0.3 0 0" rpy="0 0 0"/>' in lines
    assert f'    + {MODEL}:{number}  <origin xyz="0.341 0 0" rpy="0 0 0"/>' in lines
    assert git(repository, "status", "--porcelain") == f"M {MODEL}"


def test_two_revisions_are_compared_without_the_work_tree(repository: Path) -> None:
    write(repository / MODEL, LONGER)
    commit(repository)
    write(repository / MODEL, "<robot")
    forth, back = compare("HEAD~1..HEAD"), compare("HEAD..HEAD~1")
    assert [model.headline for model in forth.models] == ["tool0 moves by 41 mm in every configuration"]
    assert back.verdict == "kinematic"
    assert f"- HEAD~1:{MODEL}:" in show(forth)
    assert f"+ HEAD:{MODEL}:" in show(forth)
    assert compare("..HEAD").verdict == "identical"
    assert (repository / MODEL).read_text() == "<robot"


@pytest.mark.slow
def test_python_compares_commits_of_a_repository_elsewhere(
    repository: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(repository / MODEL, LONGER)
    commit(repository)
    monkeypatch.chdir(tmp_path)
    settings: DiffSettings = {"select": "INR003", "tier": "source", "cache": False}
    found = urdfcheck.diff_commits("HEAD~1..HEAD", repository=repository, **settings)
    assert [model.headline for model in found.models] == ["tool0 moves by 41 mm in every configuration"]
    write(repository / "other/notes.txt", "")
    commit(repository)
    limited = urdfcheck.diff_commits("HEAD~2..HEAD", [repository / "other"], repository=repository, **settings)
    assert (limited.models, limited.failures) == ((), ())


def test_three_dots_begin_at_the_common_ancestor(repository: Path) -> None:
    git(repository, "checkout", "-q", "-b", "topic")
    write(repository / "arm_description/urdf/extra.urdf", "<robot name='e'><link name='a'/></robot>")
    commit(repository)
    git(repository, "checkout", "-q", "main")
    write(repository / MODEL, LONGER)
    commit(repository)
    assert [model.headline for model in compare("main...topic").models] == ["the model is new"]
    assert len(compare("main..topic").models) == 2


def test_a_renamed_property_is_cosmetic(repository: Path) -> None:
    write(repository / "parts/package.xml", MANIFEST.format("parts"))
    write(repository / "parts/wheel.xacro", WHEEL)
    write(repository / "car/package.xml", MANIFEST.format("car"))
    write(repository / "car/car.urdf.xacro", XACRO)
    commit(repository)
    write(repository / "parts/wheel.xacro", WHEEL.replace("reach", "wheel_x"))
    diff = compare()
    assert [(Path(model.after).name, model.verdict) for model in diff.models] == [("car.urdf.xacro", "cosmetic")]


def test_an_included_file_of_another_package_touches_its_users_only(repository: Path) -> None:
    write(repository / "parts/package.xml", MANIFEST.format("parts"))
    write(repository / "parts/wheel.xacro", WHEEL)
    write(repository / "car/package.xml", MANIFEST.format("car"))
    write(repository / "car/car.urdf.xacro", XACRO)
    commit(repository)
    write(repository / "parts/wheel.xacro", WHEEL.replace('value="0.3"', 'value="0.35"'))
    (model,) = compare().models
    assert (Path(model.after).name, model.verdict) == ("car.urdf.xacro", "kinematic")
    shown = show(compare())
    assert '- HEAD:parts/wheel.xacro:2  <xacro:property name="reach" value="0.3"/>' in shown
    assert '+ parts/wheel.xacro:2  <xacro:property name="reach" value="0.35"/>' in shown
    assert compare("", "arm_description").models == ()  # nothing there uses it
    assert len(compare("", "parts/wheel.xacro").models) == 1
    assert len(compare("", "car").models) == 1


def test_macros_that_no_model_is_known_to_use_are_not_identical(repository: Path) -> None:
    """A model that cannot be expanded may use them: what it includes is computed."""
    write(repository / "car/package.xml", MANIFEST.format("car"))
    write(repository / "car/wheel_big.xacro", WHEEL)
    computed = XACRO.replace("$(find parts)/wheel.xacro", "wheel_$(arg size).xacro").replace(
        "<link", '<xacro:arg name="size" default="$(find nowhere)"/><link'
    )
    write(repository / "car/car.urdf.xacro", computed)
    commit(repository)
    write(repository / "car/wheel_big.xacro", WHEEL.replace('value="0.3"', 'value="0.35"'))
    diff = compare()
    assert diff.verdict == "unknown"
    assert [Path(model.after).name for model in diff.models] == ["car.urdf.xacro"]
    assert diff.notes == ("car/wheel_big.xacro: no model that was compared is made of it",)


def test_edits_that_the_arguments_leave_out_are_told(repository: Path) -> None:
    write(repository / "parts/package.xml", MANIFEST.format("parts"))
    branch = '<xacro:arg name="more" default="false"/>\n<xacro:if value="$(arg more)">\n<link name="x"/>\n</xacro:if>\n'
    write(repository / "parts/wheel.xacro", WHEEL)
    text = XACRO.replace('<link name="base"/>', f'<link name="base"/>\n{branch}')
    write(repository / "car/car.urdf.xacro", text)
    commit(repository)
    write(repository / "car/car.urdf.xacro", text.replace('"x"', '"y"'))
    (model,) = compare().models
    assert (model.verdict, model.headline) == ("cosmetic", "cosmetic: the robot is the same with these arguments")
    number = text.splitlines().index('<link name="x"/>') + 1
    assert model.idle_edits == (
        ("car/car.urdf.xacro", number, '<link name="y"/>'),
        ("HEAD:car/car.urdf.xacro", number, '<link name="x"/>'),
    )
    assert f"2 edited lines make no part of this robot, first car/car.urdf.xacro:{number} (" in show(compare())
    write(repository / "car/car.urdf.xacro", text.replace('default="false"', 'default="0"'))
    assert compare().models[0].headline == "cosmetic: the robot is the same with these arguments"
    write(repository / "car/car.urdf.xacro", text.replace("<xacro:wheel/>", "<!-- a wheel --><xacro:wheel/>"))
    assert compare().models[0].headline == "cosmetic: the robot is the same"


def test_an_edited_condition_is_the_cause_of_what_it_lets_in(repository: Path) -> None:
    """The included file is the same in both versions, though the first does not read it."""
    text = (
        XACRO.replace("<xacro:include", '<xacro:if value="${False}">\n<xacro:include')
        .replace("</robot>", "</xacro:if></robot>")
        .replace('<link name="base"/>', "")
        .replace("<xacro:wheel/>", '<link name="base"/>\n<xacro:wheel/>')
    )
    text = text.replace("\n</robot>", "</robot>").replace('name="car">', 'name="car">\n<link name="root"/>')
    text = text.replace(
        "<xacro:wheel/>",
        '<xacro:wheel/><joint name="j" type="fixed"><parent link="root"/><child link="base"/></joint>',
    )
    write(repository / "parts/package.xml", MANIFEST.format("parts"))
    write(repository / "parts/wheel.xacro", WHEEL)
    write(repository / "car/car.urdf.xacro", text)
    commit(repository)
    write(repository / "car/car.urdf.xacro", text.replace("{False}", "{True}"))
    (model,) = compare().models
    assert model.mechanism is not None
    assert {cause.is_edited for cause in model.mechanism.causes} == {True}
    assert [line for cause in model.mechanism.causes for _, _, line in (*cause.before, *cause.after)] == [
        '<xacro:if value="${True}">'
    ]


@pytest.mark.parametrize(
    ("definition", "condition"),
    [
        ('<xacro:arg name="rolls" default="{}"/>', "$(arg rolls)"),
        ('<xacro:property name="rolls" value="{}"/>', "${rolls}"),
    ],
)
def test_a_switch_is_the_cause_of_what_it_lets_in(repository: Path, definition: str, condition: str) -> None:
    """Neither the condition nor what it holds was edited."""
    lines = [definition, f'<xacro:property name="on" value="{condition}"/>', '<xacro:if value="${on}">']
    text = XACRO.replace("  <xacro:wheel/>\n", "\n".join(["", *lines, "<xacro:wheel/>", "</xacro:if>", ""]))
    write(repository / "parts/package.xml", MANIFEST.format("parts"))
    write(repository / "parts/wheel.xacro", WHEEL)
    write(repository / "car/car.urdf.xacro", text.replace("{}", "false"))
    commit(repository)
    write(repository / "car/car.urdf.xacro", text.replace("{}", "true"))
    (model,) = compare().models
    assert model.mechanism is not None
    (cause,) = model.mechanism.causes
    assert [line for _, _, line in (*cause.before, *cause.after)] == [definition.format("true")]


def test_a_replaced_mesh_touches_its_model(repository: Path) -> None:
    write(repository / "arm_description/urdf/box.urdf", MESHED)
    write(repository / "arm_description/meshes/part.stl", CUBE.format(1))
    commit(repository)
    write(repository / "arm_description/meshes/part.stl", CUBE.format(2))
    (model,) = compare().models
    assert (Path(model.after).name, model.verdict) == ("box.urdf", "visual")


def test_a_model_that_is_new_gone_or_ignored(repository: Path) -> None:
    extra = "<robot name='e'><link name='a'/></robot>"
    write(repository / "arm_description/urdf/extra.urdf", extra)
    write(repository / ".gitignore", "made/\n")
    write(repository / "made/made.urdf", extra)
    (repository / MODEL).unlink()
    found = {Path(m.after or m.before).name: m.headline for m in compare().models}
    assert found == {"extra.urdf": "the model is new", "arm.urdf": "the model is gone"}


def test_a_new_model_that_cannot_be_read_is_unknown(repository: Path) -> None:
    write(repository / "arm_description/urdf/extra.urdf", "<robot")
    found = compare()
    (model,) = found.models
    assert (model.verdict, len(found.failures)) == ("unknown", 1)
    assert model.headline.startswith("cannot be compared: it is new, and not well-formed XML")


def test_a_model_that_moved_is_found_by_its_name(repository: Path) -> None:
    git(repository, "mv", MODEL, "arm_description/arm.urdf")
    (model,) = compare().models
    assert (model.matched_by, model.verdict) == ("name", "identical")
    assert (model.before, model.after) == (MODEL, "arm_description/arm.urdf")


def test_a_sparse_checkout_lacks_nothing(repository: Path) -> None:
    git(repository, "update-index", "--skip-worktree", MODEL)
    (repository / MODEL).unlink()
    diff = compare()
    assert (diff.models, diff.notes) == (
        (),
        (f"{MODEL}: the sparse checkout leaves it out; taken from the other version",),
    )


def test_a_page_of_text_touches_nothing(repository: Path) -> None:
    write(repository / "README.md", "# Arm")
    diff = compare()
    assert (diff.models, diff.verdict) == ((), "identical")
    assert show(diff) == "identical: no robot uses a file that differs\n"


def test_a_manifest_touches_the_models_of_its_package(repository: Path) -> None:
    write(repository / "arm_description/package.xml", MANIFEST.format("arm_description").replace("1.0.0", "1.0.1"))
    assert [model.verdict for model in compare().models] == ["identical"]


def test_line_ends_that_git_wrote_are_not_a_change(repository: Path) -> None:
    write(repository / MODEL, ARM.replace("\n", "\r\n"))
    assert compare().models == ()


# -- what git keeps elsewhere ------------------------------------------------------------------------------------------


def test_contents_of_git_lfs_are_compared_where_they_are_here(repository: Path) -> None:
    old, new = CUBE.format(1).encode(), CUBE.format(2).encode()
    pointers = [POINTER.format(hashlib.sha256(data).hexdigest(), len(data)) for data in (old, new)]
    mesh = repository / "arm_description/meshes/part.stl"
    write(repository / "arm_description/urdf/box.urdf", MESHED)
    write(mesh, pointers[0])
    commit(repository)
    write(mesh, old)  # as the filter of LFS leaves it
    assert compare().models == ()
    write(mesh, new)
    diff = compare()
    assert diff.notes == ("HEAD:arm_description/meshes/part.stl: only a Git LFS pointer is here (git lfs fetch)",)
    digest = hashlib.sha256(old).hexdigest()
    place = repository / ".git/lfs/objects" / digest[:2] / digest[2:4] / digest
    write(place, old)
    diff = compare()
    assert (diff.notes, [m.verdict for m in diff.models]) == ((), ["visual"])
    write(place, b"solid other")  # not the content of this digest
    assert len(compare().notes) == 1


def test_submodules_are_named(repository: Path, tmp_path: Path) -> None:
    other = tmp_path / "other"
    other.mkdir()
    git(other, "init", "-q")
    write(other / "a.urdf", "<robot name='e'><link name='a'/></robot>")
    commit(other)
    git(repository, "submodule", "--quiet", "add", str(other), "sub")
    commit(repository)
    write(repository / MODEL, LONGER)
    diff = compare()
    assert diff.notes == ("sub: it is a submodule",)
    git(repository, "submodule", "--quiet", "add", str(other), "sub_2")
    assert compare().notes == ("sub, sub_2: they are submodules",)
    assert len(diff.models) == 1
    write(repository / "sub/a.urdf", "<robot name='e'><link name='b'/></robot>")
    (model,) = compare("", "sub/a.urdf").models  # the repository around the path
    assert model.headline == "structure changes: link a is no longer the root: that is b"


def test_a_linked_work_tree_and_a_submodule_are_repositories(repository: Path, tmp_path: Path) -> None:
    git(repository, "worktree", "add", "-q", str(tmp_path / "linked"))
    write(tmp_path / "linked" / MODEL, LONGER)
    assert compare("", str(tmp_path / "linked" / MODEL)).verdict == "kinematic"
    outer = tmp_path / "outer"
    outer.mkdir()
    git(outer, "init", "-q")
    git(outer, "submodule", "--quiet", "add", str(repository), "robots")
    write(outer / "robots" / MODEL, LONGER)
    assert compare("", str(outer / "robots" / MODEL)).verdict == "kinematic"


# -- strangers ---------------------------------------------------------------------------------------------------------


def test_nothing_that_a_repository_plants_runs(repository: Path, tmp_path: Path) -> None:
    mark = tmp_path / "ran"
    script = tmp_path / "evil.sh"
    write(script, f"#!/bin/sh\necho ran >> '{mark}'\ncat\n")
    script.chmod(0o755)
    for name in ("post-index-change", "post-checkout", "reference-transaction", "pre-commit", "fsmonitor-watchman"):
        hook = repository / ".git/hooks" / name
        write(hook, script.read_bytes())
        hook.chmod(0o755)
    for key in (
        *(
            "core.fsmonitor",
            "core.pager",
            "core.sshCommand",
            "core.gitProxy",
            "diff.external",
            "core.alternateRefsCommand",
        ),
        *(
            "filter.evil.clean",
            "filter.evil.smudge",
            "filter.evil.process",
            "diff.evil.textconv",
            "uploadpack.packObjectsHook",
        ),
    ):
        git(repository, "config", key, str(script))
    (repository / ".git/info").mkdir(exist_ok=True)
    write(repository / ".git/info/attributes", "* filter=evil diff=evil\n")
    write(repository / ".gitattributes", "* filter=evil diff=evil export-subst ident working-tree-encoding=UTF-16\n")
    write(repository / MODEL, LONGER)
    assert compare().verdict == "kinematic"
    assert compare("HEAD..HEAD").models == ()
    assert not mark.exists()


def test_a_missing_object_is_not_fetched(repository: Path, tmp_path: Path) -> None:
    mark = tmp_path / "ran"
    script = tmp_path / "evil.sh"
    write(script, f"#!/bin/sh\necho ran >> '{mark}'\n")
    script.chmod(0o755)
    oid = git(repository, "rev-parse", f"HEAD:{MODEL}")
    place = repository / ".git/objects" / oid[:2] / oid[2:]
    place.chmod(0o644)
    place.unlink()
    for key, value in (
        *(
            ("core.repositoryformatversion", "1"),
            ("extensions.partialclone", "origin"),
            ("remote.origin.promisor", "true"),
        ),
        *(
            ("remote.origin.url", f"ext::{script}"),
            ("remote.origin.uploadpack", str(script)),
            ("protocol.allow", "always"),
        ),
    ):
        git(repository, "config", key, value)
    diff = compare()
    assert f"HEAD:{MODEL}: it is too large, or this clone does not have it" in diff.notes
    assert not mark.exists()


def make_tree(folder: Path, *entries: tuple[str, str, str]) -> str:
    """Commit a tree of (mode, name, text) that git itself would not make."""
    data = b""
    for mode, name, text in entries:
        kind = "tree" if mode == "40000" else "blob"
        oid = text if kind == "tree" else git(folder, "hash-object", "-w", "--stdin", text=text)
        data += f"{mode} {name}".encode() + b"\0" + bytes.fromhex(oid)
    done = subprocess.run(
        ["git", "-C", str(folder), "hash-object", "-w", "-t", "tree", "--stdin", "--literally"],
        input=data, capture_output=True, check=True,
    )  # fmt: skip
    return done.stdout.decode().strip()


def test_hostile_names_and_links_stay_inside(repository: Path, tmp_path: Path) -> None:
    write(tmp_path / "secret.urdf", "<robot name='s'><link name='secret'/></robot>")
    inner = make_tree(repository, ("100644", "escaped.urdf", "<robot name='e'><link name='a'/></robot>"))
    tree = make_tree(
        repository,
        ("40000", "..", inner),
        ("40000", ".git", inner),
        ("120000", "absolute.urdf", str(tmp_path / "secret.urdf")),
        ("100644", "arm.urdf", LONGER),
        ("120000", "folder", ".."),
        ("120000", "good.urdf", "arm.urdf"),
        ("120000", "out.urdf", "folder/../../../../../../../../../../etc/passwd"),
        ("100644", "red\x1b[31m.urdf", ARM),
    )
    made = git(repository, "commit-tree", tree, "-m", "m")
    diff = compare(f"HEAD..{made}")
    notes = " | ".join(diff.notes)
    for name in ("../escaped.urdf", ".git/escaped.urdf", "absolute.urdf", "folder", "out.urdf", "red\x1b[31m.urdf"):
        assert name in notes
    shown = show(diff)
    assert "secret" not in shown.replace(str(tmp_path), "")
    assert "\x1b" not in shown
    assert not (repository.parent / "escaped.urdf").exists()


@pytest.mark.parametrize(
    ("name", "is_hostile"),
    [
        *(
            (name, True)
            for name in ("../a", "a/../b", "/a", "a//b", ".git/config", "a/.GIT/x", "a/.git ./x", "GIT~1/x")
        ),
        *((name, True) for name in ("a\nb", "a\x00b", "./a")),
        *((name, False) for name in ("a/b.urdf", ".github/x", "a..b", "ä ö.urdf", ".gitignore", "-a")),
    ],
)
def test_names_that_could_leave_or_act_are_hostile(name: str, is_hostile: bool) -> None:
    assert is_hostile_name(name) == is_hostile


def test_objects_of_another_repository_are_refused(repository: Path, tmp_path: Path) -> None:
    private = tmp_path / "private"
    private.mkdir()
    git(private, "init", "-q")
    write(private / "a.urdf", ARM)
    commit(private)
    write(repository / ".git/objects/info/alternates", f"{private}/.git/objects\n")
    with pytest.raises(UrdfcheckError, match="borrows objects"):
        compare()
    assert compare(allowed=[str(private / ".git/objects")]).verdict == "identical"
    stranger = tmp_path / "stranger"
    write(stranger / "a.urdf", LONGER)
    write(stranger / ".git", f"gitdir: {private}/.git\n")
    with pytest.raises(UrdfcheckError, match="leads to another repository"):
        compare("", str(stranger / "a.urdf"))
    (stranger / ".git").unlink()
    (stranger / ".git").symlink_to(private / ".git")
    with pytest.raises(UrdfcheckError, match="leads to another repository"):
        compare("", str(stranger / "a.urdf"))


def test_replaced_objects_and_variables_of_a_hook_do_not_matter(
    repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    old = git(repository, "rev-parse", f"HEAD:{MODEL}")
    new = git(repository, "hash-object", "-w", "--stdin", text=LONGER)
    git(repository, "replace", old, new)
    assert compare().models == ()
    monkeypatch.setenv("GIT_DIR", "/nowhere")
    monkeypatch.setenv("GIT_INDEX_FILE", "/nowhere/index")
    monkeypatch.setenv("GIT_CONFIG_COUNT", "1")
    monkeypatch.setenv("GIT_CONFIG_KEY_0", "core.bare")
    monkeypatch.setenv("GIT_CONFIG_VALUE_0", "true")
    assert compare().models == ()


# -- the command -------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_command_compares_revisions_and_fails_as_asked(repository: Path) -> None:
    write(repository / MODEL, LONGER)
    commit(repository)
    done = command("diff", "HEAD~1..HEAD", *QUICK, "--fail-on", "kinematic", "--", MODEL, cwd=repository)
    assert (done.returncode, done.stderr) == (FINDINGS, "")
    assert done.stdout.startswith("tool0 moves by 41 mm")
    done = command(
        "diff", *QUICK, "--package", "arm_description=arm_description", cwd=repository / "arm_description/.."
    )
    assert (done.returncode, done.stdout) == (OK, "identical: no robot uses a file that differs\n")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("absent",), "absent: there is no such revision"),
        (("HEAD~9..HEAD",), "HEAD~9: there is no such revision"),
        (("HEAD...absent",), "absent: there is no such revision"),
        (("HEAD", "HEAD~1"), "two revisions are written HEAD..HEAD~1"),
        (("arm_description",), "write -- arm_description to compare"),
        (("HEAD", "--", "../elsewhere.urdf"), "../elsewhere.urdf: it is outside the repository"),
        (("HEAD", "--", MODEL, "*.urdf"), "*.urdf: neither version has it"),
        (("a", "b", "--", "c"), "name two paths"),
        (("--", ""), "a path is empty"),
        (("HEAD\x1b[31m",), "there is no such revision"),
    ],
)
@pytest.mark.usefixtures("one_process")
def test_wrong_words_are_refused(repository: Path, words: tuple[str, ...], said: str) -> None:
    done = command("diff", *words, *(() if "--" in words else QUICK), cwd=repository)
    assert (done.returncode, done.stdout) == (FAILED, "")
    assert said in done.stderr
    assert "\x1b" not in done.stderr
    assert str(repository) not in done.stderr


def test_no_repository_no_commit_and_no_git(tmp_path: Path) -> None:
    done = command("diff", *QUICK, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (FAILED, "")
    assert ". is not in the work tree of a git repository" in done.stderr
    git(tmp_path, "init", "-q")
    done = command("diff", *QUICK, cwd=tmp_path)
    assert done.returncode == FAILED
    assert "HEAD: there is no such revision (the repository has no commit yet)" in done.stderr
    (tmp_path / "a.urdf").write_text(ARM)
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "-qm", "x")
    done = command("diff", "origin/HEAD...HEAD", *QUICK, cwd=tmp_path)
    assert done.returncode == FAILED
    assert "origin/HEAD: there is no such revision (git remote set-head origin --auto makes it)" in done.stderr
    done = command("diff", *QUICK, cwd=tmp_path, PATH=os.path.join(tmp_path, "nowhere"))
    assert done.returncode == FAILED
    assert "git is not installed" in done.stderr
