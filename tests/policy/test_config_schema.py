"""The JSON Schema of ``urdfcheck.toml`` accepts what the reader accepts, and refuses what it refuses."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import tomli
from check_jsonschema import main as check_jsonschema
from click.testing import CliRunner
from conftest import REPOSITORY, command
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from urdfcheck.cli.config_schema import render_config_schema
from urdfcheck.core import UrdfcheckError
from urdfcheck.policy.config import TARGETS
from urdfcheck.policy.config_file import read_folder_config
from urdfcheck.policy.config_keys import CONFIG_KEYS
from urdfcheck.rules import load_rules

SCHEMA = render_config_schema()
VALIDATOR = jsonschema.Draft7Validator(SCHEMA)
EXAMPLES = [
    pytest.param(block, id=f"{path.stem}-{number}")
    for path in sorted(
        {*(REPOSITORY / "docs").rglob("*.md")} - {REPOSITORY / "docs/editors.md"}
    )  # those are the editors' own
    for number, block in enumerate(
        re.findall(r"^```toml(?: file=\S+)?\n(.*?)^```$", path.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    )
    if "[[rule]]" not in block  # taplo's own configuration
]


def write_toml(value: Any) -> str:
    """A value as TOML writes it, tables inline; that of the whole file as lines."""
    if isinstance(value, dict):
        return f"{{{', '.join(f'{json.dumps(key)} = {write_toml(inner)}' for key, inner in value.items())}}}"
    if isinstance(value, list):
        return f"[{', '.join(map(write_toml, value))}]"
    return json.dumps(value, ensure_ascii=False)


def is_read(table: dict[str, Any], folder: Path) -> bool:
    """Whether urdfcheck reads a configuration."""
    text = "".join(f"{json.dumps(key)} = {write_toml(value)}\n" for key, value in table.items())
    (folder / "urdfcheck.toml").write_text(text, encoding="utf-8")
    try:
        read_folder_config(folder)
    except UrdfcheckError:
        return False
    return True


def test_it_is_a_schema_with_all_keys_and_options() -> None:
    jsonschema.Draft7Validator.check_schema(SCHEMA)
    assert "$id" not in SCHEMA  # taplo refuses a schema whose name is not an absolute address
    assert [*SCHEMA["properties"]] == [key.name for key in CONFIG_KEYS]
    assert {"ALL", "INR", "INR003", "triangle-inequality", "inertia"} <= {
        *SCHEMA["definitions"]["word"]["anyOf"][0]["enum"]
    }
    assert SCHEMA["definitions"]["INR003"]["properties"]["rel_tol"]["default"] == 1e-9
    assert "kg" in SCHEMA["definitions"]["INR015"]["properties"]["total_mass"]["description"]
    assert {*load_rules()} <= {*SCHEMA["definitions"]}


@pytest.mark.parametrize("example", EXAMPLES)
def test_examples_of_the_documents_are_valid(example: str) -> None:
    assert [error.message for error in VALIDATOR.iter_errors(tomli.loads(example))] == []


@pytest.mark.parametrize(
    ("wrong", "place"),
    [
        ({"fail_on": "error"}, ""),
        ({"fail-on": "fatal"}, "fail-on"),
        ({"ignore": ["INR999"]}, "ignore/0"),
        ({"ignore": "INR003"}, "ignore"),
        ({"ignore": [""]}, "ignore/0"),
        ({"target": ["gazebos"]}, "target/0"),
        ({"severity": {"INR003": "fatal"}}, "severity/INR003"),
        ({"severity": {"INR9": "error"}}, "severity"),
        ({"options": {"INR003": {"rel_tolerance": 1}}}, "options/INR003"),
        ({"options": {"INR003": {"rel_tol": "1e-6"}}}, "options/INR003/rel_tol"),
        ({"paths": [{"ignore": ["NAM"]}]}, "paths/0"),
        ({"paths": [{"match": [], "ignore": ["NAM"]}]}, "paths/0/match"),
        ({"models": [{"name": "left"}]}, "models/0"),
        ({"models": [{"path": "r.urdf", "arguments": {"side": ["left"]}}]}, "models/0/arguments/side"),
        ({"suppress": [{"codes": ["INR010"]}]}, "suppress/0"),
        ({"suppress": [{"codes": ["INR010"], "reason": " "}]}, "suppress/0/reason"),
        ({"pedantic": 1}, "pedantic"),
        ({"exclude": ["x" * 1001]}, "exclude/0"),
    ],
)
def test_what_is_wrong_is_found_where_it_is(wrong: dict[str, Any], place: str, tmp_path: Path) -> None:
    (tmp_path / "r.urdf").touch()
    (error,) = VALIDATOR.iter_errors(wrong)
    assert "/".join(map(str, error.absolute_path)) == place
    assert not is_read(wrong, tmp_path)


WORDS = st.sampled_from(
    ["ALL", "INR", "inr003", "INR00", "I", "triangle-inequality", "Inertia", "INR099", "gazebo", "", "gazbo"]
)
VALUES = st.one_of(
    st.booleans(),
    st.integers(-3, 3),
    st.sampled_from(["", " ", "error", "WARNING", "never", "full", "warning", "*", "r.urdf", "a.json", "."]),
    st.lists(st.sampled_from(["", ".", "error", "INR", *TARGETS[:2]]), max_size=2),
    st.lists(st.integers(0, 1), min_size=1, max_size=1),
)
SECTION = st.fixed_dictionaries(
    {},
    optional={
        "select": st.one_of(VALUES, st.lists(WORDS, max_size=2)),
        "ignore": st.lists(WORDS, max_size=2),
        "severity": st.dictionaries(WORDS, VALUES, max_size=2),
        "options": st.dictionaries(
            st.sampled_from(["INR003", "triangle-inequality", "XML001", "INR999"]),
            st.dictionaries(st.sampled_from(["rel_tol", "abs"]), VALUES, max_size=1),
            max_size=1,
        ),
        "target": VALUES,
        "pedantic": VALUES,
        "kinematics-only": VALUES,
    },
)
MODELS = st.fixed_dictionaries(
    {}, optional={"path": st.just("r.urdf"), "name": VALUES, "arguments": st.dictionaries(st.just("a"), VALUES)}
)
SUPPRESSED = st.fixed_dictionaries(
    {},
    optional={"codes": st.lists(WORDS, max_size=1), "subject": VALUES, "path": VALUES, "reason": VALUES, "no": VALUES},
)
TABLES = st.one_of(
    SECTION,
    st.dictionaries(st.sampled_from(["fail-on", "tier", "unchecked", "exclude", "strict-baseline", "no"]), VALUES),
    st.fixed_dictionaries({"paths": st.lists(st.builds(lambda a, b: {**a, "match": b}, SECTION, VALUES), max_size=1)}),
    st.fixed_dictionaries({"models": st.lists(MODELS, max_size=1)}),
    st.fixed_dictionaries({"suppress": st.one_of(VALUES, st.lists(SUPPRESSED, max_size=1))}),
    st.fixed_dictionaries({"packages": st.one_of(VALUES, st.dictionaries(st.just("p"), st.just(".")))}),
)


@given(table=TABLES)
@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_the_schema_and_the_reader_agree(table: dict[str, Any], tmp_path: Path) -> None:
    (tmp_path / "r.urdf").touch()
    has_no_option = any(
        "rel_tol" not in named
        for section in (table, *[p for p in table.get("paths", ()) if isinstance(p, dict)])
        for word, named in section.get("options", {}).items()
        if word == "XML001"
    )
    assert VALIDATOR.is_valid(table) == is_read(table, tmp_path) or has_no_option


def test_the_command_prints_what_other_programs_check_with(tmp_path: Path) -> None:
    done = command("config", "--schema", cwd=tmp_path)
    assert done.returncode == 0
    schema = tmp_path / "urdfcheck.schema.json"
    schema.write_text(done.stdout, encoding="utf-8")
    right, wrong = tmp_path / "right.toml", tmp_path / "wrong.toml"
    right.write_text('fail-on = "warning"\n\n[options.INR003]\nrel_tol = 1e-6\n', encoding="utf-8")
    wrong.write_text('fail-on = "fatal"\n', encoding="utf-8")
    for file, code in ((right, 0), (wrong, 1)):
        done_check = CliRunner().invoke(check_jsonschema, ["--schemafile", str(schema), str(file)])
        assert done_check.exit_code == code, done_check.output
