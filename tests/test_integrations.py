"""The files for CI services and for ROS 2: valid by the services' own schemas, and run here as far as a service is not needed."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from threading import Thread
from typing import Any, ClassVar
from xml.etree import ElementTree

import pytest
import yaml
from conftest import REPOSITORY
from services import accepts
from versions import ARM

from urdfcheck.cli.commands.setup import init

pytestmark = [pytest.mark.slow, pytest.mark.long]

INTEGRATIONS = REPOSITORY / "integrations"
ACTION = REPOSITORY / "action.yml"
GITLAB = INTEGRATIONS / "gitlab/urdfcheck.gitlab-ci.yml"
JENKINS = INTEGRATIONS / "jenkins/Jenkinsfile"
WORKFLOWS = sorted((INTEGRATIONS / "github").glob("*.yml"))
# What tests and releases urdfcheck itself.
OWN_WORKFLOWS = sorted((REPOSITORY / ".github/workflows").glob("*.yml"))
PINNED = re.compile(r"uses: [\w./-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+$", re.MULTILINE)
ACTIONLINT = shutil.which("actionlint")

SOUND = '<robot name="sound"><link name="base"/></robot>'
# An inertia that no body has.
BROKEN = """<robot name="broken"><link name="base"><inertial><mass value="1"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="9"/></inertial></link></robot>"""


# -- what the services say of the files --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("service", "path", "part", "broken"),
    [
        ("github-actions", ACTION, "using: composite", "using: compost"),
        *(("github-workflows", path, "runs-on:", "run-on:") for path in (*WORKFLOWS, *OWN_WORKFLOWS)),
        ("gitlab-ci", GITLAB, "when: always", "when: sometimes"),
    ],
    ids=str,
)
def test_the_files_are_valid_by_the_schema_of_the_service(service: str, path: Path, part: str, broken: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert accepts(service, text)
    assert part in text
    assert not accepts(service, text.replace(part, broken))


def workflow_steps() -> list[dict[str, Any]]:
    jobs = [job for path in WORKFLOWS for job in yaml.safe_load(path.read_text(encoding="utf-8"))["jobs"].values()]
    return [step for job in jobs for step in job["steps"]]


def action_steps() -> list[dict[str, Any]]:
    steps: list[dict[str, Any]] = yaml.safe_load(ACTION.read_text(encoding="utf-8"))["runs"]["steps"]
    return steps


def test_no_text_of_a_workflow_becomes_a_part_of_a_script() -> None:
    for step in (*action_steps(), *workflow_steps()):
        if "run" in step:
            assert step["shell"] == "bash"
            assert "${{" not in step["run"]
        else:
            assert re.search(r"@(v\d+|[0-9a-f]{40}|REVISION)$", step["uses"]), step["uses"]


@pytest.mark.parametrize("path", [ACTION, *OWN_WORKFLOWS], ids=lambda path: path.name)
def test_every_action_is_pinned_by_its_digest_and_its_version_is_named(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert len(PINNED.findall(text)) == len(re.findall(r"\buses:", text)) > 0


def test_what_users_get_has_the_pins_of_our_own_workflows() -> None:
    ours = {pin for path in (ACTION, *OWN_WORKFLOWS) for pin in PINNED.findall(path.read_text(encoding="utf-8"))}
    texts = [path.read_text(encoding="utf-8") for path in (*WORKFLOWS, REPOSITORY / "docs/diff.md")]
    for text in (*texts, init.JOB, init.INSTALLED):
        used = re.findall(r"uses: actions/.*$", text, re.MULTILINE)
        assert used
        assert {*used} <= ours


def test_zizmor_finds_nothing_in_workflows_and_action() -> None:
    zizmor = Path(sys.executable).with_name("zizmor")
    done = subprocess.run(
        [zizmor, "--offline", "--persona", "pedantic", ".github", "action.yml"],
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout


@pytest.mark.skipif(ACTIONLINT is None, reason="ACTIONLINT IS NOT INSTALLED: it does not look at the workflows")
def test_actionlint_finds_nothing_in_workflows(tmp_path: Path) -> None:
    words = [str(ACTIONLINT), "-no-color", "-shellcheck=", "-pyflakes="]
    done = subprocess.run([*words, *OWN_WORKFLOWS, *WORKFLOWS], cwd=REPOSITORY, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "")
    wrong = tmp_path / "wrong.yml"
    wrong.write_text(OWN_WORKFLOWS[0].read_text(encoding="utf-8").replace("${{ github.ref }}", "${{ github.reff }}"))
    done = subprocess.run([*words, wrong], capture_output=True, text=True)
    assert 'property "reff" is not defined' in done.stdout


def test_workflows_call_what_there_is() -> None:
    targets = set(re.findall(r"^([a-z-]+):", (REPOSITORY / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    jobs = [job for path in OWN_WORKFLOWS for job in yaml.safe_load(path.read_text(encoding="utf-8"))["jobs"].values()]
    commands = [step["run"] for job in jobs for step in job["steps"] if "run" in step]
    called = {words[1] for words in map(str.split, commands) if words[0] == "make"}
    assert called
    assert called <= targets
    named = [word for command in commands for word in command.split() if re.fullmatch(r"[\w./-]+\.py|\.ci/run", word)]
    assert named
    assert [name for name in named if not (REPOSITORY / name).is_file()] == []


def test_every_input_is_used_and_every_one_that_is_used_is_declared() -> None:
    text = ACTION.read_text(encoding="utf-8")
    action = yaml.safe_load(text)
    assert set(re.findall(r"\binputs\.([\w-]+)", text)) == set(action["inputs"])
    given = [step for step in workflow_steps() if step.get("uses", "").startswith("OWNER/")]
    assert given
    assert all(set(step["with"]) <= set(action["inputs"]) for step in given)


# -- the action, its steps run as the runner does ----------------------------------------------------------------------


@pytest.fixture
def commands(tmp_path: Path) -> Path:
    """A folder with the commands that an installation of urdfcheck has."""
    folder = tmp_path / "installed/bin"
    folder.mkdir(parents=True)
    for name, words in (("python", ""), ("urdfcheck", "-I -m urdfcheck")):
        (folder / name).write_text(f'#!/bin/sh\nexec "{sys.executable}" {words} "$@"\n')
        (folder / name).chmod(0o755)
    return folder


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository of a user, and the working directory."""
    (tmp_path / "checkout/.git").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "checkout")
    return tmp_path / "checkout"


