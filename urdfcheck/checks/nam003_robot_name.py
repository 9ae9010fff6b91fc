"""NAM003 reports a robot name that disagrees with its file or its package."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator
from pathlib import PurePosixPath

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model

# Words that packages and files add to the name of a robot.
_GENERIC_WORDS = frozenset({
    "description", "descriptions", "support", "model", "models", "robot", "robots", "urdf", "xacro", "gazebo", "ros",
    "ros2", "moveit", "config", "bringup", "resources", "sim", "simulation", "package", "pkg", "common", "data",
})  # fmt: skip
# Letters that are added, left out or replaced.
_MOST_LETTERS_APART = 2
_MIN_SIMILARITY = 0.85
_MIN_LETTERS = 6


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    name = model.robot.attributes.get("name")
    if name is None or not name.value.strip():
        return
    stem = PurePosixPath(model.source.name).name.split(".")[0]
    if _is_misspelt_name(name.value, stem):
        folder = next((f.name for f in model.source.path.absolute().parents if _is_spelled_in(stem, f.name)), None)
        repair = (
            "use the same spelling for both"
            if folder is None
            else f'write `name="{stem}"`, as the folder {folder} has it'
        )
        yield rule.finding("misspelt", at=name, name=name.value, file=stem, repair=repair)
        return
    package = model.package
    if package is None or _is_related_name(name.value, package.name):
        return
    for file, included in _find_dropped_names(model):
        names = (name.value, package.name, included)
        if len({_extract_name_words(n)[0] for n in names}) == 1:  # the same first word: three names for one robot
            yield rule.finding("several", at=name, name=name.value, package=package.name, included=included, file=file)
            return


def _find_dropped_names(model: Model) -> Iterator[tuple[str, str]]:
    """Yield the included files and the names of their root elements, which xacro drops."""
    for file, tree in model.source.trees.items():
        included = tree.get("name")
        if file != model.source.name and included not in {"", model.name} and _extract_name_words(included):
            yield PurePosixPath(file).name, included


def _extract_name_words(name: str) -> list[str]:
    """Return the words of a name in lower case, without generic ones."""
    words = re.findall(r"[a-z0-9]+", name.lower())
    return [w for w in words if w not in _GENERIC_WORDS] or words


def _is_related_name(one: str, other: str) -> bool:
    """Whether one name extends the other (``husky`` and ``husky_description``)."""
    a, b = _extract_name_words(one), _extract_name_words(other)
    return set(a) <= set(b) or set(b) <= set(a) or "".join(a) in "".join(b) or "".join(b) in "".join(a)


def _is_spelled_in(name: str, folder: str) -> bool:
    """Whether a folder is called by all words of a name: ``quadruped_description``."""
    return set(_extract_name_words(name)) <= set(_extract_name_words(folder))


def _is_misspelt_name(name: str, stem: str) -> bool:
    """Whether two long names have the same digits and differ in a letter or two."""
    a, b = "".join(_extract_name_words(name)), "".join(_extract_name_words(stem))
    if min(len(a), len(b)) < _MIN_LETTERS or _is_related_name(name, stem) or sorted(a) == sorted(b):
        return False
    if all(len(word) == 1 for word in {*_extract_name_words(name)} ^ {*_extract_name_words(stem)}):
        return False  # gripper_l and gripper_r, arm_a and arm_b: two parts
    same_digits = re.findall(r"\d", a) == re.findall(r"\d", b)
    return same_digits and _are_letters_apart(a, b)


def _are_letters_apart(a: str, b: str) -> bool:
    """Whether two texts are alike, and differ in two letters at most."""
    matcher = difflib.SequenceMatcher(None, a, b)
    if matcher.ratio() < _MIN_SIMILARITY:
        return False
    changed = sum(max(i2 - i1, j2 - j1) for tag, i1, i2, j1, j2 in matcher.get_opcodes() if tag != "equal")
    return changed <= _MOST_LETTERS_APART
