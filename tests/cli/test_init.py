"""Setting up a repository: what is written is valid, works, and takes nothing away."""

from __future__ import annotations

import json
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import tomli
import yaml
from hypothesis import given
from hypothesis import strategies as st
from services import accepts

from urdfcheck import cli
from urdfcheck.cli.commands.setup import init
from urdfcheck.cli.commands.setup.init import HOOKS, LOCAL_HOOKS, PINNED_HOOKS, add_hooks
from urdfcheck.cli.install_origin import InstallOrigin, find_install_origin
from urdfcheck.policy import config_resolver
from urdfcheck.version import __version__

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("one_process")]

ARM = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:if value="${'$(arg side)' == 'left'}"/><xacro:if value="${'$(arg side)' == 'right'}"/>
<link name="$(arg side)_${'$(arg n)'}"/></robot>"""


def make_origin(address: str) -> InstallOrigin:
    return (
        InstallOrigin(address=address, revision="abc", requirement=f"git+{address}@abc") if address else InstallOrigin()
    )


@pytest.fixture
def repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository with a model and one that needs arguments."""
    (tmp_path / ".git").mkdir()
    (tmp_path / "urdf").mkdir()
    (tmp_path / "urdf/base.urdf").write_text('<robot name="r"><link name="base"/></robot>')
    (tmp_path / "urdf/arm.urdf.xacro").write_text(ARM)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_what_launch_files_pass_is_written_down(repository: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (repository / "package.xml").write_text('<package format="3"><name>arm</name><version>1.0.0</version></package>')
    (repository / "launch").mkdir()
    launch = repository / "launch/view.launch.py"
    start = 'path = get_package_share_directory("arm") + "/urdf/arm.urdf.xacro"\n'
    launch.write_text(start + 'Command(["xacro ", path, " side:=right"])\n')
    assert cli.main(["init", "--dry-run"]) == cli.OK
    assert '# arguments = { side = "right", n = "" }' in capsys.readouterr().out
    launch.write_text(start + 'Command(["xacro ", path, " side:=right ", "n:=", "7"])\n')
    assert cli.main(["init"]) == cli.OK
    assert "need" not in capsys.readouterr().out.partition("next")[0]
    (model,) = config_resolver.find_config(repository).models
    assert (model.path.name, dict(model.arguments)) == ("arm.urdf.xacro", {"side": "right", "n": "7"})
    assert '# side: "launch/view.launch.py:2"' in (repository / "urdfcheck.toml").read_text(encoding="utf-8")
    assert cli.main([".", "--tier", "source"]) == cli.OK


def test_a_model_that_cannot_be_expanded_has_a_step_of_its_own(
    repository: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It fails the hook that was written, with a baseline too."""
    include = '<xacro:include filename="$(find elsewhere)/arm.xacro"/>'
    (repository / "urdf/arm.urdf.xacro").write_text(
        f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{include}</robot>'
    )
    assert cli.main(["init"]) == cli.OK
    assert "unchecked = [PATTERNS]       in urdfcheck.toml accepts models" in capsys.readouterr().out
    with (repository / "urdfcheck.toml").open("a", encoding="utf-8") as configuration:
        configuration.write('unchecked = ["urdf/arm.urdf.xacro"]\n')
    assert cli.main(["."]) == cli.OK
    capsys.readouterr()
    (repository / "urdf/arm.urdf.xacro").unlink()
    assert cli.main(["init"]) == cli.OK
    assert "unchecked" not in capsys.readouterr().out


def test_a_repository_is_set_up(repository: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["init"]) == cli.OK
    said = capsys.readouterr().out
    assert "found 2 models, 1 needs arguments" in said
    assert "give urdf/arm.urdf.xacro arguments in urdfcheck.toml" in said
    assert "how urdfcheck is installed" in said
    read = config_resolver.find_config(repository)
    assert [(m.path.name, dict(m.arguments)) for m in read.models] == [("arm.urdf.xacro", {})]
    text = (repository / "urdfcheck.toml").read_text(encoding="utf-8")
    assert '# arguments = { side = "left", n = "" }\n# side: "left", "right"\n' in text
    filled = text.replace('# arguments = { side = "left", n = "" }', 'arguments = { side = "left", n = "1" }')
    assert tomli.loads(filled)["models"][0]["arguments"] == {"side": "left", "n": "1"}
    job = yaml.safe_load((repository / ".github/workflows/urdfcheck.yml").read_text(encoding="utf-8"))
    checks = [step for step in job["jobs"]["urdfcheck"]["steps"] if "-m urdfcheck check" in step.get("run", "")]
    assert [step["env"]["CHECKED"] for step in checks] == ["."]
    done = subprocess.run(
        [sys.executable, "-m", "pre_commit", "validate-config", str(repository / ".pre-commit-config.yaml")]
    )
    assert done.returncode == 0


@pytest.mark.parametrize("text", ["stages: build\n", "? [a]\n: b\n", "stages:\n"])
def test_a_gitlab_file_of_another_form_is_no_crash(repository: Path, text: str) -> None:
    (repository / ".gitlab-ci.yml").write_text(text)
    assert cli.main(["init"]) == cli.OK
    assert (repository / ".gitlab-ci.yml").read_text().startswith(text)


@pytest.mark.parametrize("name", [".pre-commit-config.yaml", ".gitlab-ci.yml"])
@pytest.mark.parametrize(
    "text",
    [
        # Merges that hold each other nine times, twelve deep: 10^11 keys.
        "a0: &a0 {x: 1}\n" + "".join(f"a{i}: &a{i}\n  <<: [{','.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 13)),
        "a: " + "[" * 3000 + "]" * 3000 + "\n",
    ],
    ids=["merges", "nested"],
)
def test_yaml_of_a_stranger_costs_no_more_than_it_is_long(
    repository: Path, name: str, text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (repository / name).write_text(text + "repos:\n- repo: local\n  hooks: []\n")
    before = (repository / name).read_bytes()
    assert cli.main(["init"]) == cli.OK
    assert f"kept      {name}" in capsys.readouterr().out
    assert (repository / name).read_bytes() == before


def test_the_hooks_are_those_of_the_manifest() -> None:
    """Those that check changed files; the hook that compares commits is asked for."""
    from conftest import REPOSITORY

    hooks = yaml.safe_load((REPOSITORY / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
    manifest = [hook for hook in hooks if hook.get("pass_filenames", True)]
    (entry,) = yaml.safe_load(LOCAL_HOOKS)
    same = ("id", "name", "entry", "types_or", "files", "require_serial")
    for hook in manifest:  # which Python has the urdfcheck that is installed, only its own command knows
        hook["entry"] = hook["entry"].removeprefix("python -I -m ")
    assert [{k: h.get(k) for k in same} for h in entry["hooks"]] == [{k: h.get(k) for k in same} for h in manifest]
    (entry,) = yaml.safe_load(PINNED_HOOKS.format(requirement='"urdfcheck==1"'))
    assert [{k: h.get(k) for k in ("id", "types_or", "files")} for h in entry["hooks"]] == [
        {k: h.get(k) for k in ("id", "types_or", "files")} for h in manifest
    ]
    (entry,) = yaml.safe_load(HOOKS.format(address="https://example.org/urdfcheck", revision="abc"))
    assert [hook["id"] for hook in entry["hooks"]] == [hook["id"] for hook in manifest]


def test_a_second_time_changes_nothing(repository: Path, capsys: pytest.CaptureFixture[str]) -> None:
    cli.main(["init"])
    before = {path: path.read_bytes() for path in repository.rglob("*") if path.is_file()}
    capsys.readouterr()
    assert cli.main(["init"]) == cli.OK
    assert {path: path.read_bytes() for path in repository.rglob("*") if path.is_file()} == before
    said = capsys.readouterr().out
    assert said.count("kept") == 3
    assert "how urdfcheck is installed" in said, "it is still to be written"


def test_a_dry_run_writes_nothing_and_shows_everything(repository: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = set(repository.rglob("*"))
    assert cli.main(["init", "--dry-run"]) == cli.OK
    assert set(repository.rglob("*")) == before
    said = capsys.readouterr().out
    assert all(words in said for words in ("would write urdfcheck.toml", "repo: local", "runs-on: ubuntu-latest"))


def test_nothing_to_set_up_is_3(tmp_path: Path) -> None:
    assert cli.main(["init", str(tmp_path)]) == cli.NOTHING
    assert not list(tmp_path.iterdir())


def test_what_is_there_is_added_to(repository: Path) -> None:
    project = '[project]\r\nname = "x" # kept\r\n'
    (repository / "pyproject.toml").write_text(project, newline="")
    ci = "stages: [build, check]\nbuild:\n  script: [make]\n"
    (repository / ".gitlab-ci.yml").write_text(ci)
    hooks = (
        "# ours\nrepos:\n- repo: local\n  hooks:\n  - {id: a, name: a, entry: a, language: system}\n\nci:\n  skip: []\n"
    )
    (repository / ".pre-commit-config.yaml").write_text(hooks)
    assert cli.main(["init"]) == cli.OK
    assert not (repository / "urdfcheck.toml").exists()
    assert not (repository / ".github").exists()
    after = (repository / "pyproject.toml").read_bytes().decode()
    assert after.startswith(project)
    assert "\n" not in after.replace("\r\n", "")
    assert config_resolver.find_config(repository).file == repository / "pyproject.toml"
    assert len(config_resolver.find_config(repository).models) == 1
    job = (repository / ".gitlab-ci.yml").read_text()
    assert job.startswith(ci)
    assert yaml.safe_load(job)["urdfcheck"]["stage"] == "build"
    after = (repository / ".pre-commit-config.yaml").read_text()
    assert after.replace(LOCAL_HOOKS, "") == hooks
    assert yaml.safe_load(after)["ci"] == {"skip": []}


@pytest.mark.parametrize(
    ("address", "ci"),
    [
        ("", None),
        ("https://example.org/u", None),
        ("https://github.com/some-one/urdfcheck.git", None),
        ("https://example.org/u", "build:\n  script: [make]\n"),
    ],
)
def test_what_is_written_for_a_service_is_valid_whatever_the_folder_is_called(
    repository: Path, monkeypatch: pytest.MonkeyPatch, address: str, ci: str | None
) -> None:
    monkeypatch.setattr(init, "find_install_origin", lambda: make_origin(address))
    strange = """  it's "a" \\ # robot: $(touch broken) %s -x: [é😀] &a *b """
    (repository / "urdf").rename(repository / strange)
    if ci is not None:
        (repository / ".gitlab-ci.yml").write_text(ci)
    assert cli.main(["init", strange]) == cli.OK
    if ci is not None:
        text = (repository / ".gitlab-ci.yml").read_text()
        assert accepts("gitlab-ci", text)
        script = yaml.safe_load(text)["urdfcheck"]["script"]
        assert shlex.split(script[-1], comments=False)[-1] == strange
        return
    text = (repository / ".github/workflows/urdfcheck.yml").read_text()
    assert accepts("github-workflows", text)
    steps = yaml.safe_load(text)["jobs"]["urdfcheck"]["steps"]
    if "github.com" in address:
        assert steps[-1]["uses"] == "some-one/urdfcheck@abc"
        assert steps[-1]["with"]["paths"] == strange
    else:
        assert [step["env"]["CHECKED"] for step in steps if "CHECKED" in step.get("env", {})] == [strange]


@pytest.mark.parametrize(
    "name",
    ["m\n      - run: echo pwned", "a\tb", "b ${{ secrets.X }}", "c\u2028d", "e\x85f", "\x1b[31mg", "h\u202ei"],
    ids=ascii,
)
@pytest.mark.parametrize("address", ["", "https://github.com/some-one/urdfcheck"])
def test_a_folder_whose_name_would_be_syntax_is_refused(
    repository: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], name: str, address: str
) -> None:
    monkeypatch.setattr(init, "find_install_origin", lambda: make_origin(address))
    (repository / "urdf").rename(repository / name)
    before = set(repository.rglob("*"))
    assert cli.main(["init", name]) == cli.FAILED
    assert "rename the folder" in capsys.readouterr().err
    assert set(repository.rglob("*")) == before


def test_names_of_models_and_arguments_are_text_in_the_configuration(repository: Path) -> None:
    name = 'é😀"\\\n[[models]]\u2028\x7f\t.urdf.xacro'
    (repository / "urdf/arm.urdf.xacro").rename(repository / "urdf" / name)
    assert cli.main(["init"]) == cli.OK
    text = (repository / "urdfcheck.toml").read_text(encoding="utf-8")
    assert [model["path"] for model in tomli.loads(text)["models"]] == [f"urdf/{name}"]


def test_a_link_is_not_written_through(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    (repository / ".github").symlink_to(elsewhere)
    assert cli.main(["init"]) == cli.OK
    assert not list(elsewhere.iterdir())


def test_models_further_down_and_what_is_run_for_them(repository: Path) -> None:
    (repository / "src").mkdir()
    (repository / "urdf").rename(repository / "src/urdf")
    assert cli.main(["init", "src"]) == cli.OK
    assert (repository / "src/urdfcheck.toml").exists()
    assert 'CHECKED: "src"' in (repository / ".github/workflows/urdfcheck.yml").read_text()


@pytest.mark.parametrize(
    "before",
    ["repos: []\n", "repos: [{repo: local, hooks: []}]\n", "a: 1\n", "[1]\n", "repos:\n", "x: [\n", ""],
)
def test_a_list_that_cannot_be_added_to_is_left(before: str) -> None:
    assert add_hooks(before, LOCAL_HOOKS) is None


SCALARS = st.sampled_from(
    ["a", "'b # c'", "[x, y]", "|\n{0}  text\n{0}  more", "{{p: 1}}", "3 # why", ">-\n{0}  folded"]
)


@given(
    st.lists(SCALARS, min_size=1, max_size=4),
    st.integers(0, 4),
    st.sampled_from(["", "\n", "# end\n", "\n\nci:\n  skip: [a]\n", "\nfail_fast: true # last\n"]),
    st.sampled_from(["\n", "\r\n"]),
)
def test_every_other_byte_of_a_list_stays(values: list[str], columns: int, rest: str, newline: str) -> None:
    dash = " " * columns
    entries = "".join(f"{dash}- repo: r{i}\n{dash}  note: {v.format(dash + '  ')}\n" for i, v in enumerate(values))
    before = f"# first\nrepos:\n{entries}{rest}".replace("\n", newline)
    after = add_hooks(before, LOCAL_HOOKS)
    assert after is not None
    added = "".join(dash + line for line in LOCAL_HOOKS.splitlines(keepends=True)).replace("\n", newline)
    assert after.replace(added, "", 1) == before
    assert len(yaml.safe_load(after)["repos"]) == len(values) + 1


def test_the_address_is_taken_from_what_pip_wrote_down(monkeypatch: pytest.MonkeyPatch) -> None:
    import importlib.metadata

    class Installed:
        def __init__(self, text: str | None, name: str = "urdfcheck") -> None:
            self.text = text
            self.metadata = {"Name": name}

        def read_text(self, name: str) -> str | None:
            return self.text if name == "direct_url.json" else None

    commit = InstallOrigin(requirement="git+https://example.org/u@abc", address="https://example.org/u", revision="abc")
    for text, expected in (
        ('{"url": "https://example.org/u", "vcs_info": {"vcs": "git", "commit_id": "abc"}}', commit),
        (
            '{"url": "https://example.org/u.whl", "archive_info": {}}',
            InstallOrigin(requirement="urdfcheck @ https://example.org/u.whl"),
        ),
        (None, InstallOrigin(requirement=f"urdfcheck=={__version__}")),  # from an index
        ('{"url": "file:///u.whl", "archive_info": {}}', InstallOrigin()),
        ('{"url": "file:///x", "dir_info": {"editable": true}}', InstallOrigin()),
        ("{", InstallOrigin()),
    ):
        monkeypatch.setattr(importlib.metadata, "distribution", lambda _, text=text: Installed(text))
        assert find_install_origin() == expected
    light = (
        '{"url": "https://example.org/u", "vcs_info": {"commit_id": "abc"}, "subdirectory": "packages/urdfcheck-core"}'
    )
    for text, requirement in (
        (None, f"urdfcheck-core=={__version__}"),
        (light, "urdfcheck-core @ git+https://example.org/u@abc#subdirectory=packages/urdfcheck-core"),
    ):
        monkeypatch.setattr(importlib.metadata, "distribution", lambda _, text=text: Installed(text, "urdfcheck-core"))
        assert find_install_origin() == InstallOrigin(requirement=requirement)


def test_what_came_from_an_index_is_installed_by_its_version(
    repository: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(init, "find_install_origin", lambda: InstallOrigin(requirement="urdfcheck==1.2.3"))
    assert cli.main(["init"]) == cli.OK
    assert init.UNKNOWN not in capsys.readouterr().out
    (entry,) = yaml.safe_load((repository / ".pre-commit-config.yaml").read_text(encoding="utf-8"))["repos"]
    for hook in entry["hooks"]:
        assert (hook["language"], hook["additional_dependencies"]) == ("python", ["urdfcheck==1.2.3"])
        assert hook["entry"] == "python -I -m urdfcheck --allow-empty"
    job = yaml.safe_load((repository / ".github/workflows/urdfcheck.yml").read_text(encoding="utf-8"))
    steps = job["jobs"]["urdfcheck"]["steps"]
    assert [step["env"]["URDFCHECK"] for step in steps if "URDFCHECK" in step.get("env", {})] == ["urdfcheck==1.2.3"]
    zizmor = Path(sys.executable).with_name("zizmor")
    done = subprocess.run([zizmor, "--offline", ".github"], cwd=repository, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def test_files_for_vs_code_are_written_where_it_looks(
    repository: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert cli.main(["init", "urdf", "--vscode", "--dry-run"]) == cli.OK
    assert not (repository / ".vscode").exists()
    assert len(capsys.readouterr().out) < 10_000
    assert cli.main(["init", "urdf", "--vscode"]) == cli.OK
    assert "wrote     urdfcheck.schema.json" in capsys.readouterr().out
    check, schema = json.loads((repository / ".vscode/tasks.json").read_text(encoding="utf-8"))["tasks"]
    # The model that needs arguments is not checked.
    assert cli.main(check["args"]) == cli.FINDINGS
    assert "urdf/arm.urdf.xacro: not checked" in capsys.readouterr().out
    assert cli.main(schema["command"].partition(" > ")[0].split()[1:]) == cli.OK
    assert capsys.readouterr().out == (repository / "urdfcheck.schema.json").read_text(encoding="utf-8")
    before = {path: path.read_bytes() for path in repository.rglob("*") if path.is_file()}
    (repository / ".vscode/settings.json").write_text('{ "a": 1 } // mine')
    assert cli.main(["init", "urdf", "--vscode"]) == cli.OK
    assert "kept      .vscode/settings.json: it may have comments" in capsys.readouterr().out
    before[repository / ".vscode/settings.json"] = b'{ "a": 1 } // mine'
    assert {path: path.read_bytes() for path in repository.rglob("*") if path.is_file()} == before


CMAKE = "project(r)\nfind_package(ament_cmake REQUIRED)\n{linters}ament_package()\n"
CMAKE_TEST = "if(BUILD_TESTING)\n  find_package(ament_cmake_urdfcheck REQUIRED)\n  ament_urdfcheck()\nendif()\n\n"


def write_package(folder: Path, build: str, depends: str = "  <depend>xacro</depend>\n") -> None:
    export = f"  <export><build_type>{build}</build_type></export>\n"
    (folder / "package.xml").write_text(f'<package format="3">\n  <name>r</name>\n{depends}{export}</package>\n')


@pytest.mark.parametrize("finds_linters", [False, True])
@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_a_package_of_ament_gets_its_test(
    repository: Path, capsys: pytest.CaptureFixture[str], finds_linters: bool, newline: str
) -> None:
    write_package(repository, "ament_cmake")
    cmake, manifest = repository / "CMakeLists.txt", repository / "package.xml"
    linters = "ament_lint_auto_find_test_dependencies()\n" if finds_linters else ""
    cmake.write_text(CMAKE.format(linters=linters))
    for path in (cmake, manifest):
        path.write_text(path.read_text(), newline=newline)
    assert cli.main(["init", "--ament"]) == cli.OK
    assert "copy integrations/ament of urdfcheck" in capsys.readouterr().out
    expected = CMAKE.format(linters=linters or CMAKE_TEST)
    assert cmake.read_bytes().decode() == expected.replace("\n", newline)
    added = "  <depend>xacro</depend>\n  <test_depend>ament_cmake_urdfcheck</test_depend>\n".replace("\n", newline)
    assert added in manifest.read_bytes().decode()
    written = manifest.read_bytes(), cmake.read_bytes()
    assert cli.main(["init", "--ament"]) == cli.OK
    said = capsys.readouterr().out
    assert "kept      package.xml: it depends on ament_cmake_urdfcheck already" in said
    assert "copy integrations/ament" not in said
    assert (manifest.read_bytes(), cmake.read_bytes()) == written


def test_a_package_of_python_gets_a_test_file(repository: Path) -> None:
    write_package(repository, "ament_python")
    assert cli.main(["init", "--ament"]) == cli.OK
    assert "<test_depend>ament_urdfcheck</test_depend>" in (repository / "package.xml").read_text()
    compile((repository / "test/test_urdfcheck.py").read_text(), "test_urdfcheck.py", "exec")


@pytest.mark.parametrize(
    ("build", "depends", "cmake", "says"),
    [
        ("catkin", "", None, "package.xml: its build type is not ament_cmake or ament_python"),
        ("ament_cmake", "", CMAKE.format(linters=""), "package.xml: it has no dependency: add what follows"),
        ("ament_cmake", "<depend>a</depend>", "project(r)\n", "CMakeLists.txt: it does not call ament_package()"),
        ("ament_cmake", "<depend>a</depend>", None, "CMakeLists.txt: "),
    ],
)
def test_a_package_that_cannot_be_added_to_says_why(
    repository: Path, capsys: pytest.CaptureFixture[str], build: str, depends: str, cmake: str | None, says: str
) -> None:
    write_package(repository, build, depends)
    if cmake is not None:
        (repository / "CMakeLists.txt").write_text(cmake)
    assert cli.main(["init", "--ament"]) == cli.OK
    assert f"kept      {says}" in capsys.readouterr().out