class Runner:
    """Runs steps of the action: expressions in ``env`` are looked up, everything else is left to bash."""

    def __init__(self, folder: Path, inputs: Mapping[str, str], **github: str) -> None:
        self.temp = folder / "temp"
        self.temp.mkdir(exist_ok=True)
        self.summary = folder / "summary.md"
        declared = yaml.safe_load(ACTION.read_text(encoding="utf-8"))["inputs"]
        assert inputs.keys() <= declared.keys()
        self.known = {f"inputs.{name}": inputs.get(name, declared[name]["default"]) for name in declared}
        self.known.update({f"github.{name}": value for name, value in github.items()})

    def run(self, name: str, cwd: Path) -> subprocess.CompletedProcess[str]:
        (step,) = (step for step in action_steps() if step["name"] == name)
        output = self.temp / "output"
        output.write_text("")
        done = subprocess.run(
            ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]],
            cwd=cwd,
            capture_output=True,
            text=True,
            env={
                **os.environ,
                "RUNNER_TEMP": str(self.temp),
                "GITHUB_OUTPUT": str(output),
                "GITHUB_STEP_SUMMARY": str(self.summary),
                **{key: self.filled(value) for key, value in step["env"].items()},
            },
        )
        for line in output.read_text(encoding="utf-8").splitlines():
            key, _, value = line.partition("=")
            self.known[f"steps.{step['id']}.outputs.{key}"] = value
        return done

    def filled(self, text: str) -> str:
        # What is not there is empty, as on GitHub.
        return re.sub(r"\$\{\{ (.+?) \}\}", lambda match: self.known.get(match.group(1), ""), text)

    def output(self, name: str) -> str:
        return self.known[f"steps.check.outputs.{name}"]

    def check(self, commands: Path, cwd: Path) -> subprocess.CompletedProcess[str]:
        self.known["steps.install.outputs.bin"] = str(commands)
        return self.run("urdfcheck", cwd)


