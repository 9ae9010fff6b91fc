"""Every guide is done as it says: its commands print what it shows, and end with the exit code that it names."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from conftest import REPOSITORY
from guide_runner import run_guide

GUIDES = sorted(
    path for path in (REPOSITORY / "docs").rglob("*.md") if "\n```console" in path.read_text(encoding="utf-8")
)
QUICK = "first-robot"

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("one_process")]


@pytest.mark.parametrize(
    "guide",
    [
        pytest.param(path, id=path.stem, marks=[pytest.mark.long, *[pytest.mark.smoke] * (path.stem == QUICK)])
        for path in GUIDES
    ],
)
def test_a_guide_does_what_it_says(
    guide: Path, tmp_path: Path, pytestconfig: pytest.Config, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    text = guide.read_text(encoding="utf-8")
    now = run_guide(text, tmp_path)
    if pytestconfig.getoption("--accept"):
        guide.write_text(now, encoding="utf-8")
    assert now == text, f"{guide.name}: pytest --accept writes what the commands print now"


GUIDE = """\
```text file=a/b.txt
one
two
```

```diff file=a/b.txt
 one
-two
+three
```

```console
$ cat a/b.txt
one
three
$ seq 4
1
…
4
```

```console exit=1
$ false
```
"""


def test_a_guide_is_run_as_it_is_written(tmp_path: Path) -> None:
    assert run_guide(GUIDE, tmp_path) == GUIDE
    assert run_guide(GUIDE.replace("three\n$", "four\n$"), tmp_path) == GUIDE


@pytest.mark.parametrize(
    ("shown", "wrong", "complaint"),
    [
        ("exit=1\n$ false", "exit=2\n$ false", "exit code 1, not 2"),
        ("1\n…\n4", "2\n…\n4", "does not print"),
        ("1\n…\n4", "1\n…\n3", "does not print"),
        ("1\n…\n4", "1\n…\n5\n…\n", "does not print"),
        ("-two", "-four", "has these lines 0 times"),
    ],
)
def test_what_a_guide_says_wrongly_is_noticed(tmp_path: Path, shown: str, wrong: str, complaint: str) -> None:
    with pytest.raises(AssertionError, match=complaint):
        run_guide(GUIDE.replace(shown, wrong), tmp_path)


@pytest.mark.skipif(
    shutil.which("jq") is None, reason="JQ IS NOT INSTALLED: the commands that read an audit are not tried"
)
def test_the_commands_that_read_an_audit_give_a_line_for_a_model(tmp_path: Path) -> None:
    """Also for one with two findings of the rule."""
    found = {"code": "INR003", "severity": "error", "suppressed": None}
    known = found | {"suppressed": {"kind": "baseline"}}
    model = {"links": 2, "joints": 1, "mass": 0.5}
    lines = [
        {"unit": {"id": "a.urdf"}, "model": model, "findings": [found, found, known]},
        {"unit": {"id": "b"}, "model": None, "findings": []},
    ]
    (tmp_path / "urdfcheck-audit").mkdir()
    (tmp_path / "urdfcheck-audit/audit.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    guide = (REPOSITORY / "docs/guides/thousands-of-models.md").read_text(encoding="utf-8")
    rule, table = re.findall(r"jq -r '[^']+' [^\s`]+(?: > models\.csv)?", guide)
    assert subprocess.check_output(["sh", "-c", rule], cwd=tmp_path, text=True) == "a.urdf\n"
    subprocess.run(["sh", "-c", table], cwd=tmp_path, check=True)
    assert (tmp_path / "models.csv").read_text() == '"a.urdf",2,1,0.5,2,0\n'
