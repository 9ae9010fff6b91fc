"""The headline of a finding: a template of the rule's page in at most 70 characters. Standard library only."""

from __future__ import annotations

import re
import string
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from urdfcheck.core.text import join_names

LONGEST_HEADLINE = 70
# A value is not cut below this; a headline that is still too long then loses its end.
_SHORTEST_VALUE = 10
# What stays of a name after a word that says what it names.
_SHORTEST_REST = 4
# Longer texts come from attacks; each step looks at all of a text.
_LONGEST_VALUE = 500
# What `urdfcheck.core.text.join_names` makes of names, also of such as `arm and hand at 0.3 rad (2 mm)`.
_NAME = re.compile(r"[^\s,]+(?: and (?!\d+ more)[^\s,]+)?(?: at -?[\d.]+ \S+)?(?: \([^()]*\))?")
_PART = re.compile(r" \(| at | and ")
_MORE = re.compile(r" and (\d+) more$")
# A headline that begins with what it is about, and a number in brackets.
_ABOUT = re.compile(r"\{(\w+)\}: (.*)", re.DOTALL)
_LAST_BRACKETS = re.compile(r" \([^()]*\)$")
_LAST_LIST = re.compile(r": \{(\w+)\}$")
_FIRST_LIST = re.compile(r"\{((link|joint)s?)\}(?=: | and )")
_BRACKETS = re.compile(r" \([^()]*\)")
# A value that ends with the verb of the headline, as it depends on a number: `meshes a.dae, b.dae declare`.
_ENDING_VERB = re.compile(r" (?:is|are|has|have|declares?|refers?)$|: $")
# What a headline leaves out, counted: ` (+7 joints)`.
_COUNTED = re.compile(r" \(\+\d+ \w+\)|\d[\d,]* \w+(?: have| has)?")
# Between the words of a name.
_SEPARATOR = re.compile(r"[_\-./ ]")
_ONE_WORD = re.compile(r"\S+(?:: )?")
# The name of a file: its end says what it is.
_FILE = re.compile(r"\.(?:\w{2,4}|launch|xacro)$")
# A value that has a shorter one beside it, such as `fault_short` beside `fault`, is replaced by it before any text is cut.
_SHORT = "_short"
# A hint in brackets at the end that is left out rather than that the names before it lose so many letters.
_MOST_LOST = 20
_NAMES = re.compile(rf"{_NAME.pattern}(?:(?:, {_NAME.pattern})+(?:{_MORE.pattern})?|{_MORE.pattern})")


def fill_headline(template: str, data: Mapping[str, Any], limit: int = LONGEST_HEADLINE) -> str:
    """Fill a template of ``[headlines]``, and shorten its longest texts until the whole has at most ``limit`` characters.

    Lists lose names and paths lose folders (`drop_parts`); if that is not enough, a value with a shorter one beside it (`fault`
    and `fault_short`) gives way to it, and then texts are cut (`cut_text`). The words of the template stay, and the verb at the
    end of a value.

    :raises KeyError: if ``data`` lacks a value of the template.
    """
    values = {key: data[key] for _, key, _, _ in string.Formatter().parse(template) if key is not None}
    texts = {k: cut_middle(v, _LONGEST_VALUE) for k, v in values.items() if isinstance(v, str)}
    headline = _fill_line(template, values | texts)
    for shorten in (drop_parts, cut_text):
        if shorten is cut_text and len(headline) > limit:
            if brief := _list_shorter_values(texts, data):
                # Where the names are only counted, there may be room for all of the claim.
                counted = _count_first_list(template, texts)
                if counted != template and len(line := _fill_line(counted, values | texts)) <= limit:
                    return line
                return fill_headline(template, values | brief, limit)
            # A name in pieces and a number without its end say less than a claim without them.
            shorter = _leave_out(template, texts, limit - len(headline))
            if shorter != template:
                return fill_headline(shorter, data, limit)
        # A name that is cut is hard to find, so the first, which the headline is about, is cut last.
        subject = next(iter(texts), None) if shorten is cut_text else None
        for kept in (subject, None) if subject else (None,):
            whole = texts
            most = min(max((len(text) for key, text in whole.items() if key != kept), default=0), limit)
            while len(headline) > limit and most > _SHORTEST_VALUE:
                most -= 1
                texts = {key: text if key == kept else shorten(text, most) for key, text in whole.items()}
                if shorten is cut_text:
                    texts = _tell_apart(whole, texts, most)
                headline = _fill_line(template, values | texts)
    return cut_line(headline, limit)


def shorten_headline(headline: str, template: str, data: Mapping[str, Any], limit: int) -> str:
    """Return at most ``limit`` characters of a headline: with shorter values where it was filled from ``template`` and ``data``
    has them, otherwise without its end.

    :raises KeyError: if ``data`` lacks a value of the template.
    """
    has_shorter = _list_shorter_values((key for _, key, _, _ in string.Formatter().parse(template) if key), data)
    if len(headline) > limit and has_shorter and fill_headline(template, data) == headline:
        return fill_headline(template, data, limit)
    return cut_line(headline, limit)