@pytest.mark.smoke
def test_the_action_reports_all_and_fails_at_the_end(tmp_path: Path, commands: Path, checkout: Path) -> None:
    names = ["a b.urdf", "it's;$(touch hacked)`touch hacked`.urdf", "-o html=hacked.urdf", "::error::x.urdf"]
    for name in names:
        (checkout / name).write_text(BROKEN)
    (checkout / "left.urdf").write_text(BROKEN)
    before = set(checkout.iterdir())
    runner = Runner(tmp_path, {"paths": "\n".join(names) + "\n", "args": """--jobs 1 --arg 'x:=a b $(touch hacked)'"""})
    done = runner.check(commands, checkout)
    assert done.returncode == 0, done.stdout + done.stderr  # so that the steps that upload run
    assert (runner.output("exit-code"), runner.output("errors")) == ("1", str(len(names)))
    assert set(checkout.iterdir()) == before
    assert all(name in done.stdout.replace("%3A", ":") for name in names[:2])
    assert "left.urdf" not in done.stdout
    assert done.stdout.count("\n::error ") + done.stdout.startswith("::error ") == len(names)
    report = json.loads(Path(runner.output("json")).read_text(encoding="utf-8"))
    assert {model["path"] for model in report["models"]} == set(names)
    assert json.loads(Path(runner.output("sarif")).read_text(encoding="utf-8"))["version"] == "2.1.0"
    assert Path(runner.output("html")).name == "urdfcheck.html"
    assert "INR003" in runner.summary.read_text(encoding="utf-8")
    assert runner.run("Result", checkout).returncode == 1


def test_code_scanning_does_not_get_what_is_known_already(tmp_path: Path, commands: Path, checkout: Path) -> None:
    known = "<!-- urdfcheck: ignore[INR003] the vendor's own numbers -->"
    (checkout / "known.urdf").write_text(BROKEN.replace("<link", f"{known}<link", 1))
    (checkout / "new.urdf").write_text(BROKEN)
    runner = Runner(tmp_path, {"html": "", "args": "--select INR003"}, event_name="push")
    runner.check(commands, checkout)
    found = {
        name: [
            result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"]
            for result in json.loads(Path(runner.output(name)).read_text(encoding="utf-8"))["runs"][0]["results"]
        ]
        for name in ("sarif", "new")
    }
    assert found == {"sarif": ["known.urdf", "new.urdf"], "new": ["new.urdf"]}


@pytest.mark.parametrize(
    ("isolated", "event", "origin", "heeded"),
    [
        ("auto", "push", "", True),
        ("auto", "pull_request", "own/robots", True),
        ("auto", "pull_request", "stranger/robots", False),
        ("auto", "pull_request_target", "", False),  # the repository that it came from was deleted
        ("auto", "schedule", "", True),
        ("auto", "workflow_dispatch", "", True),
        ("auto", "issue_comment", "", False),  # it may check out what a stranger wrote, and so may those below
        ("auto", "workflow_run", "", False),
        ("auto", "merge_group", "", False),
        ("auto", "", "", False),
        ("true", "push", "", False),
        ("false", "pull_request", "stranger/robots", True),
    ],
)
def test_the_configuration_of_a_stranger_is_not_heeded(
    tmp_path: Path, commands: Path, isolated: str, event: str, origin: str, heeded: bool
) -> None:
    other = f'if [ "$2" = - ]; then exec "{sys.executable}" "$@"; fi'
    (commands / "python").write_text(f'#!/bin/sh\n{other}\nprintf "%s\\n" "$@" > "{tmp_path}/words"\nexit 3\n')
    head = {"event.pull_request.head.repo.full_name": origin} if origin else {}
    runner = Runner(tmp_path, {"isolated": isolated, "html": ""}, event_name=event, repository="own/robots", **head)
    runner.check(commands, tmp_path)
    assert ("--isolated" not in (tmp_path / "words").read_text().splitlines()) == heeded
    assert runner.run("Result", tmp_path).returncode == 3
    assert "steps.check.outputs.html" not in runner.known


