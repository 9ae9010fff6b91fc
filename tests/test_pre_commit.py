"""The pre-commit hooks, run by pre-commit itself in a repository of a user."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import tomli
import yaml
from conftest import FIXTURES, REPOSITORY

pytestmark = [pytest.mark.slow, pytest.mark.long]


def git(*words: str, cwd: Path) -> None:
    subprocess.run(
        ["git", "-c", "user.name=t", "-c", "user.email=t@example.org", *words], cwd=cwd, check=True, capture_output=True
    )


@pytest.mark.smoke
def test_the_manifest_is_valid() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "pre_commit", "validate-manifest", str(REPOSITORY / ".pre-commit-hooks.yaml")]
    )
    assert done.returncode == 0


@pytest.mark.smoke
def test_the_light_hook_of_the_guide_is_ours_with_another_distribution() -> None:
    guide = (REPOSITORY / "docs" / "continuous-integration.md").read_text(encoding="utf-8")
    (block,) = (block for block in re.findall(r"```yaml\n(.*?)```", guide, re.DOTALL) if "repo: local" in block)
    ((light,),) = (entry["hooks"] for entry in yaml.safe_load(block))
    (needed,) = light.pop("additional_dependencies")
    name, _, folder = needed.partition("@")[0].strip(), *needed.partition("#subdirectory=")[1:]
    project = tomli.loads((REPOSITORY / folder / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert name == project["name"] == "urdfcheck-core"
    hooks = {hook["id"]: hook for hook in yaml.safe_load((REPOSITORY / ".pre-commit-hooks.yaml").read_text())}
    assert light.items() <= hooks["urdfcheck"].items()


@pytest.fixture(scope="module")
def hooks(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A repository with our hooks whose install step is the package that is already here.

    try-repo would install the package with everything it needs into a new environment for each run; what is under test
    is the manifest (which files lead to which command) and what the command does with them.
    """
    folder = tmp_path_factory.mktemp("hooks")
    manifest = (REPOSITORY / ".pre-commit-hooks.yaml").read_text()
    manifest = manifest.replace("language: python", "language: system")
    assert manifest.count("entry: python -I") == 3
    manifest = manifest.replace("entry: python", f"entry: {sys.executable}")
    (folder / ".pre-commit-hooks.yaml").write_text(manifest)
    git("init", "-q", cwd=folder)
    git("add", ".", cwd=folder)
    git("commit", "-qm", "hooks", cwd=folder)
    return folder


@pytest.fixture
def user(tmp_path: Path) -> Path:
    """A user's repository with the car in it."""
    shutil.copytree(FIXTURES / "car-3", tmp_path / "car-3")
    git("init", "-q", cwd=tmp_path)
    git("add", ".", cwd=tmp_path)
    return tmp_path


def try_repo(
    hooks: Path, user: Path, hook: str, *files: str, stage: str = "pre-commit"
) -> subprocess.CompletedProcess[str]:
    words = ["try-repo", str(hooks), hook, "--hook-stage", stage, "--verbose", "--files", *files]
    return subprocess.run(
        [sys.executable, "-m", "pre_commit", *words],
        cwd=user,
        capture_output=True,
        text=True,
        env={**os.environ, "PRE_COMMIT_HOME": str(user / ".cache"), "PRE_COMMIT_COLOR": "never"},
    )


@pytest.mark.smoke
def test_a_changed_model_is_checked(hooks: Path, user: Path) -> None:
    done = try_repo(hooks, user, "urdfcheck", "car-3/urdf/car-3.urdf")
    assert "SYM001" in done.stdout, done.stdout + done.stderr
    assert done.returncode == 0, "car-3.urdf has no finding of severity error"


def test_a_changed_macro_file_is_checked_through_the_model_that_includes_it(hooks: Path, user: Path) -> None:
    done = try_repo(hooks, user, "urdfcheck", "car-3/robot_description/urdf/gazebo.urdf.xacro")
    assert "SYM001" in done.stdout, done.stdout + done.stderr


