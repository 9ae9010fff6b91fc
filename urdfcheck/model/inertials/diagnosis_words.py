"""What the diagnosis of an inertial says in words: what is wrong, by how much, and how well its undoing fits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core.text import format_length, join_names, join_numbers
from urdfcheck.facts.inertials.certainty import EXACT, FAR
from urdfcheck.facts.inertials.inertia_tensor import (
    compute_mass_covariance,
    compute_principal_moments,
    compute_solid_inertia,
)
from urdfcheck.facts.inertials.mistakes.mixing_mistakes import ABOUT_ORIGIN, TENSOR_ALONE
from urdfcheck.facts.median import compute_medians
from urdfcheck.model import Link, Model
from urdfcheck.model.inertials.inertia_diagnosis import DiagnosedInertial, inertial_diagnoses
from urdfcheck.model.inertials.inertial_effects import APPROXIMATIONS, SIMILAR, measure_difference
from urdfcheck.model.inertials.proposals.mistake_names import describe_mistake, name_mistake
from urdfcheck.model.shapes.visual_solid import (
    DRAWN_PART,
    OPEN_HULL,
    describe_geometry_source,
    measure_link_geometry,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Array
    from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial, VisualGeometry

    Moments = NDArray[np.floating[Any]]

# The body may be a thin shell, its hull or box may have been easier to compute, and a decorative piece may have been left out:
# such causes are worth knowing and rarely harmful. So is rounding, which leaves a possible tensor here.
MILD_CAUSES = APPROXIMATIONS | {"rounded"}
# Causes after which the numbers come from the drawn part, so that they agree with it by construction.
FROM_DRAWING = MILD_CAUSES | {"own_missing", "com_missing"}
# What agrees where the pieces of a part were taken for points.
_POINTLIKE = "the tensor is the drawn part's: what is written is the parallel-axis terms of its bodies, to within 5 %"
# What typed digits and tessellation leave of equal numbers.
DIGITS = 0.01
# A tenth of a radius of gyration, or of a second moment, is worth saying.
NOTABLE = 0.1
# Moments that are wrong by less than this are told one by one where they are wrong by different factors.
_SAME_SIZE = 10.0
# Moments whose factors are this near are wrong alike.
_AS_WRONG = 0.9
# All second moments below this part of the drawn part's are those of a smaller part.
_MUCH_LESS = 0.25
# Moments so many times too small are those of no shape like the drawn one.
_NO_SHAPE = 100.0
# A tensor so many times farther off than its principal moments is about other axes.
_ROTATED = 1.5
# A tensor that stays farther off than this share of its distance shows the mistake by its signs or axes, not by that number
# (chosen).
_BETTER = 0.8
# A tensor that is so many times farther off than the median is named beside it (chosen).
_MUCH_FARTHER = 5.0
# What a link is compared with, in the few words of a headline.
_SHORT_SOURCES = {DRAWN_PART: "the drawn one", OPEN_HULL: "the hull of its mesh"}
_OWNERS = {DRAWN_PART: DRAWN_PART, OPEN_HULL: "its hull"}
# Causes that make a tensor too large or too small as a whole.
SIZE_CAUSES = frozenset(
    {
        *(
            "inertia_unit",
            "about_origin",
            "positive_notation",
            "steiner_twice",
            "steiner_missing",
            "own_missing",
            "other_mass",
        ),
        *("wrong_formula", *MILD_CAUSES),
    },
)
# What a headline calls the numbers that are wrong; for any other cause, the inertia.
FAULTY_NUMBERS = {
    "mass_unit": "mass",
    "com_missing": "COM",
    "com_unit": "COM",
    "units": "units",
    "decimal_point": "number",
    "mesh_frame": "COM",
    "quarter_turn": "COM and inertia",
    "unmirrored": "COM and inertia",
}
# A cause in the few words of a headline.
SHORT_CAUSES = {
    "inertia_unit": "{detail}, not kg·m²",
    "mass_unit": "{detail}, not kg",
    "com_missing": "COM left at zero",
    "com_unit": "{detail}, not m",
    "units": "{detail}",
    "about_origin": "about the origin, not the COM",
    "positive_notation": "at the origin, CAD signs",
    "steiner_twice": "parallel-axis term twice",
    "steiner_missing": "no parallel-axis term",
    "own_missing": "own tensors of the pieces left out",
    "mesh_frame": "the mesh's own, without its <origin>",
    "one_piece": "one piece only",
    "products_sign": "products have flipped signs",
    "axes_permuted": "its x y z are {detail}",
    "slots_swapped": "{detail} swapped",
    "slots_shifted": "{detail}",
    "quarter_turn": "rotated by {detail}",
    "unmirrored": "not mirrored",
    "rpy_missing": "rpy left out",
    "rpy_twice": "rpy applied twice",
    "diagonal_first": "diagonal typed first",
    "row_major": "matrix typed row by row",
    "one_sign": "sign of {detail} flipped",
    "decimal_point": "decimal point off: {detail}×",
    "rounded": "rounded to {detail}",
    "wrong_formula": "of {detail}",
    "shell": "hollow shell",
    "bounding_box": "bounding box",
    "convex_hull": "convex hull",
    "other_mass": "fits {detail}",
}


def describe_median_agreement(model: Model, links: Sequence[Link]) -> str:
    """Describe how much nearer the numbers of links are to those of the drawn parts when their mistake is undone."""
    if inertial_diagnoses(model)[links[0].name].diagnosis.cause == "own_missing":
        return _POINTLIKE
    shares, distances, farthest = [], [], (0.0, "")
    for link in links:
        judged, drawn = inertial_diagnoses(model)[link.name], measure_link_geometry(model, link)
        if judged.diagnosis.mended is None or drawn is None:
            continue
        pair = (judged.declared, judged.diagnosis.mended)
        shares.append([measure_difference(numbers, drawn) for numbers in pair])
        farthest = max(farthest, (shares[-1][0], link.name))
        distances.append([float(np.linalg.norm(numbers.com - drawn.solid.com)) for numbers in pair])
    if not shares:
        return "they agree better with the drawn parts"
    (before, after), (far, near) = compute_medians(shares), compute_medians(distances)
    claims = []
    if after < _BETTER * before:
        sources = dict.fromkeys(describe_geometry_source(model, link) for link in links)
        owner = f"{DRAWN_PART}'s" if list(sources) == [DRAWN_PART] else f"that of {' or '.join(sources)}"
        worst = f" ({farthest[1]}: {_format_share(farthest[0])})" if farthest[0] > _MUCH_FARTHER * before else ""
        claims.append(
            f"the median tensor is {_format_share(after)} off {owner} instead of {_format_share(before)}{worst}"
        )
    if near < 0.5 * far:
        claims.append(f"the median COM is {format_length(near)} off instead of {format_length(far)}")
    return " and ".join(claims) or "they agree better with the drawn parts"


def _format_share(share: float) -> str:
    if share < 1.0:
        return f"{100.0 * share:.2g} %"
    return f"{100.0 * share:.0f} %" if share < 10.0 else f"{float(f'{share:.3g}'):,.0f} times"


def describe_other_shape(model: Model, link: Link, judged: DiagnosedInertial) -> str:
    """Say for a headline what disagrees most: the COM, or the tensor, by the direction in which it misses the drawn one most."""
    drawn, declared, source = measure_link_geometry(model, link), judged.declared, describe_geometry_source(model, link)
    if drawn is None:
        return f"inertia does not fit {source}"
    which = _SHORT_SOURCES.get(source, "its collision shape")
    moments, uniform = (
        np.linalg.eigvalsh(t) for t in (declared.inertia, compute_solid_inertia(drawn.solid, declared.mass))
    )
    is_similar = bool(((moments < SIMILAR * uniform) & (uniform < SIMILAR * moments)).all())
    is_off = judged.diagnosis.com_mismatch > (NOTABLE if is_similar else judged.diagnosis.tensor_mismatch)
    if is_off and shows_com(judged.diagnosis.com_mismatch, drawn):
        return f"COM {format_length(float(np.linalg.norm(declared.com - drawn.solid.com)))} from that of {source}"
    if moments.sum() > SIMILAR * uniform.sum() or uniform.sum() >= _NO_SHAPE * moments.sum():
        return compare_sizes(*_pair_moments(declared, drawn), "{inertia} {factor}× too {size}", digits=2)
    variances, axes = np.linalg.eigh(drawn.solid.covariance)  # along the drawn part's axes, the longest last
    along = np.diag(axes.T @ compute_mass_covariance(declared.inertia, declared.mass) @ axes) / variances
    if along.max() < _MUCH_LESS:
        return f"inertia fits a far smaller part than {which}"
    least = int(along.argmin())
    is_rod = variances[1] < 0.5 * variances[2]
    word = "thinner" if least == 0 else "shorter" if least == 2 and is_rod else "narrower"
    return f"inertia fits a far {word} part than {which}"


def shows_com(mismatch: float, drawn: VisualGeometry) -> bool:
    """Whether a COM is wrong whose ``mismatch`` is so great: the hull of an open mesh only shows that it is far away."""
    return drawn.closed or mismatch > FAR


def leaves_tensor(judged: DiagnosedInertial, drawn: VisualGeometry | None) -> bool:
    """Whether the tensor is hardly nearer to the drawn part's when the mistake is undone, and does not fit it then."""
    diagnosis = judged.diagnosis
    if diagnosis.mended is None or drawn is None or diagnosis.mended_tensor_mismatch < NOTABLE:
        return False
    before, after = (measure_difference(numbers, drawn) for numbers in (judged.declared, diagnosis.mended))
    return after > _BETTER * before


