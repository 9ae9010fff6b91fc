"""Verdicts on inertials as plain values, which are kept between runs."""

from __future__ import annotations

import json
from collections.abc import Mapping, MutableMapping
from dataclasses import field
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.diagnosis import Diagnosis
from urdfcheck.facts.inertials.mistakes.file_habits import Evidence

if TYPE_CHECKING:
    from urdfcheck.system.array_cache import Arrays


@dataclass(slots=True)
class KeptVerdicts:
    """What is kept between runs, as plain values."""

    whole: str | None = None
    """A digest of all that the verdicts depend on."""
    links: dict[str, tuple[str, list[str]]] = field(default_factory=dict)
    """The key of its verdict, and its twins, by link."""
    verdicts: dict[str, Any] = field(default_factory=dict)
    evidence: dict[str, Any] = field(default_factory=dict)
    """Of links alone, by the key of their verdict."""
    habit: dict[str, Any] | None = None


def read_verdicts(entry: MutableMapping[str, Arrays]) -> KeptVerdicts:
    """Read what an entry of the cache keeps; nothing where that is damaged."""
    try:
        plain = json.loads(entry["links"]["text"].tobytes())
        tables = {name: dict(plain[name]) for name in ("links", "verdicts", "evidence")}
        return KeptVerdicts(whole=plain["whole"], habit=plain["habit"], **tables)
    except (KeyError, TypeError, ValueError):
        return KeptVerdicts()


def write_verdicts(entry: MutableMapping[str, Arrays], known: KeptVerdicts) -> None:
    """Write what is kept to an entry of the cache."""
    plain = {name: getattr(known, name) for name in KeptVerdicts.__slots__}
    entry["links"] = {"text": np.frombuffer(json.dumps(plain).encode(), dtype=np.uint8)}


def encode_diagnosis(diagnosis: Diagnosis) -> dict[str, Any]:
    """Return a diagnosis as plain values, without its evidence."""
    plain = {name: getattr(diagnosis, name) for name in Diagnosis.__slots__ if name != "evidence"}
    mended = diagnosis.mended
    if mended is not None:
        plain["mended"] = [mended.mass, mended.com.tolist(), mended.tensor.tolist(), mended.rotation.tolist()]
    return plain


def encode_evidence(evidence: Evidence) -> dict[str, Any]:
    """Return the evidence of one link as plain values."""
    habits = [[*key, evidence.likelihoods[key], evidence.priors[key]] for key in evidence.likelihoods]
    return {"habits": habits, "sound": evidence.sound, "alternative": evidence.alternative}


def decode_evidence(plain: Mapping[str, Any]) -> Evidence:
    """Return the evidence of which these are the plain values."""
    return Evidence(
        likelihoods={(name, detail): likelihood for name, detail, likelihood, _ in plain["habits"]},
        priors={(name, detail): prior for name, detail, _, prior in plain["habits"]},
        sound=plain["sound"],
        alternative=plain["alternative"],
    )


def decode_diagnosis(plain: Mapping[str, Any]) -> Diagnosis:
    """Return the diagnosis, without its evidence, of which these are the plain values."""
    mended = plain["mended"]
    if mended is not None:
        mass, com, tensor, rotation = mended
        mended = DeclaredInertial(mass=mass, com=np.array(com), tensor=np.array(tensor), rotation=np.array(rotation))
    return Diagnosis(**{**plain, "mended": mended, "ruled_out": tuple(plain["ruled_out"])})
