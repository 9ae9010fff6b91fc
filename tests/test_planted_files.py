"""No step of a CI service runs, reads or writes through what a stranger put into the checkout.

Every script of ``action.yml``, of ``integrations/``, of the hooks and of what ``urdfcheck init`` writes is run by bash in a
repository of two commits with a module of every name that Python itself has, with programs, environments and links beside them.
Only what would be downloaded is replaced: pip finds a package that leads to the urdfcheck under test, and a program ``go``
"installs" a program ``reviewdog`` that copies its input. Python installs pip, which takes it seconds, in one environment beside
such files, and the others get a copy of that. The same scripts without ``-I``, all in the checkout, show that the planted files
would run.
"""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest
import yaml
from conftest import REPOSITORY, make_once

from urdfcheck.cli.commands.setup import init
from urdfcheck.cli.install_origin import InstallOrigin

pytestmark = [
    pytest.mark.slow,
    pytest.mark.long,
    pytest.mark.skipif(sys.platform == "win32", reason="the scripts are run by bash"),
]

ROBOT = '<robot name="sound"><link name="base"/></robot>'
# Names that Python, pip or urdfcheck imports and that are no modules of the standard library.
OTHERS = (
    "sitecustomize",
    "usercustomize",
    "pip",
    "urdfcheck",
    "numpy",
    "yaml",
    "rich",
    "tomli",
    "xacro",
    "_virtualenv",
)
PROGRAMS = ("python", "python3", "pip", "git", "go", "mktemp", "bash", "cat", "urdfcheck.exe", "reviewdog")
# Where scripts used to put, or might look for, an environment, a cache or a report.
ENVIRONMENTS = (".urdfcheck", "venv", ".venv", "env", ".cache/pip", ".tox/urdfcheck")
LINKS = (
    *("reports", "urdfcheck-reports", "urdfcheck.html", "urdfcheck.junit.xml", "urdfcheck.codequality.json"),
    *("pages", "urdfcheck-audit", "urdfcheck-baseline.json"),
)


# Before Python is started: an environment is made by the same words, and gets its packages from another.
COPIED = """case "$*" in *"-m venv "*)
    "{python}" "$@" --without-pip || exit
    for made; do :; done
    exec cp -Rp "{packages}/." "$made"/lib/*/site-packages;;
esac"""


@dataclass(frozen=True)
class Step:
    """A script, where it runs, and its own environment."""

    script: str
    outside: bool = False
    environment: Mapping[str, str] | None = None


def read_steps(steps: Sequence[Mapping[str, Any]]) -> Iterator[Step]:
    """The scripts among the steps of a workflow or an action."""
    for step in steps:
        if "run" in step:
            yield Step(step["run"], step.get("working-directory") == "${{ runner.temp }}", step.get("env", {}))


def read_action() -> list[Step]:
    return list(read_steps(yaml.safe_load((REPOSITORY / "action.yml").read_text(encoding="utf-8"))["runs"]["steps"]))


def read_workflow(text: str) -> list[Step]:
    return [step for job in yaml.safe_load(text)["jobs"].values() for step in read_steps(job["steps"])]


def read_gitlab(text: str) -> list[Step]:
    """GitLab gives all lines of a job to one shell, and a job what it extends."""
    document = yaml.safe_load(text)
    steps = []
    for name, job in document.items():
        if not name.startswith("urdfcheck"):
            continue
        whole = {**document.get(job.get("extends"), {}), **job}
        variables = {**document.get("variables", {}), **whole.get("variables", {})}
        steps.append(Step("\n".join((*whole.get("before_script", ()), *whole["script"])), environment=variables))
    return steps


def read_jenkins() -> list[Step]:
    text = (REPOSITORY / "integrations/jenkins/Jenkinsfile").read_text(encoding="utf-8")
    environment = dict(re.findall(r"^ +(\w+) = '(.*)'", text, re.MULTILINE))
    # In a string of Groovy a backslash at the end of a line joins it with the next.
    scripts = [script.replace("\\\n", "") for script in re.findall(r"sh '''(.*?)'''", text, re.DOTALL)]
    assert len(scripts) == text.count("sh '")
    return [Step(script, environment=environment) for script in scripts]