def _list_shorter_values(keys: Iterable[str], data: Mapping[str, Any]) -> dict[str, str]:
    return {key: data[f"{key}{_SHORT}"] for key in keys if f"{key}{_SHORT}" in data}


def cut_line(line: str, most: int) -> str:
    """Return at most ``most`` characters of a line: whole words, if there are some, and no bracket without its end."""
    if len(line) <= most:
        return line
    most = max(most, 1)
    kept = line[: most - 1]
    words = kept if line[most - 1] == " " else kept.rpartition(" ")[0]
    kept = words if len(words) > most // 2 else kept
    before = kept.rpartition(" (")[0] if kept.count("(") > kept.count(")") else kept
    return f"{(before or kept).rstrip(' ,;:(')}…"


def _leave_out(template: str, texts: Mapping[str, str], missing: int) -> str:
    """Leave out of a template what would be cut: a number in brackets at its end, the list at its end, which other lines have,
    or count the list at its beginning."""
    found = _LAST_BRACKETS.search(template)
    if found is not None and (missing < -_MOST_LOST or not any(f"{{{key}}}" in found[0] for key in texts)):
        return template[: found.start()]
    found = _LAST_LIST.search(template)
    names = texts.get(found[1], "") if found is not None else ""
    more = _MORE.search(names)
    if found is not None and more is not None and found.start():
        # The first name may be followed by what happens to it, which may be cut.
        least = len(_PART.split(names[: more.start()])[0]) + len(more[0])
        return template if least <= len(names) + missing else template[: found.start()]
    return _count_first_list(template, texts)


def _count_first_list(template: str, texts: Mapping[str, str]) -> str:
    """Count in a template the list at its beginning if it leaves out names; any other template stays."""
    found = _FIRST_LIST.match(template)
    names = texts.get(found[1], "") if found is not None else ""
    more = _MORE.search(names)
    if found is not None and more is not None:
        count = len(_NAME.findall(names[: more.start()])) + int(more[1])
        return f"{count} {found[2]}s{template[found.end() :]}"
    return template


def fill_joint_headline(
    template: str, data: Sequence[Mapping[str, Any]], names: Sequence[Sequence[str]], kind: str, places: int = 0
) -> str:
    """Fill a template for several findings at once.

    A headline that begins with what it is about names all of it, or counts it where the first name alone is too long, and
    leaves out a number in brackets that is not the same for all: ``a, b and 6 more: no body can have this inertia``, ``8 links:
    no body can have this inertia``. Any other is that of the first finding: ``a and b overlap by 5 mm at rest (+7
    more)``.

    :param data: values of each finding.
    :param names: elements that each finding is about.
    :param kind: what these elements are, in the plural: ``links``.
    :param places: how many there are, where that is more than their names, which several may share.
    :raises KeyError: if ``data`` lacks a value of the template.
    """
    about = _ABOUT.fullmatch(template)
    if about is not None and _is_named(about[1], data, names):
        claim = _BRACKETS.sub(lambda found: "" if _is_other_number(found[0], data) else found[0], about[2])
        if _is_same(claim, data):
            everything = list(dict.fromkeys(name for some in names for name in some))
            named = fill_headline(f"{{{about[1]}}}: {claim}", {**data[0], about[1]: join_names(everything)})
            if named.startswith(everything[0]):
                return named
            counted = f"{places} places" if places > len(everything) else f"{len(everything)} {kind}"
            return fill_headline(f"{counted}: {claim}", data[0])
    rest = format_more(count_more(template, data, names))
    return f"{fill_headline(template, data[0], LONGEST_HEADLINE - len(rest))}{rest}"


def count_more(template: str, data: Sequence[Mapping[str, Any]], names: Sequence[Sequence[str]]) -> int:
    """Count what several findings are about besides what the headline names or counts: elements, of which one finding may be
    about several (one line of a macro); findings where it names and counts none."""
    told = _list_told(template, data[0], names[0])
    others = {name for some in names for name in some}.difference(told)
    return max(len(data) - 1, len(others)) if told else len(data) - 1


def _list_told(template: str, values: Mapping[str, Any], names: Sequence[str]) -> Sequence[str]:
    """List the elements of a finding that its headline names or counts: all of them, or the first one alone."""
    if not names:
        return ()
    shown = [values[key] for _, key, _, _ in string.Formatter().parse(template) if key and key in values]
    counted = f"{len(names)} "  # `8 links`
    if join_names(names) in shown or any(f"{value} ".startswith(counted) for value in shown):
        return names
    return names[:1] if names[0] in shown else ()


def format_more(count: int) -> str:
    """Say at the end of the headline of one finding how many more there are, of which each may have several places."""
    return f" (+{count} more)"


def _is_named(key: str, data: Sequence[Mapping[str, Any]], names: Sequence[Sequence[str]]) -> bool:
    """Whether a value is nothing but the names of the elements that a finding is about, for each finding."""
    return all(some and values[key] in (some[0], join_names(some)) for values, some in zip(data, names, strict=True))


def _is_other_number(template: str, data: Sequence[Mapping[str, Any]]) -> bool:
    """Whether a template says different numbers of the findings; different words, such as a cause, are part of a claim."""
    return not _is_same(template, data) and any(re.search("[0-9]", template.format_map(values)) for values in data)


