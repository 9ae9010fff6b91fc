"""Cache of findings: those of rules that depend on nothing but a model and its meshes, while neither changes."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any

from urdfcheck.core import Applicability, Cause, Confidence, Edit, Finding, Fix, Location, Rule, Severity, Span
from urdfcheck.model import Model
from urdfcheck.rules import find_pages_folder
from urdfcheck.system.array_cache import find_library_origin

# Libraries that compute the findings, beside urdfcheck itself.
_LIBRARIES = ("numpy", "scipy", "trimesh", "collada", "pinocchio")
_HERE = Path(__file__).parent.parent


class FindingsCache:
    """The findings of earlier runs on one model, stored under a digest of all that they depend on."""

    def __init__(self, model: Model) -> None:
        import numpy as np

        self._entry = model.cache.entry("findings", _compute_digest(model))
        self._new = False
        try:
            self._stored: dict[str, Any] = json.loads(self._entry["all"]["text"].tobytes())
        except KeyError:
            self._stored = {}
        self._array = np.frombuffer

    def recall_findings(
        self, rule: Rule, options: Mapping[str, Any], find: Callable[[], Iterable[Finding]]
    ) -> list[Finding]:
        """Return what ``find`` returns, or returned earlier; only for rules of which `is_cacheable` is true."""
        key = f"{rule.code} {sorted(options.items())}"
        if key in self._stored:
            return [_restore_finding(plain) for plain in self._stored[key]]
        found = list(find())
        try:
            self._stored[key] = json.loads(json.dumps([asdict(finding) for finding in found]))
        except TypeError:  # a numpy number, which JSON does not know: not cached
            return found
        self._new = True
        return found

    def save(self) -> None:
        """Write what is new to the cache."""
        if self._new:
            self._entry["all"] = {"text": self._array(json.dumps(self._stored).encode(), dtype="u1")}


def is_cacheable(rule: Rule) -> bool:
    """Whether a rule depends on nothing but the expanded model, its source text and the content of its meshes."""
    return set(rule.needs) <= {"mesh", "dynamics"} and rule.scopes == ("model",)


def _compute_digest(model: Model) -> str:
    digest = hashlib.sha256()
    for part in _iter_digest_parts(model):
        digest.update(part.encode("utf-8", "surrogatepass") + b"\0")
    return digest.hexdigest()


def _iter_digest_parts(model: Model) -> Iterator[str]:
    yield _stamp_sources()
    yield f"{model.tier} {model.samples} {model.targets} {sorted(model.source.arguments.items())} {model.source.path}"
    for name, file in sorted(model.source.files.items()):
        yield name
        yield file.text
    if model.source.is_xacro:
        # Includes what packages, yaml files and the environment contribute.
        for element in model.robot.walk():
            yield f"{element.tag} {len(element.children)}"
            yield element.text
            for attribute in element.attributes.values():
                yield f"{attribute.name} {attribute.value}"
                yield from (repr(definition.location) for definition in attribute.collect_definitions())
    for use in model.meshes.uses:
        path = use.resource.path
        yield f"{use.filename.value} {path} {use.resource.exists}"
        if path is not None:
            yield str(model.meshes.compute_content_key(path))
            yield str(model.meshes.errors.get(path))


@cache
def _stamp_sources() -> str:
    """Return what changes whenever urdfcheck or a library does: sizes and times of its files."""
    files = sorted((*_HERE.rglob("*.py"), *find_pages_folder().glob("*.md")))
    stamps = [f"{path} {status.st_size} {status.st_mtime_ns}" for path in files for status in (path.stat(),)]
    return "\n".join((*stamps, *(str(find_library_origin(library)) for library in _LIBRARIES)))


def _restore_finding(plain: Mapping[str, Any]) -> Finding:
    fix, cause = plain["fix"], plain["cause"]
    return Finding(
        **{
            **plain,
            "severity": Severity(plain["severity"]),
            "confidence": Confidence(plain["confidence"]),
            "location": _restore_location(plain["location"]),
            "subjects": tuple(plain["subjects"]),
            "occurrences": (),  # findings are merged later
            "related": tuple(_restore_location(place) for place in plain["related"]),
            "cause": None if cause is None else Cause(**cause),
            "fix": None
            if fix is None
            else Fix(fix["title"], Applicability(fix["applicability"]), _restore_edits(fix["edits"])),
        }
    )


def _restore_location(plain: Mapping[str, Any]) -> Location:
    return Location(plain["subject"], _restore_span(plain["span"]), tuple(Span(**span) for span in plain["via"]))


def _restore_span(plain: Mapping[str, Any] | None) -> Span | None:
    return None if plain is None else Span(**plain)


def _restore_edits(plain: list[Mapping[str, Any]]) -> tuple[Edit, ...]:
    return tuple(Edit(Span(**edit["span"]), edit["expected"], edit["replacement"]) for edit in plain)