def test_what_cannot_be_run_fails_and_says_why(tmp_path: Path, commands: Path, checkout: Path) -> None:
    (checkout / "a.urdf").write_text(SOUND)
    for inputs, said in (
        ({"args": "--arg 'x"}, "::error title=urdfcheck::args: No closing quotation"),
        ({"isolated": "yes"}, "isolated is true, false or auto"),
        ({"fail-on": "; touch hacked"}, "invalid choice"),
        ({"paths": "none.urdf"}, "does not exist"),
    ):
        runner = Runner(tmp_path, inputs)
        done = runner.check(commands, checkout)
        assert said in done.stdout + done.stderr
        failed = done.returncode or runner.run("Result", checkout).returncode
        assert failed, inputs
    assert [path.name for path in checkout.iterdir() if path.name != ".git"] == ["a.urdf"]


def test_a_folder_of_pages_and_the_link_to_it(tmp_path: Path, commands: Path, checkout: Path) -> None:
    (checkout / "a.urdf").write_text(SOUND)
    (checkout / "b.urdf").write_text(SOUND)
    runner = Runner(tmp_path, {"html": "pages/"})
    runner.check(commands, checkout)
    assert len(list(Path(runner.output("html")).glob("**/*.html"))) == 3  # an index and a page for each
    runner.known["steps.artifact.outputs.artifact-url"] = "https://example.org/1"
    assert runner.run("Where the report is", checkout).returncode == 0
    assert "(https://example.org/1)" in runner.summary.read_text(encoding="utf-8")


def test_what_is_installed_once_is_not_installed_again(tmp_path: Path, commands: Path) -> None:
    """The key of the cache tells platforms and dependencies apart; an installation that is there is taken."""
    runner = Runner(tmp_path, {}, action_path=str(REPOSITORY))
    runner.known["steps.python.outputs.python-path"] = sys.executable
    assert runner.run("What is installed", tmp_path).returncode == 0
    key = runner.known["steps.key.outputs.key"]
    assert re.fullmatch(rf"urdfcheck-pip-{sys.platform}-\S+-3\.\d+-[0-9a-f]{{32}}", key)
    own = runner.temp / "urdfcheck-python"
    own.mkdir()
    (own / "installed").write_text(str(commands))
    assert runner.run("Install urdfcheck", tmp_path).returncode == 0
    assert runner.known["steps.install.outputs.bin"] == str(commands)


# -- the action, what a pull request changes ---------------------------------------------------------------------------

QUICK = "--tier source --select INR003 --no-cache"
ACCEPTED = "contains(github.event.pull_request.labels.*.name, inputs.diff-accept-label)"


@pytest.fixture
def merged(tmp_path: Path) -> tuple[Path, str]:
    """A checkout of a pull request as GitHub merges it into a base that has moved on, and the head of the pull request."""
    folder = tmp_path / "checkout"
    (folder / "robots").mkdir(parents=True)

    def git(*words: str) -> str:
        own = ["git", "-c", "user.name=a", "-c", "user.email=a@b", "-c", "commit.gpgsign=false"]
        return subprocess.run([*own, *words], cwd=folder, check=True, capture_output=True, text=True).stdout.strip()

    def commit(name: str, text: str) -> None:
        (folder / "robots" / name).write_text(text, encoding="utf-8")
        git("add", "-A")
        git("commit", "-q", "-m", name)

    git("init", "-q", "-b", "main")
    commit("arm.urdf", ARM)
    git("switch", "-q", "-c", "feature")
    commit("arm.urdf", ARM.replace('<origin xyz="0.3 0 0" rpy="0 0 0"/>', '<origin xyz="0.341 0 0" rpy="0 0 0"/>'))
    head = git("rev-parse", "HEAD")
    git("switch", "-q", "main")
    commit("other.urdf", SOUND)
    git("switch", "-q", "--detach")
    git("merge", "-q", "--no-ff", "-m", "merge", "feature")
    return folder, head


class PullRequest(Runner):
    """Runs the steps about the change of a pull request."""

    def compare(self, commands: Path, cwd: Path) -> subprocess.CompletedProcess[str]:
        self.known["steps.install.outputs.bin"] = str(commands)
        return self.run("What the change does to the robots", cwd)

    def result(self, cwd: Path) -> int:
        self.known["steps.check.outputs.exit-code"] = "0"
        return self.run("Result", cwd).returncode

    def output(self, name: str) -> str:
        return self.known.get(f"steps.diff.outputs.{name}", "")


