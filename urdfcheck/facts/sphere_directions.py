"""Directions spread evenly over the sphere."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from urdfcheck.facts.arrays import Array

# The axes, both ways.
_AXES = np.concatenate((np.eye(3), -np.eye(3)))


@cache
def spread_directions(count: int) -> Array:
    """Return unit vectors (count, 3), spread evenly: a Fibonacci lattice."""
    place = np.arange(count) + 0.5
    height = 1.0 - 2.0 * place / count
    angle = math.pi * (1.0 + math.sqrt(5.0)) * place
    across = np.sqrt(1.0 - height**2)
    return np.column_stack((across * np.cos(angle), across * np.sin(angle), height))


@cache
def spread_directions_and_axes(count: int) -> Array:
    """Return the directions of the axes, both ways, and ``count`` more unit vectors (count + 6, 3), spread evenly."""
    return np.concatenate((_AXES, spread_directions(count)))