def collect_cause_data(cause: str, detail: str) -> dict[str, str]:
    """Return what the sentences about a cause need, whether one link has it or most of a file."""
    return {
        "detail": detail,
        "mistake": describe_mistake(cause, detail),
        "mirrored": _describe_mirrored(detail) if cause == "unmirrored" else "",
        "upward": "" if "about z" in detail else ", as when a program with another upward axis exported them",
    }


def collect_message_data(
    model: Model, link: Link, judged: DiagnosedInertial, *, is_certain: bool = False
) -> dict[str, Any]:
    """Collect the data of a finding about one inertial; ``is_certain``: the edit brings exactly the drawn part's numbers."""
    declared, diagnosis = judged.declared, judged.diagnosis
    drawn = measure_link_geometry(model, link)
    source = describe_geometry_source(model, link)
    moments, _ = compute_principal_moments(declared.inertia)
    expected = measured = size = apart = ""
    if drawn is not None:
        uniform, _ = compute_principal_moments(compute_solid_inertia(drawn.solid, declared.mass))
        expected = join_numbers(uniform, digits=3)
        mismatch = (diagnosis.tensor_mismatch, diagnosis.com_mismatch)
        measured = _describe_mismatch(declared, drawn, mismatch=mismatch, moments=moments, uniform=uniform)
        size = compare_sizes(*_pair_moments(declared, drawn), "{inertia} {factor}× too {size}", digits=2)
        apart = format_length(float(np.linalg.norm(declared.com - drawn.solid.com)))
    cause = diagnosis.cause or ""
    if cause == "com_missing" and apart and source != DRAWN_PART:
        measured = f"the COM is {apart} off"  # a shape that stands for the part is no measure of its tensor
    is_com_alone = cause == "unmirrored" and leaves_tensor(judged, drawn)
    faulty = "COM" if is_com_alone else name_faulty_numbers(cause, diagnosis.detail)
    doubted = f"{'wrong' if is_certain else 'suspect'} {faulty}"
    return {
        "link": link.name,
        **collect_cause_data(cause, diagnosis.detail),
        **({"mirrored": _describe_mirrored_com(diagnosis.detail)} if is_com_alone else {}),
        "why": SHORT_CAUSES.get(cause, "").format(detail=diagnosis.detail),
        "fault": _describe_fault(cause, size=size, apart=apart) or doubted,
        "fault_short": doubted,  # the cause says more than how far off the numbers are
        "source": source,
        "off": f", {apart} from {_OWNERS.get(source, 'the shape')}'s" if apart else "",
        "apart": apart,
        "twins": join_names(judged.twins),
        "mass": f"{declared.mass:g}",
        "moments": join_numbers(moments, digits=3),
        "expected": expected,
        "measured": measured,
        # One macro line makes many links, each with its own numbers and one mistake: these do not tell findings apart.
        "mismatch": {
            "tensor": diagnosis.tensor_mismatch,
            "com": diagnosis.com_mismatch,
            "mended_tensor": diagnosis.mended_tensor_mismatch,
            "mended_com": diagnosis.mended_com_mismatch,
        },
        "agree": _describe_agreement(judged, drawn),
        "ruled_out": format_ruled_out(judged),
    }


