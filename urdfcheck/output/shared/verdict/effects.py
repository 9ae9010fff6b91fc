"""What programs do with a defect, as the formats report it: news only, for the programs that matter, once per rule."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence

from urdfcheck.core import Finding, Run, Verdict
from urdfcheck.output.shared.wording import PROGRAM_NAMES, join_with_and
from urdfcheck.policy.consumers import PARSERS, is_news

# What was told: a rule, and the effects in their words.
ToldEffects = set[tuple[str, str]]

# What follows the first clause of a sentence; a comma may also separate the names of a list.
_REST = re.compile(
    r"\s*(?:[:;(\"]|,(?= (?:and|or|but|so|which|because|unless|with|without|where|when|while|as|if|though|then)\b)).*",
    re.DOTALL,
)
# What may be before the clause that matters: ``in Gazebo Classic, the joint shakes``, ``"Mass Properties" shows …``.
_LEAD = re.compile(r'(?:(?:and )?(?:in|with|where|when|if|for|at)\b[^,:;]*[,:;]\s*)*(?:"[^"]*")?')
# A sentence about a program begins with its verb, or with another subject: ``the joint``, ``contacts, mass and COM``.
_VERB = re.compile(r"(?!(?:contacts|motors|paths|torques|wheels)\b)(?:[a-z]+s|refused)(?=[ :;]|$)")
# What follows the object of a verb: ``replaces the inertia by that of its box``.
_COMPLEMENT = re.compile(r" (?:by|with|from|of|in|to|because|where|when|if|after|so that|unless)\b.*", re.DOTALL)
# How the effect of a sensor's wrong frame begins, which changes nothing of the model; and what it is in general.
_DATA, _DATA_DROPPED = "drops the data", "drops the data of a sensor"
_PLURALS = {"is": "are", "has": "have", "does": "do", "goes": "go"}
# What a program does something to, by its verdict, which is a verb.
_OBJECTS = {
    Verdict.IGNORES: "a part",
    Verdict.REPLACES: "values",
    Verdict.SWAPS: "values",
    Verdict.DROPS: "a part",
    Verdict.REFUSES: "the model",
}


def list_effects(run: Run, finding: Finding, *, every: bool = False) -> list[tuple[str, str]]:
    """Return what programs do with a defect, the worst first: the names of those that do the same, and a sentence.

    That a program loads what was typed is the default and left out, and so are programs that are not targets where there are
    targets; ``every`` lists these too.
    """
    return [
        (", ".join(map(_name, names)), effect) for effect, names in _group_effects(run, finding, every=every).items()
    ]


def list_new_effects(run: Run, finding: Finding, told: ToldEffects, *, every: bool = False) -> list[tuple[str, str]]:
    """Return what :func:`list_effects` does, or nothing if it was ``told`` of the rule in these words; ``told`` is extended."""
    effects = list_effects(run, finding, every=every)
    key = (finding.code, repr(effects))
    if key in told:
        return []
    told.add(key)
    return effects


def describe_hits(run: Run, finding: Finding, room: int) -> str:
    """Say in a line which programs do not load what was typed: ``MuJoCo refuses the file · Drake and Bullet replace values``.

    Where targets are named, this covers them alone, whatever they do. If all programs load it, this is what goes wrong first:
    ``Gazebo: the joint sags``. Several effects that take more than ``room`` characters lose what follows their objects, and
    are then summarized by verdict.
    """
    has_targets = bool(run.get_targets(finding.model))
    news = list(_group_effects(run, finding).items())
    worst = [item for item in news if Verdict.from_sentence(item[0]) > Verdict.LOADS]
    news.sort(key=lambda item: item[1] == ["rviz"])  # what is drawn matters less than what moves
    effects = dict(news if has_targets else worst or news[:1])
    lines = [_join_hits(effects, shorten) for shorten in (_shorten_effect, _name_object, _generalize_or_cut)]
    return next((line for line in lines if len(line) <= room), lines[-1])


def _join_hits(effects: Mapping[str, Sequence[str]], shorten: Callable[[str], str]) -> str:
    hits: dict[str, list[str]] = {}
    for effect, names in effects.items():
        hits.setdefault(shorten(effect), []).extend(names)
    return " · ".join(_join_hit(names, effect) for effect, names in hits.items())


def _join_hit(names: Sequence[str], effect: str) -> str:
    """Name programs and what they do, or what happens there: ``Gazebo: the joint sags``."""
    if has_own_subject(effect):
        return f"{join_programs(names)}: {effect}"
    return f"{join_programs(names)} {effect if len(names) == 1 else _use_plural(effect)}"


def has_own_subject(effect: str) -> bool:
    """Whether a sentence about a program is about a part of the robot: ``the joint sags``. A colon then leads to it."""
    return _VERB.match(effect) is None


def drops_only_data(effect: str) -> bool:
    """Whether what a program drops is not a part of the model, but what a sensor measures."""
    return effect.startswith(_DATA)


def describe_verdict(verdict: Verdict, count: int = 1) -> str:
    """Say what one program, or several, do to a model in general: ``replaces values``, ``replace values``."""
    effect = f"{verdict} {_OBJECTS.get(verdict, '')}".rstrip()
    return effect if count == 1 else _use_plural(effect)


def generalize_effect(effect: str, count: int = 1) -> str:
    """Say what a sentence about one program, or several, does to the model in general: ``replaces values``."""
    if drops_only_data(effect):
        return _DATA_DROPPED if count == 1 else _use_plural(_DATA_DROPPED)
    return describe_verdict(Verdict.from_sentence(effect), count)


def join_programs(names: Sequence[str]) -> str:
    """Join the names of programs: ``MuJoCo, Drake and Bullet``."""
    return join_with_and([*map(_name, names)])


def group_by_effect(consequences: Mapping[str, str]) -> dict[str, list[str]]:
    """Group the programs by effect: programs that do the same thing share a line."""
    effects: dict[str, list[str]] = {}
    for program, effect in consequences.items():
        effects.setdefault(effect, []).append(program)
    return effects


def _name(program: str) -> str:
    return PROGRAM_NAMES.get(program, program)


def _group_effects(run: Run, finding: Finding, *, every: bool = False) -> dict[str, list[str]]:
    if every:
        return group_by_effect(finding.consequences)
    targets = run.get_targets(finding.model)
    told = {name: effect for name, effect in finding.consequences.items() if is_news(effect)}
    if targets:
        told = {name: effect for name, effect in told.items() if _matters(name, effect, targets)}
    effects = group_by_effect(told)
    return dict(sorted(effects.items(), key=lambda item: -Verdict.from_sentence(item[0])))


def _matters(name: str, effect: str, targets: Sequence[str]) -> bool:
    """Whether a program is a target, or the parser of one that loses what the parser rejects or drops."""
    is_parser = any(PARSERS.get(target) == name for target in targets)
    return name in targets or (is_parser and Verdict.from_sentence(effect) >= Verdict.DROPS)


def _shorten_effect(effect: str) -> str:
    """Cut a sentence at its first clause, unless that leaves its verb alone."""
    short = _cut_clause(effect)
    return short if " " in short else _generalize_or_cut(effect)


def _name_object(effect: str) -> str:
    """Cut a clause behind its object: ``replaces the inertia``."""
    if Verdict.from_sentence(effect) is Verdict.LOADS:
        return _shorten_effect(effect)
    short = _COMPLEMENT.sub("", _shorten_effect(effect))
    return short if " " in short else _generalize_or_cut(effect)


def _generalize_or_cut(effect: str) -> str:
    """Say what a sentence does to the model in general: ``replaces values``."""
    return generalize_effect(effect) if Verdict.from_sentence(effect) in _OBJECTS else _cut_clause(effect)


def _cut_clause(effect: str) -> str:
    """Return the first clause of a sentence with what leads to it."""
    lead = _LEAD.match(effect)
    start = lead.end() if lead else 0
    return effect[:start] + _REST.sub("", effect[start:])


def _use_plural(effect: str) -> str:
    """Put the verb that a clause begins with into the plural."""
    verb, _, rest = effect.partition(" ")
    if verb.endswith("ies"):
        plural = f"{verb[:-3]}y"
    elif verb.endswith(("ches", "shes", "sses", "xes", "zzes")):
        plural = verb[:-2]
    else:
        plural = verb.removesuffix("s")
    return f"{_PLURALS.get(verb, plural)} {rest}".rstrip()
