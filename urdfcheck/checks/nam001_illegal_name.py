"""NAM001 reports names of links and joints that a program refuses, changes or splits."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

from urdfcheck.core import Finding, Location, Rule, Severity, Span
from urdfcheck.core.text import join_names, spell_breaks
from urdfcheck.model import Joint, Link, Model
from urdfcheck.model.use.gazebo_starts import is_only_made_into_sdf
from urdfcheck.model.use.project_texts import list_project_texts
from urdfcheck.source.model_file import EXPRESSION

# The names of prims in USD.
_IDENTIFIER = re.compile(r"[A-Za-z_]\w*", re.ASCII)

# Programs that make USD of a robot, and files in USD, as manifests, launch files and scripts name them.
_USD = re.compile(r"isaac|\bpxr\b|urdf[-_]usd|import newton|\.usd[acz]?\b", re.IGNORECASE).search


def _has_break(name: str) -> bool:
    return any(c in "\t\n\r" for c in name)


def _has_space(name: str) -> bool:
    return any(c.isspace() for c in name)


# Each kind of mistake: its message, its severity, and whether a name has it (the flag: the name of a link, not a joint).
_KINDS: tuple[tuple[str, Severity, Callable[[str, bool], bool]], ...] = (
    ("empty", Severity.WARNING, lambda name, _: not name.strip()),
    ("break", Severity.WARNING, lambda name, _: bool(name.strip()) and _has_break(name)),
    ("space", Severity.WARNING, lambda name, _: bool(name.strip()) and _has_space(name) and not _has_break(name)),
    ("leading_slash", Severity.WARNING, lambda name, link: link and name.startswith("/")),
    ("scope", Severity.WARNING, lambda name, _: "::" in name),
    ("reserved", Severity.WARNING, lambda name, _: len(name) > 3 and name.startswith("__") and name.endswith("__")),
    ("slash", Severity.INFO, lambda name, link: "/" in name[1 if link else 0 :]),
    ("digit", Severity.INFO, lambda name, _: name[:1].isdigit()),
)

# What is wrong with a name may be typed in the argument of a call or in a property that the name is made of.
_TYPED: Mapping[str, Callable[[str], bool]] = {
    "break": _has_break,
    "space": _has_space,
    "leading_slash": lambda text: text.startswith("/"),
    "scope": lambda text: "::" in text,
    "slash": lambda text: "/" in text,
}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    named = [part for part in model.named_elements if "name" in part.element.attributes]
    for message, usual, is_wrong in _KINDS:
        severity = usual
        wrong = [part for part in named if is_wrong(part.name, isinstance(part, Link))]
        if message == "space" and wrong and not _are_blanks_felt(model, wrong):
            severity = Severity.INFO
        if message == "leading_slash" and wrong and is_only_made_into_sdf(model):
            severity = Severity.INFO  # no program publishes the frames
        behind = {id(part) for part in wrong if message == "leading_slash" and _find_typed_slash(part) is not None}
        plain = [part for part in wrong if id(part) not in behind]
        yield from _build_findings(rule, message, severity=severity, parts=plain)
        rest = [part for part in wrong if id(part) in behind]
        yield from _build_findings(rule, "slash_behind_nothing", severity=severity, parts=rest)
    roots = {link.name for link in model.links} - {joint.child for joint in model.joints}
    worlds = [part for part in named if part.name == "world"]
    links = [part for part in worlds if isinstance(part, Link) and part.name not in roots]
    # The conversion to SDF merges the links of a fixed joint, and its name disappears, unless one is the world.
    joints = [part for part in worlds if isinstance(part, Joint) and (part.type != "fixed" or part.parent == "world")]
    # Without a mass anywhere it is a model to be drawn: Gazebo drops each link of it whatever its name is.
    has_mass = any(link.element.find_child("inertial") is not None for link in model.links)
    severity = Severity.WARNING if has_mass else Severity.INFO
    yield from _build_findings(rule, "world", severity=severity, parts=links)
    yield from _build_findings(rule, "world-joint", severity=Severity.WARNING, parts=joints)
    name = model.name.strip()
    if name and not _IDENTIFIER.fullmatch(name):
        yield rule.finding(
            "robot",
            at=model.name_location,
            severity=Severity.INFO,
            name=name,
            identifier=re.sub(r"^(?=\d)", "_", re.sub(r"\W", "_", name, flags=re.ASCII)),
        )


def _are_blanks_felt(model: Model, parts: Sequence[Link | Joint]) -> bool:
    """Whether blanks in these names may harm: no program commands a fixed joint by its name, and blanks inside a name are changed
    by what makes USD of the robot only, which its project would name. Blanks at an end are slips: the SRDF loses them."""
    if not any(isinstance(part, Link) or part.is_movable for part in parts):
        return False
    if any(part.name != part.name.strip() for part in parts) or model.source.package is None:
        return True
    return any(map(_USD, list_project_texts(model)))


def _build_findings(
    rule: Rule, message: str, *, severity: Severity, parts: Sequence[Link | Joint]
) -> Iterator[Finding]:
    """Report all names with one mistake together: they come from one habit."""
    if parts:
        names = [part.name for part in parts]
        places = [_locate_mistake(part, message) for part in parts]
        typed = _find_typed_slash(parts[0]) if message == "slash_behind_nothing" else None
        at = places[0] if typed is None else Location(places[0].subject, typed[0])
        others = {place.span: place for place in reversed(places) if place.span != at.span}
        finding = rule.finding(
            message,
            at=at,
            severity=severity,
            related=list(reversed(others.values()))[:9],
            typed="" if typed is None else typed[1],
            names=join_names(f"'{spell_breaks(name)}'" for name in dict.fromkeys(names)),
            blanks=_describe_blanks(names),
            count=len(names),
        )
        yield replace(finding, subjects=tuple(_locate_name(part).subject for part in parts))


def _find_typed_slash(part: Link | Joint) -> tuple[Span | None, str] | None:
    """Return where the slash that begins a name is typed behind expressions, which are empty, and what is typed there."""
    name = part.element.attributes["name"]
    typed = [(name.span, name.typed, name.value)]
    typed += [(definition.span, definition.text, definition.value) for definition in name.collect_definitions()]
    for span, text, value in typed:
        literal = EXPRESSION.sub("", text)
        # The slashes of the value are those that are typed, so the first one is.
        if text[:1] == "$" and literal[:1] == "/" == value[:1] and literal.count("/") == value.count("/"):
            return span, text
    return None


def _locate_mistake(part: Link | Joint, message: str) -> Location:
    """Return where what is wrong with a name is typed: at the name, or in what a call or a property gives it."""
    name, own, is_wrong = part.element.attributes["name"], _locate_name(part), _TYPED.get(message)
    if name.literal or is_wrong is None or is_wrong(EXPRESSION.sub("", name.typed)):
        return own
    for definition in name.collect_definitions():
        text = EXPRESSION.sub("", definition.text) if definition.text else definition.value
        if is_wrong(text) and definition.value in name.value:
            steps = own.via if own.span is None else (*own.via, own.span)
            return Location(own.subject, definition.span, tuple(step for step in steps if step != definition.span))
    return own


def _describe_blanks(names: Sequence[str]) -> str:
    """Say what to do about the blanks in names: at their ends they are slips."""
    inside, around = any(_has_space(name.strip()) for name in names), any(name != name.strip() for name in names)
    parts = ["delete each space at the beginning or end"] * around + ["replace each space by an underscore"] * inside
    return " and ".join(parts)


def _locate_name(part: Link | Joint) -> Location:
    return part.element.attributes["name"].location
