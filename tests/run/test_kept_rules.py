"""A copy of the rules is read in place of their pages, and only where the pages would give the same."""

from __future__ import annotations

from pathlib import Path

import pytest

from urdfcheck import rules


@pytest.fixture(autouse=True)
def forget_rules(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every turn begins as a process does."""
    monkeypatch.setattr(rules, "load_rules", rules.cache(rules.load_rules.__wrapped__))


def start_process(monkeypatch: pytest.MonkeyPatch, folder: Path) -> tuple[dict[str, rules.Rule], int]:
    """The rules as a new process gets them, and how many pages it parses."""
    parsed: list[Path] = []
    rules.load_rules.cache_clear()
    with monkeypatch.context() as patch:
        load_page = rules.load_page
        patch.setattr(rules, "load_page", lambda page: parsed.append(page) or load_page(page))  # type: ignore[func-returns-value]
        return dict(rules.recall_rules(folder)), len(parsed)


def test_the_second_process_parses_no_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first, parsed = start_process(monkeypatch, tmp_path)
    assert parsed == len(first) > 100
    again, parsed = start_process(monkeypatch, tmp_path)
    assert parsed == 0
    assert again == first
    assert list(again) == list(first)
    assert {code: dict(rule.options) for code, rule in again.items()} == {c: dict(r.options) for c, r in first.items()}


@pytest.mark.parametrize("damage", ["cut", "flipped", "empty"])
def test_a_damaged_copy_is_made_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, damage: str) -> None:
    first, _ = start_process(monkeypatch, tmp_path)
    (kept,) = (tmp_path / "rules").iterdir()
    data = kept.read_bytes()
    flipped = data[:5000] + bytes([data[5000] ^ 1]) + data[5001:]
    kept.write_bytes({"cut": data[:-5], "flipped": flipped, "empty": b""}[damage])
    again, parsed = start_process(monkeypatch, tmp_path)
    assert (again, parsed) == (first, len(first))
    assert kept.read_bytes() == data


def test_a_changed_page_makes_another_copy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first, _ = start_process(monkeypatch, tmp_path)
    monkeypatch.setattr(rules, "compute_installation_stamp", lambda: "0" * 64)
    again, parsed = start_process(monkeypatch, tmp_path)
    assert parsed == len(first)
    assert again == first
    assert len(list((tmp_path / "rules").iterdir())) == 2


def test_a_folder_that_cannot_be_written_is_no_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "rules").write_bytes(b"")
    assert start_process(monkeypatch, tmp_path)[1] > 100