@pytest.mark.smoke
def test_the_action_compares_a_pull_request_with_its_base(
    tmp_path: Path, commands: Path, merged: tuple[Path, str]
) -> None:
    folder, head = merged
    inputs = {"diff-fail-on": "kinematic", "diff-args": QUICK}
    runner = PullRequest(tmp_path, inputs, **{"event.pull_request.head.sha": head})
    done = runner.compare(commands, folder)
    assert done.returncode == 0, done.stdout + done.stderr  # so that the steps that upload run
    assert (runner.output("exit-code"), runner.output("verdict")) == ("1", "kinematic")
    # What the base did since is no change of the pull request.
    assert "other.urdf" not in done.stdout
    assert "::warning file=robots/arm.urdf," in done.stdout
    assert "tool0 moves by 41 mm" in runner.summary.read_text(encoding="utf-8")
    assert Path(runner.output("comment")).read_text(encoding="utf-8").startswith("<!-- urdfcheck diff -->\n")
    assert Path(runner.output("html")).name == "urdfcheck-diff.html"
    assert Path(runner.output("png")).name == "urdfcheck-diff.png"
    runner.known["steps.picture-artifact.outputs.artifact-url"] = "https://example.org/2"
    assert runner.run("Where the comparison is", folder).returncode == 0
    summary = runner.summary.read_text(encoding="utf-8")
    assert summary.endswith("\nThe picture of both versions is [an artifact of this run](https://example.org/2).\n")
    assert "in 3D" not in summary
    assert runner.result(folder) == 1
    runner.known[ACCEPTED] = "true"
    assert runner.result(folder) == 0
    # A label accepts a change, and not a version that could not be read.
    runner.known["steps.diff.outputs.exit-code"] = "2"
    assert runner.result(folder) == 2


def test_a_base_that_was_not_fetched_is_no_green_run(tmp_path: Path, commands: Path, merged: tuple[Path, str]) -> None:
    folder, head = merged
    subprocess.run(["git", "clone", "-q", "--depth", "1", folder.as_uri(), tmp_path / "shallow"], check=True)
    base = subprocess.run(["git", "rev-parse", "main"], cwd=folder, capture_output=True, text=True).stdout.strip()
    for known, code in ((base, "2"), ("", "2")):
        event = {"event.pull_request.head.sha": head if known else "", "event.pull_request.base.sha": known}
        runner = PullRequest(tmp_path, {"diff-args": QUICK}, **event)
        done = runner.compare(commands, tmp_path / "shallow")
        assert "give actions/checkout fetch-depth: 2" in done.stdout
        assert runner.output("exit-code") == code
        assert runner.result(tmp_path) == 2


def test_a_checkout_of_the_head_is_compared_with_where_it_left_the_base(
    tmp_path: Path, commands: Path, merged: tuple[Path, str]
) -> None:
    folder, head = merged
    base = subprocess.run(["git", "rev-parse", "main"], cwd=folder, capture_output=True, text=True).stdout.strip()
    subprocess.run(["git", "switch", "-q", "feature"], cwd=folder, check=True)
    event = {"event.pull_request.head.sha": head, "event.pull_request.base.sha": base}
    runner = PullRequest(tmp_path, {"diff-args": QUICK, "diff-html": ""}, **event)
    done = runner.compare(commands, folder)
    assert (runner.output("exit-code"), runner.output("verdict"), runner.output("html")) == ("0", "kinematic", "")
    assert "other.urdf" not in done.stdout
    assert runner.result(folder) == 0


def test_what_a_change_is_compared_with_is_not_heeded_either(
    tmp_path: Path, commands: Path, merged: tuple[Path, str]
) -> None:
    other = f'if [ "$2" = - ]; then exec "{sys.executable}" "$@"; fi'
    (commands / "python").write_text(f'#!/bin/sh\n{other}\nprintf "%s\\n" "$@" > "{tmp_path}/words"\nexit 3\n')
    for isolated, heeded in (("", False), ("true", False), ("false", True)):
        runner = PullRequest(tmp_path, {"paths": "-o\nrobots"}, **{"event.pull_request.head.sha": merged[1]})
        if isolated:
            runner.known["steps.check.outputs.isolated"] = isolated
        runner.compare(commands, merged[0])
        words = (tmp_path / "words").read_text().splitlines()
        assert ("--isolated" not in words) == heeded
        assert words[words.index("--") :] == ["--", "-o", "robots"]


