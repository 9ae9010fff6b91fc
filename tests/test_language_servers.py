"""How two language servers are compared: what is drawn and kept, when a server is at rest, and what of a diagnostic counts."""

from __future__ import annotations

import asyncio
import json
import sys
from pathlib import Path

import pytest
from conftest import REPOSITORY

pytest.importorskip("pygls")
sys.path.append(str(REPOSITORY / "benchmarks" / "rivals"))
sys.path.append(str(REPOSITORY / "benchmarks" / "language_servers"))

from judging import Change, judge
from latency import LIMITS, add_joint
from lsprotocol import types
from planted_defects import list_said_by_diagnostics
from servers import Server
from session import start_session
from shown_errors import JUDGED, LABELS, READ, ShownError, draw_errors, read_judged, write_judged

ANSWERS = json.loads((REPOSITORY / "benchmarks" / "language_servers" / "answers.json").read_text(encoding="utf-8"))
# A server without a command that waits: it sends what it found, and a while later logs that it ends.
SCRIPTED = """
import json, sys, time
def send(**message):
    body = json.dumps({"jsonrpc": "2.0", **message}).encode()
    sys.stdout.buffer.write(b"Content-Length: %d\\r\\n\\r\\n%s" % (len(body), body))
    sys.stdout.buffer.flush()
def publish(uri, message):
    start = {"line": 2, "character": 1}
    found = [{"range": {"start": start, "end": start}, "severity": 1, "message": message}]
    send(method="textDocument/publishDiagnostics", params={"uri": uri, "diagnostics": found})
while True:
    head = dict(line.split(b": ") for line in iter(sys.stdin.buffer.readline, b"\\r\\n"))
    length = int(head[b"Content-Length"])
    asked = json.loads(sys.stdin.buffer.read(length))
    if "id" in asked:
        send(id=asked["id"], result={"capabilities": {}} if asked["method"] == "initialize" else None)
    if asked["method"] == "exit":
        break
    if asked["method"] == "textDocument/didOpen":
        uri = asked["params"]["textDocument"]["uri"]
        publish(uri, "first")
        time.sleep(0.2)
        publish(uri, "last")
        send(method="window/logMessage", params={"type": 3, "message": f"{uri}: done"})
"""


def make_error(robot: str, line: int, **words: str) -> ShownError:
    return ShownError(
        **{"server": "s", "robot": robot, "file": "r.urdf", "line": line, "code": "c", "message": "m", **words}
    )


def test_a_draw_takes_an_error_of_each_robot_before_a_second_one() -> None:
    errors = [make_error("loud", line) for line in range(100)] + [make_error(robot, 1) for robot in "abc"]
    drawn = draw_errors(errors, 6)
    assert {error.robot for error in drawn[:4]} == {"loud", "a", "b", "c"}
    assert [error.robot for error in drawn[4:]] == ["loud", "loud"]
    assert len({error.key for error in draw_errors(errors)}) == READ
    assert draw_errors(errors[::-1], 6) == drawn


def test_labels_outlive_another_draw(tmp_path: Path) -> None:
    path = tmp_path / "judged.tsv"
    old, new = make_error("a", 1, label="F", reason='it is "there"'), make_error("b", 2)
    assert write_judged([old], path) == 0
    assert write_judged([new, make_error("a", 1)], path) == 1
    assert read_judged(path) == [new, old]


def test_every_drawn_error_was_read() -> None:
    judged = read_judged(JUDGED)
    assert [error for error in judged if error.label not in LABELS or len(error.reason) < 10] == []
    for server in ANSWERS["servers"]:
        shown = sum(sum(row[server].values()) for row in ANSWERS["published"])
        assert sum(error.server == server for error in judged) == min(READ, shown)


def test_a_server_without_a_command_that_waits_is_at_rest_when_it_says_so(tmp_path: Path) -> None:
    model = tmp_path / "r.urdf"
    server = Server(name="scripted", command=(sys.executable, "-c", SCRIPTED), options={})

    async def ask() -> tuple[list[str], list[str]]:
        async with start_session(server, tmp_path) as session:
            session.open(model, "<robot/>")
            await session.wait_until(lambda: model.as_uri() in session.diagnostics)
            first = [found.message for found in session.diagnostics[model.as_uri()]]
            await session.rest(model)
            return first, [found.message for found in session.diagnostics[model.as_uri()]]

    assert asyncio.run(asyncio.wait_for(ask(), 60)) == (["first"], ["last"])


def test_of_a_planted_file_errors_and_warnings_count_where_they_stand() -> None:
    change = Change(parts=("arm",), lines=((4, 9),), names=frozenset({"arm", "base"}))

    def show(line: int, severity: types.DiagnosticSeverity, message: str = "too heavy") -> list[types.Diagnostic]:
        place = types.Range(types.Position(line - 1, 2 if line > 1 else 0), types.Position(line - 1, 9))
        return [types.Diagnostic(place, message, severity, "code")]

    def find(line: int, severity: types.DiagnosticSeverity, message: str = "too heavy") -> tuple[str, ...]:
        return judge([], list_said_by_diagnostics(show(line, severity, message), "/a/r.urdf"), change, "zero_mass")

    assert find(5, types.DiagnosticSeverity.Warning) == ("found", "located")
    assert find(5, types.DiagnosticSeverity.Information) == ()
    assert find(12, types.DiagnosticSeverity.Error) == ()
    assert find(12, types.DiagnosticSeverity.Error, "the mass of link arm is 0") == ("found", "located", "named")
    # The very beginning stands for the whole file.
    assert find(1, types.DiagnosticSeverity.Error) == ("found",)


def test_the_joint_of_the_times_has_its_limits_the_wrong_way_round() -> None:
    text = add_joint('<robot name="r"><link name="base"/></robot>\n', "base", 1)
    assert text.count("</robot>") == 1
    assert 'lower="1" upper="0"' in text
    assert LIMITS.search("late_joint: lower 1 is above upper 0 rad")
    assert LIMITS.search('joint "late_joint" has lower (1) above upper (0)')