def _describe_fault(cause: str, *, size: str, apart: str) -> str:
    """Say for a headline what is wrong by the number that shows it, empty where none does; ``apart``: how far the COM is from the
    drawn part's."""
    if cause == "com_unit" and apart:
        return f"COM {apart} off"
    return size if cause in SIZE_CAUSES else ""


def _describe_mirrored(detail: str) -> str:
    """Say which numbers are those of the mirror image. A tensor is the same mirrored across an axis and rotated about it."""
    image = f"the mirror image of the part, across the link's {detail.partition(',')[0]} axis"
    if detail.endswith(TENSOR_ALONE):
        return f"The tensor fits {image}, or the part rotated by 180° about it"
    return f"COM and tensor fit {image}, as if copied from the other side"


def _describe_mirrored_com(detail: str) -> str:
    """Say that the COM alone is that of the mirror image: the tensor is wrong in another way."""
    axis = detail.partition(",")[0]
    return f"The COM fits the mirror image of the part, across the link's {axis} axis: a sign is wrong. The tensor fits neither"


def name_faulty_numbers(cause: str, detail: str) -> str:
    """Name the numbers that are wrong, for a headline."""
    if detail.endswith(TENSOR_ALONE):
        return "inertia"
    if detail == ABOUT_ORIGIN:
        return "COM and inertia"
    return "COM" if detail.startswith("com ") else FAULTY_NUMBERS.get(cause, "inertia")


