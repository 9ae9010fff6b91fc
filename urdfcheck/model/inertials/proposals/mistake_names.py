"""Mistakes of an ``<inertial>`` in two or three words."""

from __future__ import annotations

# Mistakes whose names say too little in a headline; the others are named by their ids.
_MISTAKE_NAMES = {
    "about_origin": "tensor about the origin",
    "axes_permuted": "axes of the tensor",
    "com_missing": "COM left at zero",
    "com_unit": "unit of the COM",
    "diagonal_first": "order of the numbers",
    "inertia_unit": "unit of the tensor",
    "mass_unit": "unit of the mass",
    "mesh_frame": "in the frame of the mesh",
    "one_piece": "one piece only",
    "one_sign": "one sign",
    "own_missing": "own tensors of the pieces left out",
    "positive_notation": "tensor about the origin, with products of the other sign",
    "products_sign": "signs of the products",
    "rounded": "rounding",
    "row_major": "order of the numbers",
    "rpy_missing": "rpy left out",
    "rpy_twice": "rpy applied twice",
    "slots_shifted": "shifted numbers",
    "slots_swapped": "swapped numbers",
    "steiner_missing": "parallel-axis theorem left out",
    "steiner_twice": "parallel-axis theorem applied twice",
    "unmirrored": "not mirrored",
    "wrong_formula": "formula of another solid",
}


def name_mistake(cause: str) -> str:
    """Return a cause of INR009 in two or three words."""
    return _MISTAKE_NAMES.get(cause, cause.replace("_", " "))


def describe_mistake(cause: str, detail: str) -> str:
    """Name a cause of INR009 in a few words, with its ``detail``."""
    name = name_mistake(cause)
    return f"{name}: {detail}{' times' if cause == 'decimal_point' else ''}" if detail else name
