"""The JSON report keeps to the schema that the package ships."""

from __future__ import annotations

import json
import re
from importlib.resources import files
from pathlib import Path

import jsonschema
import pytest
from conftest import FIXTURES, check, check_text

from urdfcheck.output.json import render

pytestmark = pytest.mark.slow

SCHEMA = json.loads((files("urdfcheck.output") / "report.schema.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def report() -> dict[str, object]:
    found: dict[str, object] = json.loads(render(check(FIXTURES / "car-3")))
    return found


def test_the_schema_is_a_schema() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


def test_car_3_keeps_to_it(report: dict[str, object]) -> None:
    jsonschema.validate(report, SCHEMA)


def test_the_validation_can_fail(report: dict[str, object]) -> None:
    broken = json.loads(json.dumps(report))
    broken["findings"][0]["severity"] = "fatal"
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(broken, SCHEMA)


def test_nan_and_strange_values_become_json(tmp_path: Path) -> None:
    outcome = check_text(
        tmp_path, '<robot name="r"><link name="a"><inertial><mass value="nan"/></inertial></link></robot>'
    )
    jsonschema.validate(json.loads(render(outcome)), SCHEMA)


def test_equal_runs_give_equal_bytes_apart_from_seconds() -> None:
    first, second = (render(check(FIXTURES / "car-3")) for _ in range(2))
    without = [re.sub(r'"seconds": [0-9.]+', '"seconds": 0', text) for text in (first, second)]
    assert without[0] == without[1]