def _is_same(template: str, data: Sequence[Mapping[str, Any]]) -> bool:
    """Whether a template says the same of all findings."""
    return len({template.format_map(values) for values in data}) == 1


def _tell_apart(whole: Mapping[str, str], cut: Mapping[str, str], most: int) -> dict[str, str]:
    """Cut names, such as the left and the right of a robot, so that what differs from the first one stays: where the end is cut,
    the words that both begin with are left out if the rest would be alike."""
    first, *others = whole
    told = dict(cut)
    for key in others:
        name = whole[key]
        shared = _measure_shared_start(whole[first], name)
        is_shown = len(cut[key].rstrip("…")) > shared and cut[key] not in {told[first], *_list_before(told, key)}
        if shared and cut[key] != name and not is_shown and _ONE_WORD.fullmatch(name):
            rest = f"…{name[shared:]}"
            told[key] = rest if len(rest) <= most else cut_name(rest, most)
    return told


def _list_before(texts: Mapping[str, str], key: str) -> list[str]:
    return list(texts.values())[: list(texts).index(key)]


def _measure_shared_start(one: str, other: str) -> int:
    """Return how many letters two different names have in common at the beginning, up to the end of a word."""
    alike = next((i for i, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), min(len(one), len(other)))
    ends = [found.end() for found in _SEPARATOR.finditer(other, 0, alike)]
    return ends[-1] if ends and one != other else 0


def _fill_line(template: str, values: Mapping[str, Any]) -> str:
    """Fill a template, in one line and without the marks of code, whatever the values hold."""
    return " ".join(template.format_map(values).replace("`", "").split())


def drop_parts(text: str, most: int) -> str:
    """Leave out names at the end of ``a, b, c and 4 more``, or folders at the beginning of a path, until ``most`` characters are
    left or nothing but the first name or the file; any other text stays."""
    if len(text) <= most:
        return text
    if _NAMES.fullmatch(text):
        more = _MORE.search(text)
        names = _NAME.findall(text if more is None else text[: more.start()])
        others = 0 if more is None else int(more[1])
        while len(names) > 1 and len(_count_others(names, others)) > most:
            names.pop()
            others += 1
        return _count_others(names, others)
    words = text.split(" ")
    longest = max(range(len(words)), key=lambda i: len(words[i]))
    words[longest] = _drop_folders(words[longest], most - len(text) + len(words[longest]))
    return " ".join(words)


def _drop_folders(path: str, most: int) -> str:
    shown = path
    # A subject, like `link[a]/inertial`, is no path: it begins with what matters most.
    while len(shown) > most and "[" not in path:
        _, slash, rest = shown.removeprefix("…/").partition("/")
        if not slash or not rest:
            break
        shown = f"…/{rest.lstrip('/')}"
    return min(path, shown, key=len)


def _count_others(names: Iterable[str], others: int) -> str:
    return ", ".join(names) + (f" and {others} more" if others else "")


def cut_text(text: str, most: int) -> str:
    """Return at most ``most`` characters of a text: the first words of a sentence or of a name, and of the name before
    `` and 4 more``; the end of the name of a file. Counts stay."""
    if len(text) <= most or _COUNTED.fullmatch(text):
        return text
    verb = _ENDING_VERB.search(text)
    if verb is not None:
        return cut_text(text[: verb.start()], most - len(verb[0])) + verb[0]
    more = _MORE.search(text)
    if more is not None and _NAMES.fullmatch(text):
        first, room = text[: more.start()], most - len(more[0])
        return cut_name(first if len(first) <= room else _PART.split(first)[0], room) + more[0]
    words, _, _ = text[:most].rpartition(" ")
    return f"{words.rstrip(' ,;:(')}…" if len(words) > most // 2 else cut_name(text, most)


def cut_name(name: str, most: int) -> str:
    """Return at most ``most`` characters of a name (at least 2): its first words, or the last ones of a file's."""
    kept = max(most - 1, 2)
    if len(name) <= most:
        return name
    kind, blank, rest = name.partition(" ")  # `state half_sitting`, `mesh wheel.stl`
    if blank and len(kind) + _SHORTEST_REST < most:
        return f"{kind} {cut_name(rest, most - len(kind) - 1)}"
    if _FILE.search(name):
        cut = next((found.start() for found in _SEPARATOR.finditer(name, len(name) - kept)), len(name) - kept)
        is_word = len(name) - cut > kept // 2 and "." in name[cut + 1 :]
        return f"…{name[cut if is_word else len(name) - kept :]}"
    cut = max((found.start() for found in _SEPARATOR.finditer(name, 0, kept + 1)), default=0)
    return f"{name[: cut if cut > kept // 2 else kept]}…"


def cut_middle(text: str, most: int) -> str:
    """Return a text, or its beginning, ``…`` and its end if it has more than ``most`` characters (at least 2)."""
    kept = max(most - 1, 2)
    return text if len(text) <= most else f"{text[: kept // 2]}…{text[len(text) - (kept + 1) // 2 :]}"