def read_hooks() -> list[Step]:
    """pre-commit runs the words of an entry in the repository, with the programs of its environment first."""
    hooks = yaml.safe_load((REPOSITORY / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
    return [
        Step(shlex.join([*shlex.split(hook["entry"]), *hook.get("args", ()), *files]))
        for hook in hooks
        for files in [["robot.urdf"] if hook.get("pass_filenames", True) else []]
    ]


def write_by_init(folder: Path, patch: pytest.MonkeyPatch, *, gitlab: bool) -> list[Step]:
    """What `init` writes where pip does not know where urdfcheck came from."""
    repository = folder / "of init"
    (repository / ".git").mkdir(parents=True)
    (repository / "robot.urdf").write_text(ROBOT)
    if gitlab:
        (repository / init.GITLAB).write_text("build:\n  script: [make]\n")
    patch.setattr(init, "find_install_origin", InstallOrigin)
    assert init.main([str(repository)]) == 0
    text = (repository / (init.GITLAB if gitlab else init.GITHUB)).read_text(encoding="utf-8")
    return read_gitlab(text) if gitlab else read_workflow(text)


KINDS = ("action", "workflow", "reviewdog", "gitlab", "jenkins", "hooks", "init for GitHub", "init for GitLab")


@pytest.fixture(params=KINDS)
def steps(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[Step]:
    """All scripts of one place."""
    folder = REPOSITORY / "integrations"
    kind: str = request.param
    if kind.startswith("init"):
        return write_by_init(tmp_path, monkeypatch, gitlab=kind.endswith("GitLab"))
    found = {
        "action": read_action,
        "workflow": lambda: read_workflow((folder / "github/urdfcheck.yml").read_text(encoding="utf-8")),
        "reviewdog": lambda: read_workflow((folder / "github/reviewdog.yml").read_text(encoding="utf-8")),
        "gitlab": lambda: read_gitlab((folder / "gitlab/urdfcheck.gitlab-ci.yml").read_text(encoding="utf-8")),
        "jenkins": read_jenkins,
        "hooks": read_hooks,
    }[kind]()
    assert found
    return found


def test_every_file_of_the_integrations_is_looked_at() -> None:
    """A new file must get its scripts run here, or be named as one without any."""
    files = {
        path.relative_to(REPOSITORY / "integrations").as_posix() for path in (REPOSITORY / "integrations").rglob("*")
    }
    tried_elsewhere = ("ros2/", "ament/")  # by colcon, in tests of their own
    assert {
        name
        for name in files
        if (REPOSITORY / "integrations" / name).is_file() and not name.startswith(tried_elsewhere)
    } == {
        *("README.md", "github/urdfcheck.yml", "github/reviewdog.yml", "gitlab/urdfcheck.gitlab-ci.yml"),
        *("jenkins/Jenkinsfile", "github/renew_comment.py"),  # the last is run by the action
        "agents/urdfcheck/SKILL.md",
        *("github/urdfcheck-matcher.json", "vscode/settings.json", "vscode/tasks.json"),  # patterns and settings
    }


def fill_in(text: str, known: Mapping[str, str]) -> str:
    """Look up the expressions of GitHub; what is not there is empty, as there."""
    return re.sub(r"\$\{\{ ([^}]+) \}\}", lambda found: known.get(found.group(1), ""), text)


class Machine:
    """A machine of a CI service with a stranger's checkout, and what is installed from without a network."""

    def __init__(self, folder: Path, packages: Path | None = None) -> None:
        """``packages``: what comes into each environment; None: what Python itself installs there."""
        self.folder = folder
        self.ran = folder / "ran"
        self.elsewhere = folder / "elsewhere"
        self.temp = folder / "temp"
        self.checkout = folder / "work/checkout"
        for made in (self.elsewhere, self.temp, self.checkout, folder / "home", folder / "bin"):
            made.mkdir(parents=True)
        self.plant()
        self.commits = self.commit()
        self.wheel = self.make_wheel(folder)
        self.action = self.make_action()
        copied = "" if packages is None else COPIED.format(python=sys.executable, packages=packages)
        for name in ("python", "python3"):
            self.make_program(folder / "bin" / name, f'exec "{sys.executable}" "$@"', before=copied)
        reviewdog = "#!/bin/sh\\nexec cat\\n"
        self.make_program(
            folder / "bin/go",
            f'printf "{reviewdog}" > "$GOBIN/reviewdog"; chmod +x "$GOBIN/reviewdog"',
            before='mkdir -p "$GOBIN"',
        )

    def plant(self) -> None:
        (self.checkout / "robot.urdf").write_text(ROBOT)
        # Some are imported before there is an open().
        file = f"posix.open({str(self.ran)!r}, posix.O_WRONLY | posix.O_CREAT | posix.O_APPEND)"
        says = f"import posix; posix.write({file}, __name__.encode() + b'\\n')\n"
        for name in (*sys.stdlib_module_names, *OTHERS):
            if name != "venv":
                (self.checkout / f"{name}.py").write_text(says)
        for folder in ENVIRONMENTS:
            site = self.checkout / folder / f"lib/python{sysconfig.get_python_version()}/site-packages"
            site.mkdir(parents=True)
            (site / "planted.pth").write_text(f"import sys; open({str(self.ran)!r}, 'a').write('a .pth\\n')\n")
            (self.checkout / folder / "installed").write_text(str(self.checkout))
        for name in ("__init__", "__main__"):
            (self.checkout / "venv" / f"{name}.py").write_text(says)
        for name in PROGRAMS:
            self.make_program(self.checkout / name, f"echo {name} >> '{self.ran}'")
        for name in LINKS:
            (self.checkout / name).symlink_to(self.elsewhere if "." not in name else self.elsewhere / name)

    def commit(self) -> tuple[str, str]:
        """Make a repository of the checkout, whose last commit renames the robot; returns both commits."""
        self.git("init", "-q")
        self.git("add", "-A")
        self.git("commit", "-q", "-m", "planted")
        (self.checkout / "robot.urdf").write_text(ROBOT.replace("sound", "renamed"))
        self.git("commit", "-q", "-a", "-m", "renamed")
        self.git("update-ref", "refs/remotes/origin/HEAD", "HEAD^")
        return self.git("rev-parse", "HEAD^"), self.git("rev-parse", "HEAD")

    def git(self, *words: str) -> str:
        own = ["git", "-c", "user.name=a", "-c", "user.email=a@b", "-c", "commit.gpgsign=false"]
        return subprocess.run(
            [*own, *words], cwd=self.checkout, check=True, capture_output=True, text=True
        ).stdout.strip()

    @staticmethod
    def make_program(path: Path, script: str, *, before: str = "") -> None:
        path.write_text(f"#!/bin/sh\n{before}\n{script}\n")
        path.chmod(0o755)

    @staticmethod
    def make_wheel(folder: Path) -> Path:
        """A package whose installation leads to the urdfcheck under test and to what that needs."""
        wheel = folder / "urdfcheck-0.0.0-py3-none-any.whl"
        info = "urdfcheck-0.0.0.dist-info"
        lead = f"{REPOSITORY}\n{sysconfig.get_path('purelib')}\n"
        with zipfile.ZipFile(wheel, "w") as file:
            file.writestr("urdfcheck_under_test.pth", lead)
            file.writestr(f"{info}/METADATA", "Metadata-Version: 2.1\nName: urdfcheck\nVersion: 0.0.0\n")
            file.writestr(f"{info}/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
            file.writestr(f"{info}/RECORD", "")
        return wheel

    def make_action(self) -> Path:
        """A checkout of the action, which needs nothing to be built."""
        folder = self.folder / "action"
        folder.mkdir()
        (folder / "pyproject.toml").write_text(
            '[build-system]\nrequires = []\nbuild-backend = "backend"\nbackend-path = ["."]\n'
            '[project]\nname = "urdfcheck"\nversion = "0.0.0"\n'
        )
        (folder / "backend.py").write_text(
            "import shutil\n"
            "def build_wheel(folder, *_, **__):\n"
            f"    return shutil.copy({str(self.wheel)!r}, folder).rpartition('/')[2]\n"
        )
        comment = Path("integrations/github/renew_comment.py")
        (folder / comment).parent.mkdir(parents=True)
        shutil.copyfile(REPOSITORY / comment, folder / comment)
        return folder

    def run(self, steps: Sequence[Step], *, until_planted: bool = False) -> list[subprocess.CompletedProcess[str]]:
        """Run steps one after the other, as far as they succeed; ``until_planted``: and until a planted file has run."""
        output, known = self.temp / "output", {"runner.temp": str(self.temp), "github.action_path": str(self.action)}
        known |= {
            "inputs.paths": ".",
            "inputs.isolated": "auto",
            "inputs.html": "urdfcheck.html",
            "inputs.diff-html": "urdfcheck-diff.html",
            "github.event_name": "pull_request",
            "github.event.pull_request.number": "7",
            "github.event.pull_request.base.sha": self.commits[0],
            "github.event.pull_request.head.sha": self.commits[1],
        }
        known |= {
            "steps.python.outputs.python-path": str(self.folder / "bin/python"),
            "steps.check.outputs.exit-code": "0",
        }
        done = []
        for step in steps:
            output.write_text("")
            own = {name: fill_in(str(value), known) for name, value in (step.environment or {}).items()}
            if "…" in own.get("URDFCHECK", ""):
                own["URDFCHECK"] = str(self.wheel)
            environment = {
                "PATH": f"{self.folder / 'bin'}:/usr/local/bin:/usr/bin:/bin",
                "HOME": str(self.folder / "home"),
                "TMPDIR": str(self.temp),
                "PIP_NO_INDEX": "1",
                "PYTHONPATH": ":",  # as a ROS shell may have it
                "RUNNER_TEMP": str(self.temp),
                "WORKSPACE_TMP": str(self.folder / "work"),
                "CI_PROJECT_DIR": str(self.checkout),
                "CI_MERGE_REQUEST_DIFF_BASE_SHA": self.commits[0],
                "GITHUB_OUTPUT": str(output),
                "GITHUB_STEP_SUMMARY": str(self.folder / "summary"),
                "GITHUB_REPOSITORY": "own/robots",
                "URDFCHECK_CACHE_DIR": str(self.folder / "cache"),
            } | own
            environment["URDFCHECK"] = environment.get("URDFCHECK") or str(self.wheel)
            script = step.script.replace("URDFCHECK='…'", f"URDFCHECK='{self.wheel}'")
            result = subprocess.run(
                ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", script],
                cwd=self.temp if step.outside else self.checkout,
                env=environment,
                capture_output=True,
                text=True,
            )
            done.append(result)
            for line in output.read_text(encoding="utf-8").splitlines():
                key, _, value = line.partition("=")
                known |= {f"steps.{which}.outputs.{key}": value for which in ("key", "install", "check", "diff")}
            if result.returncode or (until_planted and self.ran.exists()):
                break
        return done


@dataclass(frozen=True)
class Environment:
    """The packages of an environment that Python made in a stranger's checkout, and what of the checkout ran meanwhile."""

    packages: Path
    ran: str


def make_environment(folder: Path) -> Environment:
    machine = Machine(folder / "machine")
    (done,) = machine.run([Step("python -I -m venv ../made")])
    assert done.returncode == 0, done.stderr
    (packages,) = machine.checkout.parent.glob("made/lib/*/site-packages")
    return Environment(packages, machine.ran.read_text() if machine.ran.exists() else "")


@pytest.fixture
def environment(tmp_path_factory: pytest.TempPathFactory) -> Environment:
    return make_once("environment", make_environment, tmp_path_factory)


@pytest.fixture
def machine(tmp_path: Path, environment: Environment) -> Machine:
    return Machine(tmp_path / "machine", environment.packages)


def test_an_environment_is_made_without_anything_of_the_checkout(environment: Environment) -> None:
    assert (environment.packages / "pip").is_dir()
    assert environment.ran == ""


def test_nothing_of_the_checkout_runs_and_nothing_is_written_through_it(machine: Machine, steps: list[Step]) -> None:
    done = machine.run(steps)
    said = "".join(result.stdout + result.stderr for result in done)
    assert not machine.ran.exists(), machine.ran.read_text()
    assert [result.returncode for result in done] == [0] * len(steps), said
    if any("urdfcheck diff" in step.script for step in steps):
        assert "renamed" in said  # both commits were read
    assert not list(machine.elsewhere.iterdir())


def test_the_same_without_care_would_run_it(machine: Machine, steps: list[Step]) -> None:
    """What the test above would miss if the planted files were harmless."""
    careless = [replace(step, script=step.script.replace(" -I", ""), outside=False) for step in steps]
    if not any("python" in step.script.lower() for step in careless):
        pytest.skip("no Python in it")
    done = machine.run(careless, until_planted=True)
    assert machine.ran.exists(), "".join(result.stdout + result.stderr for result in done)
