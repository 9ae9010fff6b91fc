"""Densities in words: the material that one may be, and the unit in which a mass was typed that gives an impossible one."""

from __future__ import annotations

# kg/m³, the least and the greatest of each name, in ascending order. Elements and alloys: CRC Handbook of
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

# kg/m³ that CAD programs give a part without a material.
CAD_DEFAULT = 1000.0
# The least density in `MATERIALS`.
LIGHTEST = 15.0

# kg in one unit that a mass is typed in by mistake.
MASS_UNITS = {"grams": 1e-3, "milligrams": 1e-6, "pounds": 0.45359237, "tonnes": 1e3}
# The greatest density of an ordinary part: lead. Tungsten is rare.
DENSEST_PART = 12000.0
# Densities of whole parts, from a housing with air in it to one of lead. In a wider range almost any mass would fit some unit.
_PART_DENSITIES = (600.0, DENSEST_PART)


def describe_density(density: float) -> str:
    """Describe a density (kg/m³, positive) by its material, or by those that it lies between: ``2,700 kg/m³: aluminium``."""
    return f"{format_density(density)} kg/m³: {_name_material(density)}"


def format_density(density: float) -> str:
    """Format a density to three digits: ``2,700``, ``0.0123``, ``1.00e+09``."""
    rounded = float(f"{density:.3g}")
    if 100.0 <= rounded < 1e6:
        return f"{rounded:,.0f}"
    return f"{rounded:.3g}" if 1e-3 <= rounded < 1e6 else f"{rounded:.2e}"


def guess_mass_unit(density: float) -> tuple[str, float] | None:
    """Return the one unit of mass that explains an impossible density (kg/m³) if it was read as kilograms, and the density in
    that unit; None if no unit does, or several do."""
    readings = [(unit, density * kilograms) for unit, kilograms in MASS_UNITS.items()]
    plausible = [(unit, reading) for unit, reading in readings if is_part_density(reading)]
    return plausible[0] if len(plausible) == 1 else None


def is_part_density(density: float) -> bool:
    """Whether a whole part may have a density (kg/m³)."""
    return _PART_DENSITIES[0] <= density <= _PART_DENSITIES[1]


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