def _describe_agreement(judged: DiagnosedInertial, drawn: VisualGeometry | None) -> str:
    """Describe how near the numbers are to those of the drawn part when the mistake is undone."""
    diagnosis = judged.diagnosis
    residual, mended = max(diagnosis.mended_tensor_mismatch, diagnosis.mended_com_mismatch), diagnosis.mended
    if diagnosis.com_order:
        return f"the tensor agrees, and the COM does with its x y z as {diagnosis.com_order}"
    if diagnosis.cause == "own_missing":
        return _POINTLIKE
    if residual < EXACT:
        return f"the two agree to within {max(1.0, 100 * residual):.0f} %"
    if mended is None or drawn is None:
        return "the two agree better"
    left = []
    is_own = diagnosis.cause not in FROM_DRAWING
    if is_own and diagnosis.mended_com_mismatch < diagnosis.com_mismatch - DIGITS:
        apart = format_length(float(np.linalg.norm(mended.com - drawn.solid.com)))
        left.append("the COM agrees" if diagnosis.mended_com_mismatch < DIGITS else f"the COM is {apart} off")
    before, after = (measure_difference(numbers, drawn) for numbers in (judged.declared, mended))
    if is_own and diagnosis.mended_tensor_mismatch < diagnosis.tensor_mismatch - DIGITS and after < before:
        falls = f"the tensor is {_format_share(after)} off instead of {_format_share(before)}"
        left.append("the tensor agrees" if diagnosis.mended_tensor_mismatch < DIGITS else falls)
    apart = format_length(float(np.linalg.norm(judged.declared.com - drawn.solid.com)))
    if not is_own and diagnosis.com_mismatch > NOTABLE:
        return f"the tensor agrees, and the COM stays {apart} off"
    # What the mistake does not explain is another one, or a motor.
    size = compare_sizes(*_pair_moments(mended, drawn), "{moments} still {factor} times too {size}", digits=3)
    if left and diagnosis.mended_com_mismatch == diagnosis.com_mismatch > NOTABLE and shows_com(NOTABLE, drawn):
        left.append(f"the COM stays {apart} off")
    elif left and diagnosis.mended_tensor_mismatch == diagnosis.tensor_mismatch and size:
        left.append(size)
    return ", and ".join(left) or "the two agree better"


