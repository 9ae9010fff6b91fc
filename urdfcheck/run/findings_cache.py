"""Cache of findings: those of rules that depend on nothing but a model and its meshes, while neither changes."""

from __future__ import annotations

import contextlib
import hashlib
import io
import pickle
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model
from urdfcheck.system.installation import compute_installation_stamp
from urdfcheck.system.plain_pickle import load_plain


class FindingsCache:
    """The findings of earlier runs on one model, stored under a digest of all that they depend on."""

    def __init__(self, model: Model) -> None:
        import numpy as np

        self._entry = model.cache.entry("findings", _compute_digest(model))
        self._new = False
        self._stored: dict[str, list[Finding]] = {}
        with contextlib.suppress(Exception):  # there is none; pickle raises many kinds for a damaged one
            self._stored = load_plain(io.BytesIO(self._entry["all"]["pickle"].tobytes()))
        self._array = np.frombuffer

    def recall_findings(
        self, rule: Rule, options: Mapping[str, Any], find: Callable[[], Iterable[Finding]]
    ) -> list[Finding]:
        """Return what ``find`` returns, or returned earlier; only for rules of which `is_cacheable` is true."""
        key = f"{rule.code} {sorted(options.items())}"
        if key in self._stored:
            return self._stored[key]
        self._stored[key] = found = list(find())
        self._new = True
        return found

    def save(self) -> None:
        """Write what is new to the cache."""
        if self._new:
            self._entry["all"] = {"pickle": self._array(pickle.dumps(self._stored), dtype="u1")}


def is_cacheable(rule: Rule) -> bool:
    """Whether a rule depends on nothing but the expanded model, its source text and the content of its meshes."""
    return set(rule.needs) <= {"mesh", "dynamics"} and rule.scopes == ("model",)


def _compute_digest(model: Model) -> str:
    digest = hashlib.sha256()
    for part in _iter_digest_parts(model):
        digest.update(part.encode("utf-8", "surrogatepass") + b"\0")
    return digest.hexdigest()


def _iter_digest_parts(model: Model) -> Iterator[str]:
    yield compute_installation_stamp()
    yield f"{model.tier} {model.samples} {model.targets} {sorted(model.source.arguments.items())} {model.source.path}"
    yield f"{sorted(model.mesh_limits.items())}"
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
