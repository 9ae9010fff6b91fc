"""INR007 reports placeholder masses and inertia tensors: round numbers that make a program accept the file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from urdfcheck.core import Edit, Finding, Located, Rule, Span
from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia
from urdfcheck.facts.inertials.placeholders import describe_placeholder, is_round
from urdfcheck.model import Link, Model
from urdfcheck.model.inertials.inertial_hull import NEGLIGIBLE_SHARE, compute_body_shares, is_massless_frame
from urdfcheck.model.parts import Inertial
from urdfcheck.model.repairs.inertial_edits import propose_from_geometry
from urdfcheck.model.rigid_bodies import list_rigid_bodies
from urdfcheck.model.shapes.visual_solid import has_drawn_shape, has_unit_ambiguity, measure_link_geometry

# Masses are compared with what is drawn where this many links have one.
_FEWEST = 4
# A tensor that links of this many different masses share belongs to none of them, whatever they look like.
_FEWEST_MASSES = 3


@dataclass(frozen=True, slots=True, eq=False)
class _PlaceholderInertial:
    """A link with a tensor that looks typed. ``factor``: how far the principal moment that fits worst is from the one,
    ``expected`` (kg m²), of a uniform solid of the link's mass that fills what it draws; None where that is not known."""

    link: Link
    inertial: Inertial
    description: str
    factor: float | None
    expected: float | None


def check(model: Model, rule: Rule, *, factor: float, fraction: float, spread: float) -> Iterator[Finding]:
    groups: dict[tuple[object, ...], list[_PlaceholderInertial]] = {}
    for suspect in _iter_placeholders(model):
        span = suspect.inertial.location.span
        groups.setdefault((suspect.inertial.inertia_components, span and span.file), []).append(suspect)
    for group in groups.values():
        wrong = [s for s in group if s.factor is not None and s.factor > factor]
        unknown = [s for s in group if s.factor is None]
        if wrong or len({s.inertial.mass for s in unknown}) >= _FEWEST_MASSES:
            alike = len({s.inertial.mass for s in group}) < _FEWEST_MASSES
            # Parts of all sizes have one number: that it is near to what one of them has is chance.
            known = [s for s in group if s.factor is not None] if wrong else []
            yield _build_group_finding(model, rule, known, [] if alike else unknown)
    yield from _check_equal_masses(model, rule, fraction, spread)


def _iter_placeholders(model: Model) -> Iterator[_PlaceholderInertial]:
    for body in list_rigid_bodies(model):
        typed = {
            name: what for name in body.links if (what := _describe_placeholder(model.link_by_name[name])) is not None
        }
        shares = compute_body_shares(model, body.links) if typed else {}
        for name, what in typed.items():
            link = model.link_by_name[name]
            inertial = link.inertial
            if inertial is None or name not in shares or shares[name][1] < NEGLIGIBLE_SHARE:
                continue
            # Where programs disagree about the size of a mesh (MSH008), the tensor must fit neither.
            units = (True, False) if has_unit_ambiguity(model, (name,)) else (True,)
            factor, expected = min(
                (f for unit in units if (f := _measure_misfit(model, link, inertial, unit)) is not None),
                default=(None, None),
            )
            yield _PlaceholderInertial(link, inertial, what, factor, expected)


def _describe_placeholder(link: Link) -> str | None:
    inertial = link.inertial
    if inertial is None or inertial.mass is None or inertial.inertia_components is None or is_massless_frame(link):
        return None
    return describe_placeholder(inertial.mass, inertial.inertia_components)


def _measure_misfit(model: Model, link: Link, inertial: Inertial, unit: bool) -> tuple[float, float] | None:
    """The largest factor between principal moments of the tensor and of a solid, and that of the solid (kg m²)."""
    drawn = measure_link_geometry(model, link, apply_unit=unit) if has_drawn_shape(link) else None
    if drawn is None or inertial.mass is None or inertial.tensor is None:
        return None
    declared = np.linalg.eigvalsh(inertial.tensor)
    expected = np.maximum(np.linalg.eigvalsh(compute_solid_inertia(drawn.solid, inertial.mass)), 1e-300)
    with np.errstate(over="ignore"):
        factors = np.maximum(declared / expected, expected / declared)
    worst = int(factors.argmax())
    return (float(factors[worst]), float(expected[worst])) if np.isfinite(factors[worst]) else None


