"""Densities in words, and the unit that a mass was typed in."""

from __future__ import annotations

from itertools import pairwise

import pytest

from urdfcheck.facts.inertials.materials import MATERIALS, describe_density, guess_mass_unit


@pytest.mark.parametrize(
    ("density", "words"),
    [
        (2700, "2,700 kg/m³: aluminium"),
        (7850, "7,850 kg/m³: steel"),
        (1000.4, "1,000 kg/m³: water, or a CAD system's default for a part without a material"),
        (1240, "1,240 kg/m³: plastic (ABS, nylon, PLA)"),
        (3800, "3,800 kg/m³: between aluminium and titanium"),
        (980, "980 kg/m³: between polypropylene or polyethylene and water"),
        (21000, "21,000 kg/m³: denser than tungsten alloy"),
        (22600, "22,600 kg/m³: denser than any material (osmium has 22,590)"),
        (1.002e9, "1.00e+09 kg/m³: denser than any material (osmium has 22,590)"),
        (5, "5 kg/m³: lighter than foam"),
        (0.0123, "0.0123 kg/m³: lighter than air"),
    ],
)
def test_a_density_in_words(density: float, words: str) -> None:
    assert describe_density(density) == words


def test_materials_are_in_order_and_do_not_overlap() -> None:
    assert all(least < greatest for _, least, greatest in MATERIALS)
    assert all(before[2] < after[1] for before, after in pairwise(MATERIALS))


@pytest.mark.parametrize(
    ("density", "unit"),
    [
        (2.7e6, "grams"),
        (1.002e9, "milligrams"),
        (24000, "pounds"),
        (2.7, "tonnes"),
        (5e4, None),  # no unit gives what a part can have
        (6.5e5, "grams"),
        (5.9e5, None),
    ],
)
def test_the_unit_of_a_mass_is_named_when_only_one_gives_a_density(density: float, unit: str | None) -> None:
    found = guess_mass_unit(density)
    assert (None if found is None else found[0]) == unit