def test_an_error_fails_the_hook(hooks: Path, user: Path) -> None:
    path = user / "car-3/urdf/car-3.urdf"
    path.write_text(path.read_text().replace('izz="0.00169173411179082"', 'izz="0.169173411179082"'))
    done = try_repo(hooks, user, "urdfcheck", "car-3/urdf/car-3.urdf")
    assert done.returncode == 1
    assert "INR003" in done.stdout


def test_a_changed_mesh_leads_to_its_models(hooks: Path, user: Path) -> None:
    done = try_repo(hooks, user, "urdfcheck-meshes", "car-3/meshes/wheel_1.STL")
    assert "car-3.urdf" in done.stdout, done.stdout + done.stderr
    assert "car_body.urdf.xacro" in done.stdout


SETTINGS = {
    "arm/package.xml": "<package><name>arm</name></package>",
    "arm/urdf/arm.urdf": '<robot name="arm"><link name="base"/><link name="tip"/></robot>',
    "arm_moveit/package.xml": "<package><name>arm_moveit</name><depend>arm</depend></package>",
    "arm_moveit/config/arm.srdf": '<robot name="arm"/>',
    "arm_moveit/config/joint_limits.yaml": "joint_limits: {}",
}


def test_changed_settings_lead_to_their_models(hooks: Path, user: Path) -> None:
    for name, text in SETTINGS.items():
        (user / name).parent.mkdir(parents=True, exist_ok=True)
        (user / name).write_text(text)
    git("add", ".", cwd=user)
    done = try_repo(
        hooks, user, "urdfcheck-meshes", "arm_moveit/config/joint_limits.yaml", "arm_moveit/config/arm.srdf"
    )
    assert "arm/urdf/arm.urdf" in done.stdout, done.stdout + done.stderr
    assert "car-3" not in done.stdout


def test_the_second_hook_starts_for_what_models_are_made_of_and_nothing_else() -> None:
    hooks = {hook["id"]: hook for hook in yaml.safe_load((REPOSITORY / ".pre-commit-hooks.yaml").read_text())}
    starts = re.compile(hooks["urdfcheck-meshes"]["files"])
    for name in (
        *("meshes/Wheel.STL", "a.launch.py", "launch/a_launch.xml", "package.xml", "arm/package.xml", "a b/arm.srdf"),
        *("config/joint_limits.yaml", "moveit/config/ros2_controllers.yaml", "ur/config/ur20/physical.yml"),
    ):
        assert starts.search(name), name
    for name in ("README.md", "docker-compose.yaml", ".github/workflows/ci.yml", "mypackage.xml", "a.stl.orig"):
        assert not starts.search(name), name


def test_what_is_pushed_is_compared_and_stops_nothing(hooks: Path, user: Path, tmp_path: Path) -> None:
    git("commit", "-qm", "x", cwd=user)
    git("clone", "-q", str(user), str(tmp_path / "clone"), cwd=tmp_path)
    path = tmp_path / "clone/car-3/urdf/car-3.urdf"
    text = path.read_text()
    path.write_text(text.replace('izz="0.00169173411179082"', 'izz="0.169173411179082"'))
    git("commit", "-qam", "y", cwd=tmp_path / "clone")
    done = try_repo(hooks, tmp_path / "clone", "urdfcheck-diff", "car-3/urdf/car-3.urdf", stage="pre-push")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "kinematically identical" in done.stdout
    assert "+ HEAD:car-3/urdf/car-3.urdf:" in done.stdout


def test_other_files_do_not_start_the_hook(hooks: Path, user: Path) -> None:
    done = try_repo(hooks, user, "urdfcheck", "car-3/package.xml")
    assert "no files to check" in done.stdout


def test_a_manifest_that_is_none_is_refused(tmp_path: Path) -> None:
    broken = tmp_path / ".pre-commit-hooks.yaml"
    broken.write_text(
        (REPOSITORY / ".pre-commit-hooks.yaml").read_text().replace("language: python", "language: robot")
    )
    done = subprocess.run([sys.executable, "-m", "pre_commit", "validate-manifest", str(broken)], capture_output=True)
    assert done.returncode == 1
