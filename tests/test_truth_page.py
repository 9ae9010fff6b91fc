"""The page about what was measured: a new round is taken as it comes, and no share stands without its number."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from truth_page import editors, peers, rounds, tables

ROUND = """# build 1234abc, 2026-12-01, default options{drawn}
robot\tplace\tcode\tmessage\tseverity\tlabel\tsure\tsays\treason
a/b\tr.urdf:1\tINR003\t-\terror\tTU\tread\t-\treason
a/b\tr.urdf:2\tINR003\t-\terror\tF\tread\t-\treason
a/b\tr.urdf:3\tINR003\t-\terror\t?\tread\t-\treason
"""


def write_rounds(folder: Path, monkeypatch: pytest.MonkeyPatch, **drawn: str) -> list[rounds.Round]:
    for name, text in drawn.items():
        (folder / f"{name}.tsv").write_text(ROUND.format(drawn=text), encoding="utf-8")
    monkeypatch.setattr(rounds, "ROUNDS", folder)
    return rounds.read_rounds()


def test_rounds_come_in_their_order_with_date_build_and_what_was_drawn(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    read = write_rounds(tmp_path, monkeypatch, judge10="; rows 1-2 drawn", judge9="; the first 1 rows drawn", sound="")
    assert [(one.number, one.build, one.day, one.drawn) for one in read] == [
        (9, "1234abc", "2026-12-01", 1),
        (10, "1234abc", "2026-12-01", 2),
    ]
    table = rounds.render_rounds(read)
    assert "it was reached in 1 of 2 rounds" in table, "what was picked does not count"
    assert "| errors that are useful | at least 97 % | 1 of 2 (50 %) | 1 of 2 rounds |" in rounds.render_bars(read)
    assert "| 10 | 2026-12-01 | 1234abc | 3 | 1 | 0 | 1 | 0 | 1 | 1 of 2 (50 %) | 1 of 2 (50 %) |" in table
    assert "| 9 | 2026-12-01 | 1234abc | 3 | 1 | 0 | 1 | 0 | 1 | 1 of 2 (50 %) | 1 of 1 (100 %) |" in table


def test_a_rule_with_few_labels_is_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    two = write_rounds(tmp_path, monkeypatch, judge1="", judge2="")
    assert "INR003" not in rounds.render_rules(two)
    three = write_rounds(tmp_path, monkeypatch, judge3="")
    assert "| 9 | 3 | 0 | 3 | 0 | 3 of 6 (50 %) | 3 |" in rounds.render_rules(three)


def test_a_round_without_its_build_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "judge1.tsv").write_text("robot\n")
    with pytest.raises(ValueError, match=r"judge1\.tsv does not say which build"):
        write_rounds(tmp_path, monkeypatch)


def test_programs_are_sorted_by_what_they_locate_and_loaders_come_last() -> None:
    program = {"version": "1", "loud": 0, "with_error": 0, "warnings": 0, "errors": 0, "asked": "so", "times": 1.0}
    names = {"urdfcheck": "checker", "weak": "checker", "strong": "checker", "loader": "loader"}
    results = {
        "files": [
            {"robot": "a", "operator": "x", "urdfcheck": "fln", "weak": "f", "strong": "fl", "loader": "fl"},
            {"robot": "a", "operator": "y", "urdfcheck": "", "weak": "", "strong": "fln", "loader": ""},
        ],
        "programs": [{**program, "name": name, "kind": kind} for name, kind in names.items()],
    }
    assert re.findall(r"^\| (\w+) 1 \|", peers.render_programs(results), re.MULTILINE) == [
        "strong",
        "urdfcheck",
        "weak",
        "loader",
    ]
    assert "| strong 1 | checker | 2 | 2 | 1 | 1.0 × |" in peers.render_programs(results)
    assert "| urdfcheck | 0 | 0 | 0 | 0 |" in peers.render_sound(results)
    assert peers.count_others(results) == 3
    assert peers.find_next_best(results) == ("strong", 2)
    assert "| x | 1 | 1 | 1 | 0 | 1 |" in peers.render_operators(results)


def test_language_servers_are_compared_by_robots_files_and_times() -> None:
    times = {"urdfcheck": {"wall": 0.5, "processor": 0.25}, "other": {"wall": 0.025, "processor": 0.0}}
    answers = {
        "servers": {"urdfcheck": "1", "other": "2"},
        "published": [
            {"robot": "a", "format": "urdf", "urdfcheck": {"INR003": 2}, "other": {}},
            {"robot": "b", "format": "xacro", "urdfcheck": {}, "other": {"x": 1, "y": 3}},
        ],
        "planted": [
            {"robot": "a", "operator": "zero_mass", "urdfcheck": "fln", "other": "f"},
            {"robot": "a", "operator": "degrees", "urdfcheck": "fl", "other": ""},
        ],
        "latency": [{"robot": "a/b:c", "links": 7, "step": "open", **times}],
    }
    error = editors.ShownError(server="other", robot="b", file="b.xacro", line=1, code="x", message="m", label="F")
    published = editors.render_published(answers, [error])
    assert (
        "| server | robots with an error, of 2 | as urdf, of 1 | as xacro, of 1 | errors | read | true | false | open |"
        in published
    )
    assert "| urdfcheck 1 | 1 | 1 | 0 | 2 | 0 | 0 | 0 | 0 |" in published
    assert "| other 2 | 1 | 0 | 1 | 4 | 1 | 0 | 1 | 0 |" in published
    planted = editors.render_planted(answers).splitlines()
    assert planted[2:] == [
        "| degrees | 1 | 1 | 0 |",
        "| zero_mass | 1 | 1 | 0 |",
        "| all, found | 2 | 2 | 1 |",
        "| all, located | 2 | 2 | 0 |",
        "| all, named | 2 | 1 | 0 |",
    ]
    row = "| c (7 links) | opened, to the error | 0.50 s | 0.025 s | 20 × | 0.25 s | below 0.01 s |"
    assert row in editors.render_latency(answers)


def test_a_table_is_copied_to_its_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tables, "REPOSITORY", tmp_path)
    mark = "<!-- in docs/how-true-is-it.md: this -->"
    (tmp_path / "README.md").write_text(f"| no |\n\n{mark}\n\n| a |\n|---|\n| 1 |\n\n| no |\n")
    assert tables.copy_table("README.md", "this") == "| a |\n|---|\n| 1 |"
    with pytest.raises(ValueError, match=r"no table after .*: that"):
        tables.copy_table("README.md", "that")


def test_every_percentage_of_the_page_has_its_number_beside_it() -> None:
    """In what is generated from labels; copied tables have a column of cases."""
    page = (tables.REPOSITORY / "docs" / "how-true-is-it.md").read_text(encoding="utf-8")
    _, _, judged = page.partition("## Findings that were judged")
    shares = re.findall(r"[^|\n]*\d %\)?", judged.partition("## Defects in published robots")[0])
    assert shares
    assert [share for share in shares if " of " not in share and not share.startswith("The bar is")] == []
