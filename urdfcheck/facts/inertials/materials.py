"""Densities in words: which material it may be, and in which unit a mass was typed that gives none."""

from __future__ import annotations

# kg/m³, from the least to the greatest that goes by the name, in ascending order. Elements and alloys: CRC Handbook of
# Chemistry and Physics, sections 4 and 15; plastics, foams and woods: makers' data sheets.
MATERIALS: tuple[tuple[str, float, float], ...] = (
    ("foam", 15, 120),
    ("light wood", 121, 350),
    ("wood", 400, 750),
    ("polypropylene or polyethylene", 895, 970),
    ("water, or a CAD system's default for a part without a material", 995, 1005),
    ("plastic (ABS, nylon, PLA)", 1020, 1300),
    ("acetal", 1390, 1430),
    ("carbon fibre composite", 1500, 1650),
    ("magnesium", 1740, 1830),
    ("aluminium", 2640, 2840),
    ("titanium", 4400, 4550),
    ("zinc", 6600, 7140),
    ("cast iron", 7150, 7300),
    ("steel", 7700, 8050),
    ("brass", 8400, 8730),
    ("copper", 8850, 8970),
    ("lead", 11300, 11400),
    ("tungsten alloy", 17000, 19300),
)
# The densest element, osmium, at room temperature (CRC Handbook), and the air at sea level.
DENSEST = 22590.0
AIR = 1.2

# The least of what is called a material above.
LIGHTEST = 15.0

# kg in one unit that a mass is typed in by mistake.
MASS_UNITS = {"grams": 1e-3, "milligrams": 1e-6, "pounds": 0.45359237, "tonnes": 1e3}
# What a part as a whole has, from a housing with air in it to one of lead. With a wider range almost any mass is some unit.
_PART_DENSITIES = (600.0, 12000.0)


def describe_density(density: float) -> str:
    """A density (kg/m³, positive) with the material that it is, or what it lies between: ``2,700 kg/m³: aluminium``."""
    return f"{format_density(density)} kg/m³: {_name_material(density)}"


def format_density(density: float) -> str:
    """A density as one writes it, to three digits: ``2,700``, ``0.0123``, ``1.00e+09``."""
    rounded = float(f"{density:.3g}")
    if 100.0 <= rounded < 1e6:
        return f"{rounded:,.0f}"
    return f"{rounded:.3g}" if 1e-3 <= rounded < 1e6 else f"{rounded:.2e}"


def guess_mass_unit(density: float) -> tuple[str, float] | None:
    """The one unit of mass whose reading as kilograms explains an impossible density (kg/m³), and the density that the
    mass then gives; None when no unit does, or several do."""
    readings = [(unit, density * kilograms) for unit, kilograms in MASS_UNITS.items()]
    plausible = [(unit, reading) for unit, reading in readings if _PART_DENSITIES[0] <= reading <= _PART_DENSITIES[1]]
    return plausible[0] if len(plausible) == 1 else None


def _name_material(density: float) -> str:
    if density > DENSEST:
        return f"denser than any material (osmium has {DENSEST:,.0f})"
    if density < AIR:
        return "lighter than air"
    for name, least, greatest in MATERIALS:
        if least <= density <= greatest:
            return name
    lighter = [name for name, _, greatest in MATERIALS if greatest < density]
    denser = [name for name, least, _ in MATERIALS if least > density]
    if not lighter:
        return f"lighter than {denser[0]}"
    if not denser:
        return f"denser than {lighter[-1]}"
    return f"between {lighter[-1].split(',')[0]} and {denser[0].split(',')[0]}"
