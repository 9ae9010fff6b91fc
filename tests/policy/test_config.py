"""The configuration: which one holds for a file, what it may say, and the line of everything that is wrong."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path

import pytest
from conftest import REPOSITORY
from hypothesis import given
from hypothesis import strategies as st

from urdfcheck import cli
from urdfcheck.cli import FINDINGS, OK, compute_exit_code
from urdfcheck.core import Run, UrdfcheckError
from urdfcheck.policy import config_resolver
from urdfcheck.policy.baseline import DEFAULT_NAME
from urdfcheck.policy.config_resolver import CliOverrides, ConfigResolver
from urdfcheck.policy.policy import Policy
from urdfcheck.rules import load_rules
from urdfcheck.run import pipeline
from urdfcheck.run.jobs import Request
from urdfcheck.source.text.globs import match_any_pattern, split_relative_path
from urdfcheck.source.text.toml import locate_keys

pytestmark = pytest.mark.slow

BROKEN = (
    '<robot name="r"><link name="{}"><inertial><mass value="1"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="9"/></inertial></link></robot>'
)
XACRO = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{}</robot>'


def write(path: Path, text: str) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


def run(*paths: Path, given: CliOverrides | None = None, isolated: bool = False) -> Run:
    """Check paths as the command does, in this process."""
    configured = ConfigResolver(given or CliOverrides(select=frozenset({"INR003"})), isolated)
    settings = configured.for_path(paths[0])
    holds = configured.resolve(settings, settings.root)
    request = Request(
        paths=paths, root=settings.root, policy=Policy(codes=holds.policy.codes), config_resolver=configured
    )
    return pipeline.run(request, pipeline.IN_THIS_PROCESS)


def list_findings(outcome: Run) -> list[tuple[str, str, str]]:
    """Model, code and severity of each finding."""
    return [(f.model, f.code, str(f.severity)) for f in outcome.findings]


class TestNearest:
    @pytest.fixture
    def folder(self, tmp_path: Path) -> Path:
        """A workspace with a configuration, and two packages of which one has its own."""
        write(tmp_path / "urdfcheck.toml", 'fail-on = "error"\n')
        write(tmp_path / "a/urdf/a.urdf", BROKEN.format("a"))
        write(tmp_path / "b/urdf/b.urdf", BROKEN.format("b"))
        write(tmp_path / "b/urdfcheck.toml", 'fail-on = "never"\n[severity]\ntriangle-inequality = "info"\n')
        return tmp_path

    def test_each_file_has_its_own(self, folder: Path) -> None:
        assert list_findings(run(folder)) == [("a/urdf/a.urdf", "INR003", "error"), ("urdf/b.urdf", "INR003", "info")]

    def test_the_id_of_a_model_is_the_same_whatever_was_named(self, folder: Path) -> None:
        alone = run(folder / "b/urdf/b.urdf").findings
        assert [f.fingerprints for f in alone] == [f.fingerprints for f in run(folder).findings if f.severity == 1]

    def test_the_exit_code_asks_the_configuration_of_each_finding(self, folder: Path) -> None:
        from urdfcheck.cli.terminal import compute_exit_code

        write(folder / "b/urdfcheck.toml", 'fail-on = "info"\n[severity]\nINR003 = "info"\n')
        (folder / "a/urdf/a.urdf").unlink()
        outcome = run(folder)
        assert outcome.fail_on == {"urdf/b.urdf": "info"}
        assert compute_exit_code(outcome, "error") == cli.FINDINGS

    def test_the_command_line_wins(self, folder: Path) -> None:
        given = CliOverrides(select=frozenset({"INR003"}), ignore=frozenset({"INR003"}), fail_on="info")
        outcome = run(folder, given=given)
        assert not outcome.findings
        assert set(outcome.fail_on.values()) == {"info"}

    def test_isolated_asks_none(self, folder: Path) -> None:
        write(folder / "a/urdfcheck.toml", "this is no TOML")
        assert {s for _, _, s in list_findings(run(folder, isolated=True))} == {"error"}

    def test_a_wrong_one_further_down_is_a_failure_of_its_files_only(self, folder: Path) -> None:
        write(folder / "b/urdfcheck.toml", "\nselct = []\n")
        outcome = run(folder)
        assert list_findings(outcome) == [("a/urdf/a.urdf", "INR003", "error")]
        assert len(outcome.failures) == 1
        assert "urdfcheck.toml:2: unknown key 'selct'; did you mean 'select'?" in outcome.failures[0]

    @pytest.mark.slow
    def test_an_audit_asks_the_configuration_of_each_unit_as_well(
        self, folder: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.chdir(folder)
        (folder / "a/urdf/a.urdf").unlink()
        command = ["audit", ".", "-o", str(folder / "out"), "--tier", "source", "--select", "INR003"]
        write(folder / "c/urdf/c.urdf", '<robot name="r"><link name="l"/></robot>')
        assert cli.main(command) == cli.OK
        write(folder / "b/urdfcheck.toml", 'fail-on = "info"\nseverity.INR003 = "info"\n')
        assert cli.main(command) == cli.FINDINGS

    def test_two_models_of_one_name_are_two(self, folder: Path) -> None:
        for name in ("a", "b"):
            write(folder / name / "urdfcheck.toml", "")
            write(folder / name / "urdf/same.urdf", BROKEN.format("l"))
        models = [m.id for m in run(folder / "a", folder / "b").models if "same" in m.id]
        assert models == ["urdf/same.urdf", "../b/urdf/same.urdf"]

    def test_without_a_file_all_below_a_path_is_named_from_one_folder(self, tmp_path: Path) -> None:
        for name in ("a", "b"):
            (tmp_path / name / ".git").mkdir(parents=True)
            write(tmp_path / name / "r.urdf", BROKEN.format("l"))
        (tmp_path / ".git").mkdir()
        assert [m.id for m in run(tmp_path).models] == ["a/r.urdf", "b/r.urdf"]

    def test_packages_are_those_of_the_nearest_one(self, folder: Path) -> None:
        mesh = '<visual><geometry><mesh filename="package://far_meshes/m.stl"/></geometry></visual>'
        for name in ("a", "b"):
            write(folder / name / "urdf/r.urdf", f'<robot name="r"><link name="l">{mesh}</link></robot>')
        write(folder / "b/q/m.stl", "solid")
        write(folder / "b/urdfcheck.toml", '[packages]\nfar_meshes = "q"\n')
        outcome = run(folder, given=CliOverrides(select=frozenset({"PKG001"})))
        assert [m for m, _, _ in list_findings(outcome)] == ["a/urdf/r.urdf"]

    def test_one_further_down_cannot_widen_the_reach(self, folder: Path) -> None:
        """Not beyond the folder that was given, though the file lies in a repository that goes further."""
        write(folder / "secret/m.stl", "solid")
        write(folder / "b/urdfcheck.toml", '[packages]\np = "../secret"\n')
        outcome = run(folder / "a", folder / "b/urdf/b.urdf")
        assert any("packages must name folders of the repository" in failure for failure in outcome.failures)

    def test_a_pyproject_without_the_table_is_passed_over(self, folder: Path) -> None:
        (folder / "b/urdfcheck.toml").rename(folder / "b/kept")
        write(folder / "b/pyproject.toml", "[tool.other]\nx = 1\n")
        assert {m for m, _, _ in list_findings(run(folder))} == {"a/urdf/a.urdf", "b/urdf/b.urdf"}


class TestPaths:
    def resolve(self, tmp_path: Path, text: str, file: str, given: CliOverrides | None = None) -> Policy:
        write(tmp_path / "urdfcheck.toml", text)
        configured = ConfigResolver(given or CliOverrides())
        return configured.resolve(configured.for_path(tmp_path), tmp_path / file).policy

    def test_sections_add_to_the_table_and_the_later_one_wins(self, tmp_path: Path) -> None:
        text = """
            select = ["INR003", "JNT"]
            ignore = ["JNT013"]
            severity = { INR003 = "info", JNT = "warning" }
            options.INR003 = { rel_tol = 1, rounding = 0.5 }
            [[paths]]
            match = ["robots"]
            select = ["jnt013"]
            ignore = ["JNT001"]
            severity = { INR = "error" }
            options.triangle-inequality.rel_tol = 2.0
            [[paths]]
            match = ["**/*.xacro"]
            severity.INR003 = "warning"
            target = ["gazebo"]
        """
        other = self.resolve(tmp_path, text, "other.urdf")
        assert "JNT013" not in other.codes
        assert other.severities["INR003"] == "info"
        assert other.options == {"INR003": {"rel_tol": 1.0, "rounding": 0.5}}
        robot = self.resolve(tmp_path, text, "robots/r.xacro")
        assert "JNT013" in robot.codes
        assert "JNT001" not in robot.codes
        assert robot.severities["INR003"] == "warning"
        assert robot.severities["INR001"] == "error"
        assert robot.options == {"INR003": {"rel_tol": 2.0, "rounding": 0.5}}
        assert (other.targets, robot.targets) == ((), ("gazebo",))

    def test_a_code_is_closer_than_its_prefix_wherever_it_stands(self, tmp_path: Path) -> None:
        text = '[severity]\nINR003 = "error"\nINR = "info"\nALL = "warning"\n'
        held = self.resolve(tmp_path, text, "r.urdf").severities
        assert (held["INR003"], held["INR001"], held["JNT001"]) == ("error", "info", "warning")

    def test_the_command_line_replaces_the_sections_as_well(self, tmp_path: Path) -> None:
        text = 'select = ["INR"]\n[[paths]]\nmatch = ["*"]\nselect = ["JNT"]\ntarget = ["drake"]\n'
        held = self.resolve(tmp_path, text, "r.urdf", CliOverrides(select=frozenset({"XML001"}), target=("mujoco",)))
        assert (held.codes, held.targets) == ({"XML001"}, ("mujoco",))


class TestExclude:
    def test_what_a_folder_holds_and_not_what_is_named(self, tmp_path: Path) -> None:
        write(tmp_path / "urdfcheck.toml", 'exclude = ["vendor", "*_old.urdf", "/top.urdf"]\n')
        for name in ("a/vendor/x.urdf", "b/r_old.urdf", "top.urdf", "b/top.urdf"):
            write(tmp_path / name, BROKEN.format("l"))
        assert [m.id for m in run(tmp_path).models] == ["b/top.urdf"]
        assert [m.id for m in run(tmp_path / "top.urdf").models] == ["top.urdf"]

    @pytest.mark.parametrize(
        ("pattern", "path", "expected"),
        [
            ("vendor", "a/vendor/b.urdf", True),
            ("vendor/", "vendor/b.urdf", True),
            ("a/vendor", "b/a/vendor/c", False),
            ("**/vendor/*.urdf", "b/a/vendor/c.urdf", True),
            ("a/**/c", "a/c", True),
            ("a/**/c", "a/b/b/c/d", True),
            ("a/**", "a/b/c", True),
            ("a/*", "a/b/c", True),
            ("*.urdf", "a/b.urdf", True),
            ("/*.urdf", "a/b.urdf", False),
            ("a[0-9].urdf", "a7.urdf", True),
            ("", "a", False),
            ("..", "a", False),
        ],
    )
    def test_patterns(self, pattern: str, path: str, expected: bool, tmp_path: Path) -> None:
        assert match_any_pattern([pattern], split_relative_path(tmp_path / path, tmp_path)) is expected

    def test_a_pattern_that_would_take_for_ever_does_not(self, tmp_path: Path) -> None:
        deep = "/".join(["a"] * 300)
        assert not match_any_pattern(["**/a/" * 200 + "b"], split_relative_path(tmp_path / deep, tmp_path))

    def test_the_command_line_excludes_more_from_the_working_directory(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
    ) -> None:
        write(tmp_path / "src/urdfcheck.toml", 'exclude = ["vendor"]\n')
        for name in ("a.urdf", "b.urdf", "vendor/c.urdf", "old/d.urdf"):
            write(tmp_path / "src" / name, BROKEN.format("l"))
        monkeypatch.chdir(tmp_path)
        words = ["src", "--exclude", "src/b.urdf", "--exclude", "old", "--format", "json", "--select", "INR003"]
        assert cli.main(words) == FINDINGS
        assert [m["path"] for m in json.loads(capsys.readouterr().out)["models"]] == ["src/a.urdf"]
        # What is named is checked, and the configuration's patterns stay relative to its folder.
        assert cli.main(["src/b.urdf", "--exclude", "b.urdf", "--select", "INR003"]) == FINDINGS
        assert cli.main(["src", "--exclude", "*.urdf", "--allow-empty"]) == OK


class TestNamed:
    """``--config FILE``: one configuration for everything, wherever it lies."""

    def test_it_takes_the_place_of_those_above_the_files(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
    ) -> None:
        write(tmp_path / "src/a.urdf", BROKEN.format("l"))
        write(tmp_path / "src/b/b.urdf", BROKEN.format("l"))
        write(tmp_path / "src/urdfcheck.toml", 'ignore = ["INR"]\n')
        shared = write(tmp_path / "shared/robots.toml", '[[paths]]\nmatch = ["src/b/**"]\nignore = ["INR003"]\n')
        monkeypatch.chdir(tmp_path)
        for isolated in ([], ["--isolated"]):
            words = ["src", "--config", str(shared), "--select", "INR003", "--format", "json", *isolated]
            assert cli.main(words) == FINDINGS
            assert {m["id"] for m in json.loads(capsys.readouterr().out)["models"]} == {"src/a.urdf", "src/b/b.urdf"}
        assert cli.main(["src/b", "--config", str(shared), "--format", "json"]) == OK
        assert cli.main(["src/a.urdf", "--config", str(shared), "--format", "json"]) == FINDINGS

    def test_a_project_file_holds_a_table(self, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        model = write(tmp_path / "a.urdf", BROKEN.format("l"))
        project = write(tmp_path / "other/pyproject.toml", '[tool.urdfcheck]\nfail-on = "never"\n')
        assert cli.main([str(model), "--config", str(project)]) == OK
        assert cli.main(["config", str(model), "--config", str(project), "--exclude", "x"]) == OK
        shown = capsys.readouterr().out
        assert "other/pyproject.toml:2" in shown.replace(os.sep, "/")
        assert re.search(r"exclude +x +", shown)

    @pytest.mark.parametrize(
        ("name", "text", "complaint"),
        [
            ("a.toml", "no = 1\n", "a.toml:1: unknown key .no."),
            ("pyproject.toml", "[tool.other]\n", r"pyproject.toml: has no table \[tool.urdfcheck\]"),
            ("none.toml", None, "none.toml"),
        ],
    )
    def test_what_is_wrong_with_it_ends_the_run(
        self, name: str, text: str | None, complaint: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        model = write(tmp_path / "a.urdf", BROKEN.format("l"))
        if text is not None:
            write(tmp_path / name, text)
        assert cli.main([str(model), "--config", str(tmp_path / name)]) == 2
        assert re.search(complaint, capsys.readouterr().err)


class TestModels:
    ARM = XACRO.format('<xacro:arg name="side" default="left"/><link name="$(arg side)$(arg n)"/>')

    def test_each_entry_is_a_model_and_gives_what_the_file_needs(self, tmp_path: Path) -> None:
        write(tmp_path / "arm.urdf.xacro", self.ARM)
        write(tmp_path / "other.urdf", '<robot name="r"><link name="a"/></robot>')
        assert [m.status for m in run(tmp_path).models] == ["needs-arguments", "checked"]
        text = """
            [[models]]
            path = "arm.urdf.xacro"
            name = "two"
            arguments = { n = 2 }
            [[models]]
            path = "arm.urdf.xacro"
            arguments = { n = 1, side = "right" }
        """
        write(tmp_path / "urdfcheck.toml", text)
        models = run(tmp_path).models
        assert [(m.id, m.status, dict(m.args)) for m in models] == [
            ("arm.urdf.xacro n:=1 side:=right", "checked", {"n": "1", "side": "right"}),
            ("arm.urdf.xacro named:=two", "checked", {"n": "2"}),
            ("other.urdf", "checked", {}),
        ]

    def test_a_boolean_is_one_of_xacro(self, tmp_path: Path) -> None:
        write(tmp_path / "arm.urdf.xacro", self.ARM)
        write(tmp_path / "urdfcheck.toml", '[[models]]\npath = "arm.urdf.xacro"\narguments = { n = true }\n')
        assert run(tmp_path / "arm.urdf.xacro").models[0].args == {"n": "true"}


class TestUnchecked:
    """A model that cannot be checked is an error, or a warning where the configuration or the command line accepts it."""

    @pytest.fixture
    def folder(self, tmp_path: Path) -> Path:
        for name in ("arms/one.urdf.xacro", "new.urdf.xacro"):
            write(tmp_path / name, XACRO.format('<link name="$(arg n)"/>'))
        return tmp_path

    @pytest.mark.parametrize(
        ("text", "given", "accepted"),
        [
            ("", None, []),
            ('unchecked = "error"', None, []),
            ('unchecked = "warning"', None, ["arms/one.urdf.xacro", "new.urdf.xacro"]),
            ('unchecked = ["arms/**"]', None, ["arms/one.urdf.xacro"]),
            ('unchecked = ["arms"]', None, ["arms/one.urdf.xacro"]),
            ('unchecked = ["one.urdf.xacro", "none"]', None, ["arms/one.urdf.xacro"]),
            ("unchecked = []", None, []),
            ('unchecked = "warning"', "error", []),
            ('unchecked = ["arms/**"]', "warning", ["arms/one.urdf.xacro", "new.urdf.xacro"]),
        ],
    )
    def test_who_is_accepted(self, text: str, given: str | None, accepted: list[str], folder: Path) -> None:
        write(folder / "urdfcheck.toml", text)
        outcome = run(folder, given=CliOverrides(unchecked=given))
        assert [m.id for m in outcome.models if m.not_checked is not None and m.not_checked.accepted] == accepted
        assert {f.model: str(f.severity) for f in outcome.findings if f.code == "XAC010"} == {
            m.id: "warning" if m.id in accepted else "error" for m in outcome.models
        }
        assert compute_exit_code(outcome, "error") == (OK if len(accepted) == 2 else FINDINGS)

    def test_isolated_heeds_none(self, folder: Path) -> None:
        write(folder / "urdfcheck.toml", 'unchecked = "warning"')
        assert compute_exit_code(run(folder), "error") == OK
        assert compute_exit_code(run(folder, isolated=True), "error") == FINDINGS

    @pytest.mark.parametrize(
        "text",
        [
            'ignore = ["XAC"]',
            'select = ["INR003"]',
            'severity = { XAC010 = "info" }',
            '[[paths]]\nmatch = ["**"]\nignore = ["XAC010"]',
            '[[suppress]]\ncodes = ["XAC010"]\nreason = "we know"',
        ],
    )
    def test_nothing_else_hides_the_cause(self, text: str, folder: Path) -> None:
        write(folder / "urdfcheck.toml", text)
        outcome = run(folder, given=CliOverrides())
        assert [(f.code, str(f.severity)) for f in outcome.active_findings if f.blocks_check] == [
            ("XAC010", "error")
        ] * 2
        assert "XAC010" in outcome.rules
        assert compute_exit_code(outcome, "error") == FINDINGS


class TestSuppress:
    def test_findings_stay_and_do_not_count(self, tmp_path: Path) -> None:
        text = """
            [[suppress]]
            codes = ["triangle-inequality"]
            subject = "link[gripper_*]"
            path = "hands/**"
            reason = "the vendor says so"
        """
        write(tmp_path / "urdfcheck.toml", text)
        write(tmp_path / "hands/a.urdf", BROKEN.format("gripper_1"))
        write(tmp_path / "hands/b.urdf", BROKEN.format("arm"))
        write(tmp_path / "other/a.urdf", BROKEN.format("gripper_1"))
        outcome = run(tmp_path)
        known = {f.model: f.suppressed for f in outcome.findings}
        assert {m: s and (s.kind, s.reason) for m, s in known.items()} == {
            "hands/a.urdf": ("configuration", "the vendor says so"),
            "hands/b.urdf": None,
            "other/a.urdf": None,
        }


MISTAKES = [
    ('x = 1\n[severity]\nselect = "error"\n', 1, "unknown key 'x'"),
    (
        '[severity]\nselect = "error"\n[options.INR003]\nrel_tol = 1\n',
        2,
        "'select' names no rule",
    ),
    ('[options]\nINR003.rel_tol = "a"\n', 2, "rel_tol must be a number"),
    ("[options.INR003]\nrel_tol = nan\n", 2, "rel_tol must be a finite number"),
    ('options = { INR003 = { rel_tol = 1 },\n  "INR005" = 3 }\n', 2, "INR005 must be a table"),
    ('ignore = ["INR",\n\n  "JNT",\n  "INRX"]\n', 4, "'INRX' names no rule; did you mean INR"),
    ('target = [ # who\n "gazbo" ]\n', 2, "unknown target 'gazbo'; did you mean 'gazebo'?"),
    ('[[paths]]\nmatch = ["a"]\n[[paths]]\nmatch = ["b"]\nfail-on = "error"\n', 5, "unknown key 'fail-on'"),
    ('[[paths]]\nselect = ["INR"]\n', 1, "match must be a list of patterns"),
    ('[[paths]]\nmatch = ["a"]\n[paths.severity]\nINR = "bad"\n', 4, "'bad' is not a severity"),
    ('paths = [{ match = ["a"] },\n]\nmodels = 3\n', 3, "models must be tables: [[models]]"),
    ('[[models]]\npath = "r.urdf"\n[[models]]\nname = "x"\n', 3, "path is missing"),
    ('[[models]]\npath = "r.urdf"\n[models.arguments]\nok = 1\nbad = [1]\n', 5, "bad must be a text, a number"),
    ('\nunchecked = "never"\n', 2, "unchecked must be one of error, warning, or a list of patterns for models"),
    ("unchecked = true\n", 1, "unchecked must be one of error, warning"),
    ('unchecked = ["a", 1]\n', 1, "unchecked must be a list of strings"),
    ('strict-baseline = "yes"\n', 1, "strict-baseline must be true or false"),
    ('[[models]]\npath = "none.urdf"\n', 2, "path must be a file that exists; none.urdf does not"),
    ('[[models]]\npath = "./rr.urdf"\n', 2, "./rr.urdf does not; did you mean ./r.urdf?"),
    (
        '[[models]]\npath = "r.urdf"\n[[models]]\npath = "r.urdf"\n',
        3,
        "r.urdf has an entry with these arguments already",
    ),
    ('[[suppress]]\ncodes = ["INR"]\n', 1, "reason is missing"),
    ('[[suppress]]\nreason = ""\ncodes = ["INR"]\n', 2, "reason must be a text"),
    ('[[suppress]]\nreason = "x"\n', 1, "codes must be a list of codes"),
    ('baseline = "../b.json"\n', 1, "baseline must be a file of the repository"),
    ('[[models]]\npath = "../r.urdf"\n', 2, "path must be a file of the repository"),
    ('[packages]\na = "."\n"b" = 1\n', 3, "b is not a string"),
    ("tier.x = 1\n", 1, "tier must be one of source, mesh, full"),
    ("\nexclude = [" + '"a",' * 1001 + "]\n", 2, "exclude must be at most 1,000 entries"),
    (f'exclude = ["{"**/" * 400}"]\n', 1, "exclude must be texts of at most 1,000 characters"),
    ("[[paths]]\nmatch = ['a']\n" * 1001, 1, "paths must be at most 1,000 entries"),
    ("exclude = [1]\n", 1, "exclude must be a list of strings"),
]


class TestRulesOfTheRun:
    @pytest.mark.parametrize(
        ("text", "expected"),
        [
            ("", []),
            ("pedantic = true\n", ["info"]),
            ("[severity]\nXAC015 = 'error'\n", ["error"]),
            ("[severity]\nXAC015 = 'info'\n", ["info"]),
            ("[[paths]]\nmatch = ['other']\nseverity = { XAC015 = 'info' }\n", []),
            ("[[paths]]\nmatch = ['car']\nseverity = { XAC015 = 'warning' }\n", ["warning"]),
            ("[[paths]]\nmatch = ['car']\nignore = ['XAC015']\n", []),
            ("ignore = ['XAC015']\n[[paths]]\nmatch = ['other']\nselect = ['XAC015']\n", []),
            ("[[suppress]]\ncodes = ['XAC015']\npath = 'car'\nreason = 'x'\n", ["known"]),
            ("pedantic = true\n[[suppress]]\ncodes = ['XAC015']\npath = 'other'\nreason = 'x'\n", ["info"]),
        ],
    )
    def test_what_holds_for_their_model_holds_for_them(self, text: str, expected: list[str], tmp_path: Path) -> None:
        write(tmp_path / "urdfcheck.toml", text)
        write(tmp_path / "car/package.xml", "<package><name>car</name></package>")
        robot = '<robot name="{}"><link name="a"/><link name="b"/><link name="c"/></robot>'
        write(tmp_path / "car/urdf/car.urdf", robot.format("car"))
        write(tmp_path / "car/urdf/car.urdf.xacro", robot.format("truck"))
        found = [f for f in run(tmp_path, given=CliOverrides()).findings if f.code == "XAC015"]
        assert ["known" if f.suppressed else str(f.severity) for f in found] == expected


class TestMistakes:
    @pytest.mark.parametrize(("text", "line", "says"), MISTAKES, ids=range(len(MISTAKES)))
    def test_every_one_has_its_line(self, text: str, line: int, says: str, tmp_path: Path) -> None:
        (tmp_path / ".git").mkdir()
        write(tmp_path / "r.urdf", BROKEN.format("a"))
        write(tmp_path / "urdfcheck.toml", text)
        with pytest.raises(UrdfcheckError) as error:
            config_resolver.find_config(tmp_path)
        assert says in str(error.value)
        assert f"urdfcheck.toml:{line}: " in str(error.value)

    def test_the_line_in_a_pyproject_is_the_one_of_our_table(self, tmp_path: Path) -> None:
        text = '[tool.ruff]\nselct = []\n[project]\nname = "x"\n[tool.urdfcheck]\nselct = []\n'
        write(tmp_path / "pyproject.toml", text)
        with pytest.raises(UrdfcheckError, match=r"pyproject\.toml:6: unknown key"):
            config_resolver.find_config(tmp_path)

    def test_a_byte_order_mark_is_none(self, tmp_path: Path) -> None:
        write(tmp_path / "urdfcheck.toml", '\ufefffail-on = "info"\n')
        assert config_resolver.find_config(tmp_path).fail_on == "info"


class TestPlaces:
    def test_of_every_kind_of_key(self) -> None:
        text = (REPOSITORY / "pyproject.toml").read_text(encoding="utf-8")
        lines = text.splitlines()
        at = locate_keys(text)
        assert lines[at["tool", "ruff", "lint", "pycodestyle", "max-line-length"] - 1].startswith("max-line-length")
        assert lines[at["tool", "mypy", "overrides", 0, "module"] - 1].startswith("module")

    @pytest.mark.slow
    @given(
        st.recursive(
            st.one_of(st.integers(), st.booleans(), st.text(max_size=8)),
            lambda inner: st.one_of(
                st.lists(inner, max_size=3),
                st.dictionaries(st.text("ab\"'\\. #[]{}=,\n", max_size=4), inner, max_size=3),
            ),
            max_leaves=12,
        )
    )
    def test_a_key_stands_where_it_is_written(self, value: object) -> None:
        """Written as JSON each on a line of its own, which TOML's inline values read as well but for colons."""

        def toml(value: object) -> str:
            if isinstance(value, dict):
                return "{" + ", ".join(f"{json.dumps(k)} = {toml(v)}" for k, v in value.items()) + "}"
            if isinstance(value, list):
                return "[\n" + "".join(f"{toml(v)} , # ]\n" for v in value) + "]"
            return json.dumps(value).replace("\x7f", "\\u007f")

        text = f"before = 1\nvalue = {toml(value)}\nafter = '''x'''\n[last]\nz = 0\n"
        import tomli

        try:
            tomli.loads(text)
        except tomli.TOMLDecodeError:
            return  # an integer of too many digits, half a pair of surrogates
        at = locate_keys(text)
        assert at["value",] == 2
        assert at["last", "z"] == text.count("\n")
        assert at["after",] == text.count("\n") - 2