def _build_group_finding(
    model: Model, rule: Rule, wrong: Sequence[_PlaceholderInertial], unknown: Sequence[_PlaceholderInertial]
) -> Finding:
    """One finding for all links that were given one tensor."""
    every = [*wrong, *unknown]
    worst = max(wrong, key=lambda s: s.factor or 0.0, default=None)
    places: list[Located] = [s.inertial.tensor_element or s.inertial for s in every]
    masses = sorted({s.inertial.mass or 0.0 for s in every})
    data: dict[str, Any] = {
        "links": join_names([s.link.name for s in every]),
        "have": "has" if len(every) == 1 else "have",
        "what": every[0].description,
        "names": [s.link.name for s in every],
    }
    if worst is None:
        masses_text = f"{masses[0]:.3g} to {masses[-1]:.3g} kg"
        finding = rule.finding("shared", at=places[0], related=places[1:], masses=masses_text, **data)
    else:
        assert worst.expected is not None
        assert worst.factor is not None
        finding = rule.finding(
            "placeholder",
            at=places[0],
            related=places[1:],
            edits=_propose_edits(model, every),
            link=worst.link.name,
            mass=worst.inertial.mass,
            factor=float(f"{worst.factor:.2g}"),
            expected=float(f"{worst.expected:.2g}"),
            less="less" if worst.expected < max(worst.inertial.inertia_components or (0.0,)) else "more",
            **data,
        )
    return replace(finding, subjects=tuple(dict.fromkeys(p.location.subject for p in places)))


def _propose_edits(model: Model, suspects: Sequence[_PlaceholderInertial]) -> tuple[Edit, ...]:
    """The inertia of what each link draws; nothing unless all are known, and one text need not say two things."""
    edits: dict[Span, Edit] = {}
    for suspect in suspects:
        drawn = propose_from_geometry(model, suspect.link)
        if drawn is None or not drawn.edits:
            return ()
        if any(edits.setdefault(edit.span, edit) != edit for edit in drawn.edits):
            return ()
    return tuple(edits.values())


def _check_equal_masses(model: Model, rule: Rule, fraction: float, spread: float) -> Iterator[Finding]:
    """One round mass for links of all sizes."""
    heavy = [link for link in model.links if link.inertial is not None and (link.inertial.mass or 0.0) > 0]
    counts = Counter(link.inertial.mass for link in heavy if link.inertial is not None)
    mass, count = counts.most_common(1)[0] if counts else (None, 0)
    if mass is None or not is_round(mass) or count < max(_FEWEST, fraction * len(heavy)):
        return
    alike = [link for link in heavy if link.inertial is not None and link.inertial.mass == mass]
    readings = []
    for unit in (True, False):
        drawn = [
            (link, g.solid.volume)
            for link in alike
            if (g := measure_link_geometry(model, link, apply_unit=unit)) is not None
        ]
        readings.append(sorted(drawn, key=lambda pair: pair[1]))
    # Where programs disagree about the size of a mesh (MSH008), both have to agree about this.
    if any(len(r) < _FEWEST or r[-1][1] < spread * r[0][1] for r in readings):
        return
    (small, least), *_, (large, most) = readings[0]
    places: list[Located] = [i.mass_attribute or i for link in alike if (i := link.inertial) is not None]
    finding = rule.finding(
        "mass",
        at=places[0],
        related=places[1:],
        count=count,
        total=len(heavy),
        mass=mass,
        small=small.name,
        large=large.name,
        ratio=float(f"{most / least:.2g}"),
    )
    # It is about the robot: what else is wrong with one of the links is not told by it.
    yield replace(finding, subjects=(model.location.subject,))