class Comments(BaseHTTPRequestHandler):
    """The part of GitHub that keeps the comments of a pull request."""

    kept: ClassVar[list[dict[str, Any]]] = []
    asked: ClassVar[list[tuple[str, str]]] = []
    refusal: ClassVar[int] = 0

    def answer(self, code: int, body: object) -> None:
        self.asked.append((self.command, self.path))
        if self.refusal and self.command != "GET":
            code, body = self.refusal, {}
        self.send_response(code)
        self.send_header("Content-Type", "application/json")
        self.send_header("Location", "http://elsewhere.invalid/")
        self.end_headers()
        self.wfile.write(json.dumps(body).encode())

    def read_body(self) -> str:
        assert self.headers["Authorization"] == "Bearer secret"
        return str(json.loads(self.rfile.read(int(self.headers["Content-Length"])))["body"])

    def do_GET(self) -> None:
        page = int(self.path.partition("&page=")[2])
        self.answer(200, self.kept[100 * (page - 1) : 100 * page])

    def do_POST(self) -> None:
        text = self.read_body()
        if not self.refusal:
            self.kept.append({"id": len(self.kept), "user": {"type": "Bot"}, "body": text})
        self.answer(201, {})

    def do_PATCH(self) -> None:
        self.kept[int(self.path.rsplit("/", 1)[1])]["body"] = self.read_body()
        self.answer(200, {})

    def log_message(self, *_words: object) -> None:
        pass


