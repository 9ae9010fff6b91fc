"""The robot set on a plane at its lowest point, and let go in a simulator."""

from __future__ import annotations

import math
import re

import numpy as np

from urdfcheck.core import Unavailable
from urdfcheck.core import drop_test as drop
from urdfcheck.core.drop_test import Curve, Drop, Release, Touching
from urdfcheck.facts.motion.simulation import GRAVITY, WINDOW, Motion, Refused, Simulation, Touch, sinking
from urdfcheck.model.motion.mechanism import Standing, standing
from urdfcheck.model.robot import Model

# Between a stable and an unstable step so many more are tried: the largest is then known to 4 %.
_HALVINGS = 4
_BODY = re.compile(r"\bb(\d+)\b")


def dropped(model: Model) -> Drop:
    """Let go for two seconds, with zero and with holding torques, and with zero torques at other time steps.

    :raises Unavailable: when MuJoCo is not installed or refuses the model, or when the tree, a shape or a mass is not known.
    """
    one = standing(model)
    try:
        return _dropped(one, Simulation(one.mechanism, one.ground))
    except ImportError:
        raise Unavailable("MuJoCo is not installed: pip install 'urdfcheck[engines]'") from None
    except Refused as reason:
        named = _BODY.search(reason.element)
        link = f", link {one.heads[int(named[1])]!r}" if named is not None else ""
        raise Unavailable(f"MuJoCo refuses the model: {reason}{link}") from None


def _dropped(one: Standing, simulation: Simulation) -> Drop:
    slow = drop.SLOW * math.sqrt(GRAVITY * one.size)
    free, held = (_release(one, simulation, slow, drop.SECONDS, held=held) for held in (False, True))
    damped = any(body.hinge.damping for body in one.mechanism.bodies)
    return Drop(
        model="",
        simulator=f"MuJoCo {simulation.version}",
        fixed=one.fixed,
        drawn=one.drawn,
        ground=one.ground,
        size=one.size,
        mass=simulation.weight / GRAVITY,
        slow=slow,
        soft=sinking(),
        unlimited=tuple(
            joint.name
            for joint, body in zip(one.joints, one.mechanism.bodies, strict=True)
            if joint is not None and body.hinge.effort is not None and not math.isfinite(body.hinge.effort)
        ),
        free=free,
        held=held,
        later=_release(one, simulation, slow, drop.LATER, held=True) if held.restless else None,
        curves=tuple(_curve(one, simulation, implicit=implicit) for implicit in ((True, False) if damped else (True,))),
    )


def _release(one: Standing, simulation: Simulation, slow: float, seconds: float, *, held: bool) -> Release:
    motion = simulation.run(seconds, drop.STEP, held=held)
    gain, change = _energy(one, simulation, motion)
    burst = motion.burst is not None
    driven = [place for place, body in enumerate(one.mechanism.bodies) if body.hinge.effort is not None]
    worst = max(driven, key=lambda place: abs(motion.off[place]), default=None) if held and not burst else None
    loose = {place for place in range(len(one.heads)) if _loose(one, place)}
    return Release(
        held=held,
        burst=motion.burst,
        fastest=one.heads[motion.fastest],
        gain=gain,
        change=change,
        speed=None if burst else float(motion.speed[motion.time > motion.time[-1] - WINDOW].max()),
        moving=one.heads[motion.moving],
        settled=None if burst else _settled(motion, slow),
        tilt=None if burst else motion.tilt,
        touching=_touching(one, motion),
        saturated=tuple(joint.name for place in motion.saturated if (joint := one.joints[place]) is not None),
        sag=None if worst is None else abs(float(motion.off[worst])),
        sagging="" if worst is None or (joint := one.joints[worst]) is None else joint.name,
        rolls=motion.moving in loose or any(one.mechanism.geoms[touch.geom].body in loose for touch in motion.touching),
    )


def _settled(motion: Motion, slow: float) -> float | None:
    """Since when (s) nothing is faster than ``slow`` (m/s); None when something was in the last quarter of a second."""
    quick = np.flatnonzero(motion.speed > slow)
    if not len(quick):
        return 0.0
    last = int(quick[-1])
    return None if motion.time[last] > motion.time[-1] - WINDOW else float(motion.time[last + 1])


def _touching(one: Standing, motion: Motion) -> tuple[Touching, ...]:
    """What touches the ground, the shapes of one link together."""
    links: dict[str, list[Touch]] = {}
    for touch in motion.touching:
        links.setdefault(one.links[touch.geom], []).append(touch)
    return tuple(_together(link, group) for link, group in links.items())


def _together(link: str, group: list[Touch]) -> Touching:
    points = [touch.points for touch in group]
    x, y, z = np.average([touch.place for touch in group], axis=0, weights=points).tolist()
    return Touching(
        link,
        sum(points),
        (x, y, z),
        min(touch.lowest for touch in group),
        max(touch.depth for touch in group),
        sum(touch.load for touch in group),
    )


def _loose(one: Standing, place: int) -> bool:
    """Whether a joint that nothing holds lies between a body and the root."""
    while place >= 0:
        joint, body = one.joints[place], one.mechanism.bodies[place]
        if joint is not None and body.hinge.effort is None and joint.mimic is None:
            return True
        place = body.parent
    return False


def _curve(one: Standing, simulation: Simulation, *, implicit: bool) -> Curve:
    found: dict[float, tuple[float | None, float | None, bool]] = {}

    def stable(step: float) -> bool:
        motion = simulation.run(drop.SECONDS, step, held=False, implicit=implicit)
        gain, _ = _energy(one, simulation, motion)
        found[step] = None if gain is None else float(motion.speed.max()), gain, gain is not None and gain <= drop.GAIN
        return found[step][2]

    for step in drop.STEPS:
        stable(step)
    bad = next((step for step in drop.STEPS if not found[step][2]), None)
    if bad is not None and bad > drop.STEPS[0]:
        low = bad / 2.0
        for _ in range(_HALVINGS):
            middle = math.sqrt(low * bad)
            low, bad = (middle, bad) if stable(middle) else (low, middle)
    steps = tuple(sorted(found))
    speeds, gains, good = zip(*(found[step] for step in steps), strict=True)
    return Curve(implicit, steps, speeds, gains, good)


def _energy(one: Standing, simulation: Simulation, motion: Motion) -> tuple[float | None, float | None]:
    """By how much the energy rose above that at the beginning, and how it changed until the end; parts of weight times size."""
    if motion.burst is not None:
        return None, None
    scale = simulation.weight * one.size
    over = motion.energy - motion.energy[0]
    return max(0.0, float(over.max()) / scale), float(over[-1]) / scale
