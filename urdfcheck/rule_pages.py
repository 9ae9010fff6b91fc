"""The pages of ``rules/`` as a reader gets them. :mod:`urdfcheck.rules` makes objects of them, which takes longer to load."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path

from urdfcheck.system.installation import find_pages_folder as find_pages_folder

TITLE = re.compile(r"# ([A-Z]{3}\d{3}) ([a-z0-9]+(?:-[a-z0-9]+)*)\n")
_CODE = re.compile(r"[A-Z]{3}\d{3}")
# The sections of which a short page has the beginning.
_ABRIDGED = ("What it checks", "Why it matters", "How to fix", "Bad", "When to ignore")
_EXAMPLE = re.compile(r"^```.*?^```$", re.DOTALL | re.MULTILINE)
# An example, a list or a paragraph.
_BLOCK = re.compile(rf"\n*({_EXAMPLE.pattern}|[^\n].*?(?=\n\n|\Z))", re.DOTALL | re.MULTILINE)


@cache
def find_page(code: str) -> Path | None:
    """Return the page of a rule; None for what is not a code of one."""
    if not _CODE.fullmatch(code.upper()):
        return None
    return next(find_pages_folder().glob(f"{code.upper()}-*.md"), None)


def list_pages() -> list[Path]:
    """Return the pages of all rules, in the order of their codes."""
    return sorted(find_pages_folder().glob("[A-Z][A-Z][A-Z][0-9][0-9][0-9]-*.md"))


def summarize_page(page: str) -> str:
    """Return the line of a page in a list: code, severity, confidence and name."""
    import tomli

    code, name = page.partition("\n")[0].removeprefix("# ").split()
    meta = tomli.loads(split_page(page)[0].partition("\n[")[0])  # the tables take most of the time
    return f"{code}  {meta['severity']:7}  {meta['confidence']:9}  {name}"


def split_page(page: str) -> tuple[str, str]:
    """Return the header of a page, which is empty where it has none, and the rest of the page without it."""
    before, _, rest = page.partition("\n```toml\n")
    header, end, body = rest.partition("\n```\n")
    return (header, before + body) if end else ("", page)


def explain_page(page: str) -> str:
    """Return a page for a reader: its header in words instead of TOML, then its sections unchanged."""
    import tomli

    header, rest = split_page(page)
    meta = tomli.loads(header)
    messages = meta["messages"]
    facts = [
        f"{meta['severity']}, {meta['confidence']}",
        f"since {meta['since']} ({meta['status']})",
        f"tags: {', '.join(meta['tags'])}",
    ]
    if meta.get("hidden_by"):
        but = f" (not {', '.join(meta['never_hidden'])})" if meta.get("never_hidden") else ""
        facts.append(f"gives way to {', '.join(meta['hidden_by'])} on the same element{but}")
    if meta.get("concerns"):
        facts.append(f"concerns {', '.join(meta['concerns'])} only")
    on_request, dynamics = meta.get("on_request", ()), meta.get("dynamics", ())
    told = (
        describe_on_request(messages, messages if on_request is True else on_request),
        describe_pedantic(messages, meta.get("pedantic", {})),
        describe_dynamics(messages, messages if dynamics is True else dynamics),
    )
    parts = [page.partition("\n")[0], " · ".join((*facts, *filter(None, told))), TITLE.sub("", rest).strip()]
    if options := meta.get("options"):
        lines = (
            f"* `{n}` = {o['default']} {'' if o['unit'] == '1' else o['unit']}: {o['doc']}" for n, o in options.items()
        )
        parts.append("## Options\n\n" + "\n".join(lines))
    return "\n\n".join(parts)


def abridge_page(page: str) -> str:
    """Return what a reader in a hurry needs of a page: how its main sections begin, and its first bad example."""
    import tomli

    header, rest = split_page(page)
    meta = tomli.loads(header.partition("\n[")[0])
    title = page.partition("\n")[0]
    parts = [title, f"{meta['severity']}, {meta['confidence']} · tags: {', '.join(meta['tags'])}"]
    for heading in _ABRIDGED:
        section = re.search(rf"^## {heading}\n+(.*?)(?=^## |\Z)", rest, re.DOTALL | re.MULTILINE)
        if section is None:
            continue
        example = _EXAMPLE.search(section[1]) if heading == "Bad" else None
        parts.append(f"## {heading}\n\n{_take_beginning(section[1]) if example is None else example[0]}")
    code = title.removeprefix("# ").partition(" ")[0]
    return "\n\n".join((*parts, f"The whole page, with all cases: urdfcheck rule {code} --full"))


def _take_beginning(section: str) -> str:
    """Return the first paragraph of a section; one that ends with a colon has what it announces."""
    taken: list[str] = []
    for block in _BLOCK.finditer(section):
        taken.append(block[1].rstrip())
        if not taken[-1].endswith(":"):
            break
    return "\n\n".join(taken)


def describe_on_request(messages: Collection[str], on_request: Iterable[str]) -> str:
    """Say which of a rule's ``messages`` are reported on request only; empty if all are always reported."""
    ids = frozenset(on_request)
    if not ids:
        return ""
    ways = "-v, --pedantic, --select, a severity or a target that they concern"
    return f"{_name_notes(messages, ids)} only on request ({ways})"


def describe_pedantic(messages: Collection[str], pedantic: Mapping[str, Sequence[str]]) -> str:
    """Say which of a rule's ``messages`` are warnings with ``--pedantic``, and for which targets they are; empty if none is."""
    ids_by_targets: dict[tuple[str, ...], set[str]] = {}
    for message, targets in pedantic.items():
        ids_by_targets.setdefault(tuple(targets), set()).add(message)
    return "; ".join(
        f"{_name_notes(messages, frozenset(ids))} are warnings with "
        + " or ".join(("--pedantic", *(f"target {target}" for target in targets)))
        for targets, ids in sorted(ids_by_targets.items())
    )


def describe_dynamics(messages: Collection[str], dynamics: Iterable[str]) -> str:
    """Say which of a rule's ``messages`` are left out where the configuration says ``kinematics-only``; empty if none is."""
    ids = frozenset(dynamics)
    if not ids:
        return ""
    return f"{'all' if ids == set(messages) else ', '.join(sorted(ids))} left out with kinematics-only"


def _name_notes(messages: Collection[str], ids: frozenset[str]) -> str:
    return "notes" if ids == set(messages) else f"notes {', '.join(sorted(ids))}"