def test_the_example_of_the_documentation_is_right(tmp_path: Path) -> None:
    page = (REPOSITORY / "docs" / "configure.md").read_text(encoding="utf-8")
    (text,) = (block.partition("```")[0] for block in page.split("```toml\n")[1:])
    for folder in ("vendor", "assets/meshes_package", "urdf"):
        (tmp_path / folder).mkdir(parents=True)
    write(tmp_path / "urdf/arm.urdf.xacro", XACRO)
    write(tmp_path / "urdfcheck.toml", text)
    read = config_resolver.find_config(tmp_path)
    assert (len(read.sections), len(read.models), len(read.suppress)) == (2, 1, 1)


def test_every_code_a_page_declares_can_be_configured(tmp_path: Path) -> None:
    """Every option of every rule, by its default."""
    lines = []
    for rule in load_rules().values():
        lines += [f"[options.{rule.name}]", *(f"{o.name} = {json.dumps(o.default)}" for o in rule.options.values())]
    write(tmp_path / "urdfcheck.toml", "\n".join(lines))
    read = config_resolver.find_config(tmp_path).sections[0].options
    assert read == {c: {o.name: o.default for o in r.options.values()} for c, r in load_rules().items() if r.options}


class TestCommand:
    TEXT = """
ignore = ["cad-noise"]
tier = "mesh"
[severity]
INR = "info"
[options]
INR003 = { rel_tol = 0.5 }
[[paths]]
match = ["hands"]
ignore = ["SYM"]
target = ["gazebo"]
severity.INR003 = "warning"
[[models]]
path = "hands/a.urdf"
name = "left"
arguments.side = "left"
[[suppress]]
codes = ["MSH"]
reason = "scanned"
"""

    @pytest.fixture
    def folder(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
        write(tmp_path / "hands/a.urdf", BROKEN.format("a"))
        write(tmp_path / "pyproject.toml", "[tool.urdfcheck]" + self.TEXT.replace("[severity]", "[tool.urdfcheck.severity]")
              .replace("[options]", "[tool.urdfcheck.options]").replace("[[", "[[tool.urdfcheck."))  # fmt: skip
        monkeypatch.chdir(tmp_path)
        return tmp_path

    def answer(self, capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, object]:
        assert cli.main(["config", *words, "--format", "json"]) == cli.OK
        answer: dict[str, object] = json.loads(capsys.readouterr().out)
        return answer

    def test_every_value_has_its_place(self, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
        answer = self.answer(capsys, "hands/a.urdf", "--fail-on", "info")
        lines = (folder / "pyproject.toml").read_text(encoding="utf-8").splitlines()

        def typed(source: str) -> str:
            name, _, line = source.partition(":")
            return lines[int(line) - 1] if name == "pyproject.toml" else source

        said = {(s["name"], s["value"]): typed(s["source"]) for s in answer["settings"]}  # type: ignore[attr-defined]
        assert said["fail-on", "info"] == "command line"
        assert said["tier", "mesh"] == 'tier = "mesh"'
        assert said["select", "ALL"] == "default"
        assert said["ignore", "cad-noise"] == 'ignore = ["cad-noise"]'
        assert said["ignore", "SYM"] == 'ignore = ["SYM"]'
        assert said["target", "gazebo"] == 'target = ["gazebo"]'
        rules = {(r["code"], r["option"]): (r["value"], typed(r["source"])) for r in answer["rules"]}  # type: ignore[attr-defined]
        assert rules["INR003", None] == ("warning", 'severity.INR003 = "warning"')
        assert rules["INR001", None] == ("info", 'INR = "info"')
        assert rules["INR003", "rel_tol"] == (0.5, "INR003 = { rel_tol = 0.5 }")
        assert not any(code.startswith("SYM") for code in answer["selected"])  # type: ignore[attr-defined]
        assert [typed(m["source"]) for m in answer["models"]] == ["[[tool.urdfcheck.models]]"]  # type: ignore[attr-defined]

    def test_text_says_the_same(self, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
        assert cli.main(["config", "hands/a.urdf"]) == cli.OK
        said = capsys.readouterr().out
        for words in (
            "configured by pyproject.toml",
            "triangle-inequality: error → warning",
            "side:=left",
            "*: scanned",
        ):
            assert words in said

    def test_what_holds_for_models_that_cannot_be_checked(
        self, folder: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        text = '[tool.urdfcheck]\nunchecked = ["legacy/**"]\nstrict-baseline = true\n'
        (folder / "pyproject.toml").write_text(text)
        said = {s["name"]: (s["value"], s["source"]) for s in self.answer(capsys, "hands")["settings"]}  # type: ignore[attr-defined]
        assert said["unchecked"] == ("warning for legacy/**", "pyproject.toml:2")
        assert said["strict-baseline"] == ("true", "pyproject.toml:3")
        said = {s["name"]: (s["value"], s["source"]) for s in self.answer(capsys, "--unchecked", "warning")["settings"]}  # type: ignore[attr-defined]
        assert said["unchecked"] == ("warning", "command line")

    def test_a_folder_without_a_file_and_an_isolated_one(
        self, folder: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        answer = self.answer(capsys, ".", "--isolated")
        assert (answer["file"], answer["rules"]) == (None, [])
        assert {s["source"] for s in answer["settings"]} == {"default"}  # type: ignore[attr-defined]

    def test_a_path_that_does_not_exist_is_2(self, folder: Path) -> None:
        assert cli.main(["config", "none.urdf"]) == cli.FAILED


@pytest.mark.usefixtures("one_process")
def test_a_wrong_configuration_below_is_a_finding_and_a_failure_and_the_others_are_checked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "r.urdf").write_text('<robot name="r"><link name="l"/></robot>')
    (tmp_path / "a/urdfcheck.toml").write_text('fail-on = "error"\nslect = ["ALL"]\n')
    monkeypatch.chdir(tmp_path)
    assert cli.main([".", "--select", "URC901"]) == cli.FAILED
    shown = capsys.readouterr().out
    assert "a/urdfcheck.toml:2:1" in shown
    assert "did you mean 'select'?" in shown
    assert '2 │ slect = ["ALL"]' in shown
    assert "· 1 model ·" in shown


def test_of_nested_paths_the_first_one_names_the_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    inner = tmp_path / "robots" / "arms"
    inner.mkdir(parents=True)
    for folder in (tmp_path, inner.parent, inner):
        (folder / DEFAULT_NAME).write_text("{}", encoding="utf-8")
    paths = (inner.parent / "other.urdf", inner, inner.parent)
    assert ConfigResolver(paths=paths).for_path(inner / "a.urdf").root == inner
    assert ConfigResolver(paths=paths[::-1]).for_path(inner / "a.urdf").root == inner.parent
    assert ConfigResolver(paths=paths).for_path(tmp_path / "b.urdf").root == tmp_path
    # A shell's * gives hundreds of paths: they are not gone through again for each file.
    many = ConfigResolver(paths=tuple(inner / f"{number}.urdf" for number in range(100)))
    asked: list[object] = []
    make_absolute = os.path.abspath
    monkeypatch.setattr(os.path, "abspath", lambda path: asked.append(path) or make_absolute(path))
    assert many.for_path(inner / "7.urdf").root == inner
    assert asked == [inner / "7.urdf"]