def format_ruled_out(judged: DiagnosedInertial) -> str:
    return join_names(map(name_mistake, judged.diagnosis.ruled_out))


def _describe_mismatch(
    numbers: DeclaredInertial,
    drawn: VisualGeometry,
    *,
    mismatch: tuple[float, float],
    moments: Array,
    uniform: Array,
) -> str:
    """Describe how numbers differ from those of the drawn part, whose principal moments are ``uniform``; ``mismatch``: of the
    tensor and of the COM."""
    differences = []
    of_tensor, of_com = mismatch
    apart = float(np.linalg.norm(numbers.com - drawn.solid.com))
    if of_com > NOTABLE and shows_com(of_com, drawn):
        differences.append(f"the COM is {format_length(apart)} off")
    size = compare_sizes(*_pair_moments(numbers, drawn), "{moments} {factor} times too {size}", digits=3)
    shape = _measure_shape_mismatch(moments, uniform)
    if size:
        differences.append(f"{size} for this mass at uniform density")
    elif of_tensor > max(NOTABLE, _ROTATED * shape) and measure_difference(numbers, drawn) > NOTABLE:
        differences.append("the inertia tensor is about other axes")
    elif of_tensor > NOTABLE < _ROTATED * shape:  # a tilt of a tenth of a degree makes a mismatch of a thin part
        actual, expected = join_numbers(moments, digits=3), join_numbers(uniform, digits=3)
        differences.append(f"the principal moments are {actual} instead of {expected} kg·m²")
    return " and ".join(differences) or "the inertial is only slightly off"


def _pair_moments(declared: DeclaredInertial, drawn: VisualGeometry) -> tuple[Moments, Moments]:
    """Return the principal moments (3,) of an inertial and those of the drawn part at its mass: of each axis if both tensors have
    the same axes, which equal moments leave open; else each ascending."""
    tensors = (declared.inertia, compute_solid_inertia(drawn.solid, declared.mass))
    each = [compute_principal_moments(tensor) for tensor in tensors]
    for _, axes in each:
        about = [axes.T @ tensor @ axes for tensor in tensors]
        if all(np.abs(one - np.diag(np.diag(one))).max() <= DIGITS * np.abs(one).max() for one in about):
            return np.diag(about[0]), np.diag(about[1])
    return each[0][0], each[1][0]


def compare_sizes(moments: Moments, uniform: Moments, template: str, *, digits: int) -> str:
    """Say how much too large or too small three moments (3,) are; nothing if they are ``SIMILAR`` in size. If they are wrong
    by different factors, it is the one, or the two, wrong most, or how far they are off at most."""
    ratio = float(moments.sum() / uniform.sum())
    if 1 / SIMILAR < ratio < SIMILAR:
        return ""
    is_large, exact = ratio > 1, max(ratio, 1 / ratio)
    factors = moments / uniform if is_large else uniform / np.maximum(moments, 1e-300)
    is_uneven = exact < _SAME_SIZE and float(factors.max()) > SIMILAR * float(factors.min())
    factor = float(f"{float(factors.max()) if is_uneven else exact:.{digits}g}")
    alike = int((factors > _AS_WRONG * factors.max()).sum())
    inertia, verb = "inertia", "the moments of inertia are"
    if is_uneven and int((factors > SIMILAR).sum()) > alike:  # the others are wrong as well, by less
        inertia, verb = "inertia up to", "the moments of inertia are up to"
    elif is_uneven:
        one = ("one moment", "one moment of inertia is")
        inertia, verb = one if alike == 1 else ("two moments", "two moments of inertia are")
    return template.format(
        inertia=inertia,
        moments=verb,
        factor=f"{factor:,.0f}" if 100 <= factor < 1e6 else f"{factor:g}",
        size="large" if is_large else "small",
    )


def _measure_shape_mismatch(moments: Array, uniform: Array) -> float:
    """Return how far principal moments (3,) are from others as the mismatch of a tensor is, the axes of the two aside."""
    first, other = (np.maximum(m.sum() / 2 - m, 1e-6 * m.sum()) for m in (moments, uniform))
    return float(np.linalg.norm(np.log(first / other)))
