"""One part at a time: every mistake is made in its numbers, diagnosed, and compared with what is true."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from geometry import drawn
from injections import KINDS, Array, Body, Case, Kind, declared, digits, truth
from parts import SPLITS, Part, part

from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial, VisualGeometry
from urdfcheck.facts.inertials.diagnosis import Diagnosis, diagnose_inertial

# How the diagnosis is asked: of parts of uniform density; with part of the mass in lumps; the same with the true numbers of
# an equal part beside it; and of a true part when it is that equal part's numbers that are wrong.
MODES = ("exact", "lumped", "twin", "blamed")
CLEAN = "clean"
# A mistake that changes less than this has no effect: a quarter turn of a ball, the signs of products that are zero.
LEAST_EFFECT = 0.15
# Mended numbers are right when mass, COM (in radii of gyration) and tensor (Frobenius norm) agree so well.
AGREE = 0.01
# Times that the numbers of a part are tried without a mistake, of each mode.
CLEAN_TIMES = 4


@dataclass(frozen=True)
class Outcome:
    """What became of one case.

    ``cause``: the named one. ``strict``: it is the mistake that was made; ``mended``: undoing it gives the true numbers;
    ``misled``: it is the mistake's name, and undoing it gives others. ``sound``: nothing was found; ``accused``: this part,
    not its twin, is said to be wrong.
    """

    kind: str
    mode: str
    part: str
    cause: str | None
    detail: str
    strict: bool
    mended: bool
    misled: bool
    sound: bool
    accused: bool

    @property
    def right(self) -> bool:
        """The cause is right, or equivalent: undoing it gives the true numbers."""
        return self.strict or self.mended

    @property
    def repaired(self) -> bool:
        """The cause is right, and what is said to be the true numbers are the true ones."""
        return self.right and not self.misled


@dataclass(frozen=True)
class Excluded:
    """A case that was not asked: the mistake has no effect on this part, or cannot be made in it (``possible``)."""

    kind: str
    mode: str
    possible: bool


def outcomes(
    split: str, seed: int, index: int, modes: Sequence[str] = MODES, families: Sequence[str] | None = None
) -> list[Outcome | Excluded]:
    """All cases of one part: see `parts.part`."""
    made, another = part(split, seed, index, families), part(split, seed, index + 1, families)
    shown, stream = drawn(made), (SPLITS.index(split), seed, index)
    return [outcome for mode in modes for outcome in _outcomes(made, shown, another, mode, stream)]


def _outcomes(
    made: Part, shown: Mapping[float, VisualGeometry], another: Part, mode: str, stream: tuple[int, ...]
) -> Iterator[Outcome | Excluded]:
    lumped = mode != "exact"
    for k, kind in enumerate((*KINDS, *(None,) * CLEAN_TIMES)):
        rng = np.random.default_rng((*stream, MODES.index(mode), k))
        true = truth(made, rng, lumped=lumped)
        case = Case(made, true, bool(rng.random() < 0.5), truth(another, rng, lumped=lumped).whole)
        numbers = case.clean if kind is None else kind.make(case, rng)
        name = CLEAN if kind is None else kind.name
        if numbers is None:
            yield Excluded(name, mode, possible=False)
            continue
        given, twin = declared(numbers, digits(rng)), declared(case.clean, digits(rng))
        if kind is not None and numbers.scale == 1.0 and _effect(kind, case, given) < LEAST_EFFECT:
            yield Excluded(name, mode, possible=True)
            continue
        if mode != "blamed":
            found = diagnose_inertial(given, shown[numbers.scale], twin if mode == "twin" else None)
        elif kind is None or numbers.scale != 1.0:
            continue
        else:
            found = diagnose_inertial(twin, shown[1.0], given)
        assert found is not None
        yield _outcome(name, kind, mode, made.name, found, true.whole)


def _outcome(name: str, kind: Kind | None, mode: str, part_name: str, found: Diagnosis, true: Body) -> Outcome:
    strict = found.cause is not None and kind is not None and found.cause in kind.names
    mended = found.mended is not None and agrees(found.mended, true)
    accused = not found.sound and found.at_fault
    misled = strict and not mended and found.mended is not None and kind is not None and not kind.lossy
    return Outcome(name, mode, part_name, found.cause, found.detail, strict, mended, misled, found.sound, accused)


def _effect(kind: Kind, case: Case, given: DeclaredInertial) -> float:
    """Of a mistake: against the truth, and of one that takes another body for the solid also against that."""
    against_truth = effect(case.truth.whole, given)
    return min(against_truth, effect(case.solid, given)) if kind.instead else against_truth


def effect(true: Body, given: DeclaredInertial) -> float:
    """How far numbers are from the true ones: mass (logarithm of the ratio), COM (in radii of gyration along each principal
    axis) and second moments per mass (log-Euclidean) together. Infinite for what no body has."""
    ratio = given.mass / true.mass
    if ratio <= 0:
        return float("inf")
    variances, axes = np.linalg.eigh(_covariance(true.mass, true.inertia))
    white = axes / np.sqrt(np.maximum(variances, 4e-4 * variances[-1])) @ axes.T
    logs = np.linalg.eigvalsh(white @ _covariance(given.mass, given.inertia) @ white)
    if logs[0] <= 0:
        return float("inf")
    return float(np.linalg.norm((np.log(ratio), *np.log(logs), *(white @ (given.com - true.com)))))


def agrees(given: DeclaredInertial, true: Body) -> bool:
    """Whether numbers are the true ones to within `AGREE`."""
    gyration = np.sqrt(np.trace(true.inertia) / (2 * true.mass))
    return bool(
        abs(given.mass / true.mass - 1) <= AGREE
        and np.linalg.norm(given.com - true.com) <= AGREE * gyration
        and np.linalg.norm(given.inertia - true.inertia) <= AGREE * np.linalg.norm(true.inertia)
    )


def _covariance(mass: float, inertia: Array) -> Array:
    per_mass = inertia / mass
    result: Array = 0.5 * np.trace(per_mass) * np.eye(3) - per_mass
    return result