@pytest.mark.smoke
def test_the_comment_is_written_once_and_then_renewed(
    tmp_path: Path, commands: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    comment = tmp_path / "comment.md"
    monkeypatch.setattr(Comments, "kept", [])
    monkeypatch.setattr(Comments, "asked", [])
    monkeypatch.setenv("no_proxy", "*")
    with HTTPServer(("127.0.0.1", 0), Comments) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        runner = PullRequest(
            tmp_path,
            {},
            api_url=f"http://127.0.0.1:{server.server_port}",
            repository="own/robots",
            token="secret",
            action_path=str(REPOSITORY),
            **{"event.pull_request.number": "7"},
        )
        runner.known["steps.install.outputs.bin"] = str(commands)
        runner.known["steps.diff.outputs.comment"] = str(comment)

        def renew(text: str, verdict: str = "kinematic") -> str:
            comment.write_text(f"<!-- urdfcheck diff -->\n{text}\n", encoding="utf-8")
            runner.known["steps.diff.outputs.verdict"] = verdict
            done = runner.run("Comment on the change", tmp_path)
            assert done.returncode == 0, done.stderr
            return done.stdout.strip()

        # A person quotes it, on a page that is full.
        Comments.kept += [{"id": n, "user": {"type": "User"}, "body": "<!-- urdfcheck diff -->"} for n in range(100)]
        assert renew("same", "identical") == "comment not written: the robots are the same"
        assert renew("one") == "comment written"
        runner.known["steps.diff-artifact.outputs.artifact-url"] = "https://example.org/1"
        runner.known["steps.picture-artifact.outputs.artifact-url"] = "https://example.org/2"
        assert renew("two", "identical") == "comment renewed"
        assert len(Comments.kept) == 101
        assert Comments.kept[100]["body"] == (
            "<!-- urdfcheck diff -->\ntwo\n\nBoth versions [in 3D](https://example.org/1) and "
            "[as a picture](https://example.org/2): artifacts of the run.\n"
        )
        assert "(https://example.org/1)" in Comments.kept[100]["body"]
        assert {body["body"] for body in Comments.kept[:100]} == {"<!-- urdfcheck diff -->"}
        assert {path.partition("?")[0] for _, path in Comments.asked} == {
            "/repos/own/robots/issues/7/comments",
            "/repos/own/robots/issues/comments/100",
        }
        # Neither a token that may only read nor a server that leads elsewhere fails the job.
        Comments.kept.clear()
        for refusal, why in ((403, "pull-requests: write"), (302, "the server refuses it")):
            monkeypatch.setattr(Comments, "refusal", refusal)
            said = renew("three")
            assert said.startswith(f"::notice title=urdfcheck diff::no comment ({refusal})")
            assert why in said
        server.shutdown()
    assert renew("four").startswith("::notice title=urdfcheck diff::no comment: ")


# -- GitLab and Jenkins: their shell scripts ---------------------------------------------------------------------------


def test_the_gitlab_job_writes_its_reports(tmp_path: Path, commands: Path, checkout: Path) -> None:
    (checkout / "a.urdf").write_text(BROKEN)
    (checkout / "urdfcheck.toml").write_text('fail-on = "never"')
    template = yaml.safe_load(GITLAB.read_text(encoding="utf-8"))
    job = template["urdfcheck"]
    shutil.copytree(commands.parent, tmp_path / "own/python")
    script = "set -e\n" + "\n".join(job["script"])

    def run(source: str, **variables: str) -> int:
        environment = {**os.environ, **template["variables"], "own": str(tmp_path / "own"), **variables}
        environment["CI_PIPELINE_SOURCE"] = source
        return subprocess.run(["sh", "-c", script], cwd=checkout, env=environment, capture_output=True).returncode

    merge = "merge_request_event"
    assert run(merge, CI_MERGE_REQUEST_SOURCE_PROJECT_ID="1", CI_MERGE_REQUEST_PROJECT_ID="1") == 0
    written = [*job["artifacts"]["paths"], *job["artifacts"]["reports"].values()]
    assert all((checkout / name).stat().st_size for name in written)
    quality = json.loads((checkout / job["artifacts"]["reports"]["codequality"]).read_text(encoding="utf-8"))
    assert [entry["location"]["path"] for entry in quality if entry["check_name"].startswith("INR003")] == ["a.urdf"]
    assert run(merge, CI_MERGE_REQUEST_SOURCE_PROJECT_ID="2", CI_MERGE_REQUEST_PROJECT_ID="1") == 1, (
        "a fork's configuration"
    )
    assert run("push") == 0
    assert run("external_pull_request_event") == 1


@pytest.mark.parametrize("is_merged", [True, False])
def test_the_gitlab_job_compares_a_merge_request_and_a_label_accepts_it(
    tmp_path: Path, commands: Path, merged: tuple[Path, str], *, is_merged: bool
) -> None:
    """In a pipeline of merged results, and in one of the source branch."""
    folder, head = merged
    template = yaml.safe_load(GITLAB.read_text(encoding="utf-8"))
    job = template["urdfcheck-diff"]
    # A variable of the job would hide that of the file that includes it.
    assert not {name for name in job.get("variables", {}) if name.startswith("URDFCHECK")}
    shutil.copytree(commands.parent, tmp_path / "own/python")

    def git(*words: str) -> str:
        return subprocess.run(["git", *words], cwd=folder, check=True, capture_output=True, text=True).stdout.strip()

    event = {"CI_MERGE_REQUEST_DIFF_BASE_SHA": git("merge-base", "main", head)}
    if is_merged:
        event["CI_MERGE_REQUEST_TARGET_BRANCH_SHA"] = git("rev-parse", "main")
    else:
        git("switch", "-q", "feature")

    def run(labels: str, options: str) -> tuple[int, str]:
        own = {"own": str(tmp_path / "own"), "CI_PIPELINE_SOURCE": "merge_request_event"}
        given = {"CI_MERGE_REQUEST_LABELS": labels, "URDFCHECK_DIFF_OPTIONS": f"{QUICK} {options}"}
        done = subprocess.run(
            ["sh", "-c", "set -e\n" + "\n".join(job["script"])],
            cwd=folder,
            env={**os.environ, **template["variables"], **own, **event, **given},
            capture_output=True,
            text=True,
        )
        return done.returncode, done.stdout

    code, said = run("bug", "--fail-on kinematic")
    assert code == 1
    assert said.startswith("tool0 moves by 41 mm")
    assert all((folder / name).stat().st_size for name in job["artifacts"]["paths"])
    assert run("bug,urdfcheck: accepted,docs", "--fail-on kinematic")[0] == 0
    assert run("not urdfcheck: accepted", "--fail-on kinematic")[0] == 1
    assert run("", "--fail-on limits")[0] == 0
    # A label accepts a change, and not a version that could not be read.
    assert run("urdfcheck: accepted", "--fail-on nonsense")[0] == 2


def test_the_jenkins_step_fails_for_what_could_not_be_checked_only(commands: Path, checkout: Path) -> None:
    text = JENKINS.read_text(encoding="utf-8")
    (script,) = (step for step in re.findall(r"sh '''(.*?)'''", text, re.DOTALL) if "urdfcheck check" in step)
    shutil.copytree(commands, checkout.parent / "urdfcheck/bin")
    (checkout / "urdfcheck-reports").symlink_to(checkout.parent)  # planted
    (checkout / "a.urdf").write_text(BROKEN)
    # In a string of Groovy a backslash at the end of a line joins it with the next.
    script = script.replace("\\\n", "")

    def run(options: str) -> int:
        environment = {**os.environ, "URDFCHECK_PATHS": "a.urdf", "URDFCHECK_OPTIONS": options}
        environment["WORKSPACE_TMP"] = str(checkout.parent)
        return subprocess.run(["sh", "-e", "-c", script], cwd=checkout, env=environment, capture_output=True).returncode

    assert run("--select INR003") == 0
    (failure,) = ElementTree.parse(checkout / "urdfcheck-reports/urdfcheck.xml").iter("failure")
    assert "breaks the triangle inequality" in (failure.get("message") or "") + (failure.text or "")
    assert (checkout / "urdfcheck-reports/index.html").stat().st_size
    assert run("--select NONSENSE") == 2
    for used in ("urdfcheck-reports/urdfcheck.xml", "reportDir: 'urdfcheck-reports'", "reportFiles: 'index.html'"):
        assert used in text


# -- ROS 2: a package whose test is run by CMake -----------------------------------------------------------------------


@pytest.mark.skipif(shutil.which("cmake") is None, reason="CMAKE IS NOT INSTALLED: the ROS 2 example is not tested")
def test_the_ros_package_is_tested_by_cmake(tmp_path: Path, commands: Path) -> None:
    package = tmp_path / "a robot"
    shutil.copytree(INTEGRATIONS / "ros2", package)
    build = tmp_path / "build"
    configure = ["cmake", "-S", package, "-B", build, f"-DURDFCHECK_EXECUTABLE={commands / 'urdfcheck'}"]
    done = subprocess.run([*configure, f"-DAMENT_TEST_RESULTS_DIR={tmp_path / 'results'}"], capture_output=True)
    assert done.returncode == 0, done.stderr

    def test() -> tuple[int, ElementTree.Element]:
        code = subprocess.run(["ctest"], cwd=build, capture_output=True).returncode
        # Where colcon test-result looks.
        return code, ElementTree.parse(tmp_path / "results/urdfcheck_example/urdfcheck.xunit.xml").getroot()

    code, result = test()
    assert (code, list(result.iter("failure"))) == (0, [])
    assert list(result.iter("testcase"))
    model = package / "urdf/pendulum.urdf.xacro"
    model.write_text(model.read_text(encoding="utf-8").replace('izz="${rod * radius**2 / 2}"', 'izz="1"'))
    code, result = test()
    assert code != 0
    assert [
        case.get("name", "").split()[0] for case in result.iter("testcase") if case.find("failure") is not None
    ] == ["INR003"]


@pytest.mark.skipif(shutil.which("cmake") is None, reason="CMAKE IS NOT INSTALLED: the ROS 2 example is not tested")
def test_a_ros_package_fails_its_test_where_urdfcheck_is_not_installed(tmp_path: Path) -> None:
    build = tmp_path / "build"
    configure = [
        "cmake",
        "-S",
        INTEGRATIONS / "ros2",
        "-B",
        build,
        "-DURDFCHECK_EXECUTABLE=URDFCHECK_EXECUTABLE-NOTFOUND",
    ]
    tools = tmp_path / "tools"
    tools.mkdir()
    for found in filter(None, map(shutil.which, ("cmake", "ctest", "make", "ninja"))):
        (tools / Path(found).name).symlink_to(found)
    environment = {**os.environ, "PATH": str(tools)}
    done = subprocess.run(configure, capture_output=True, text=True, env=environment)
    assert "urdfcheck was not found" in done.stderr
    assert done.returncode == 0
    assert subprocess.run(["ctest"], cwd=build, capture_output=True, env=environment).returncode != 0
