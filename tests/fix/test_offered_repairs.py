"""After an offered repair the link passes its rules, MuJoCo takes its inertial, and nothing else is worse.

On made links, and on robots in the folders that ``URDFCHECK_CORPUS`` names: of those with a kind of offer, the first few;
all with ``URDFCHECK_FULL=1``, as with ``benchmarks/accuracy/repairs.py``.
"""

from __future__ import annotations

import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import arm_on_base
from castings import CASTING, MISTAKES, DeclaredInertial, drawn_boxes, format_inertial, geometry, slots, uniform
from conftest import REPOSITORY, check
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from real_robots import check_robots, get_robot_cache, list_requests, select_by_trait
from scipy.spatial.transform import Rotation

from urdfcheck.core import Finding
from urdfcheck.rules import load_rules

sys.path.append(str(REPOSITORY / "benchmarks" / "accuracy"))

from repairs import collect_offers, count_needless, describe_fault, try_offers

pytestmark = pytest.mark.slow

# INR013 writes the same body in other axes, in which another mistake may show; INR015 is about the mass of the robot, which here
# may be of any size.
CODES = {code for code in load_rules() if code.startswith("INR")} - {"INR013", "INR015"}
SLOTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def find(folder: Path, text: str) -> list[Finding]:
    """The findings about inertials."""
    (folder / "robot.urdf").write_text(text)
    return list(check(folder / "robot.urdf", codes=CODES).findings)


def repair(text: str, findings: list[Finding]) -> str:
    """The text after the edits that the findings offer."""
    edits = {edit for finding in findings if finding.fix is not None for edit in finding.fix.edits}
    for edit in sorted(edits, key=lambda edit: -edit.span.start):
        assert text[edit.span.start : edit.span.end] == edit.expected
        assert not count_needless(edit.expected, edit.replacement)
        text = text[: edit.span.start] + edit.replacement + text[edit.span.end :]
    return text


def compile_in_mujoco(text: str) -> None:
    """:raises ValueError: if it refuses the robot."""
    pytest.importorskip("mujoco").MjModel.from_xml_string(re.sub("<visual>.*?</visual>", "", text))


def write_tensor(six: list[str], mass: float = 1.0) -> str:
    typed = " ".join(f'{name}="{word}"' for name, word in zip(SLOTS, six, strict=True))
    return arm_on_base(f'<inertial><mass value="{mass:g}"/><inertia {typed}/></inertial>')


def check_offer(folder: Path, text: str) -> bool:
    """Whether an impossible tensor gets an edit; with it the tensor is possible."""
    findings = [finding for finding in find(folder, text) if finding.code in {"INR003", "INR004"}]
    if not any(finding.fix is not None and finding.fix.edits for finding in findings):
        return False
    mended = repair(text, findings)
    assert [f.code for f in find(folder, mended) if f.code in {"INR003", "INR004"}] == []
    compile_in_mujoco(mended)
    return True


directions = st.integers(0, 10_000).map(lambda seed: Rotation.random(random_state=seed).as_matrix())
UNMIRRORED = (
    next(mistake for mistake in MISTAKES if mistake[0] == "unmirrored"),
    np.array([[0.860053, 0.444647, 0.250194], [-0.25591, 0.800191, -0.542406], [-0.441382, 0.402472, 0.801996]]),
)
moments = st.tuples(st.floats(0.1, 1.0), st.floats(0.1, 1.0), st.floats(-5e-3, 5e-3), st.floats(1e-7, 1.0))


@settings(max_examples=25)
@given(directions, moments, st.integers(1, 7))
def test_a_plate_that_rounding_made_impossible(
    tmp_path_factory: pytest.TempPathFactory, axes: np.ndarray, numbers: tuple[float, ...], digits: int
) -> None:
    first, second, excess, scale = numbers
    tensor = scale * axes @ np.diag((first, second, (first + second) * (1 + excess))) @ axes.T
    six = [f"{tensor[i, j]:.{digits}g}" for i in range(3) for j in range(i, 3)]
    check_offer(tmp_path_factory.mktemp("plate"), write_tensor(six))


@pytest.mark.parametrize(
    "six",
    [
        ("9e-7", "0", "0", "2e-6", "0", "3e-6"),
        ("0.00118557", "0.000596133", "0.0011173", "0.00312162", "-2.05919e-05", "0.00289955"),
    ],
)
def test_the_nearest_tensor_is_offered_where_it_hardly_differs(tmp_path: Path, six: tuple[str, ...]) -> None:
    assert check_offer(tmp_path, write_tensor(list(six)))


def test_a_tensor_that_is_far_off_is_advice(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, write_tensor(["0.0100", "0", "0", "0.0200", "0", "0.0330"]))
    assert finding.fix is not None
    assert finding.fix.edits == ()
    assert finding.fix.title.startswith("compute the inertia tensor again")
    assert 'the nearest possible one is ixx="' in finding.fix.title
    assert "(4.5 % off)" in finding.fix.title


@settings(max_examples=15)
@given(st.floats(1e-6, 10.0), st.floats(1e-7, 1e3), st.booleans())
def test_products_that_were_filled_in(
    tmp_path_factory: pytest.TempPathFactory, moment: float, mass: float, is_ball: bool
) -> None:
    word = f"{moment:.3g}"
    six = [word, word, word, word if is_ball else f"{1.5 * moment:.3g}", word, word]
    folder = tmp_path_factory.mktemp("filled")
    assert check_offer(folder, write_tensor(six, mass)) or not is_ball


@settings(max_examples=25, deadline=None)
@given(
    st.sampled_from(MISTAKES),
    directions,
    st.floats(0.02, 5.0),
    st.floats(300.0, 8000.0),
    st.integers(5, 12),
    st.booleans(),
)
# The COM of a mirrored part is outside of it: the sign alone would leave a tensor about other axes.
@example(*UNMIRRORED, 1.0, 300.0, 5, True)
def test_an_undone_mistake_leaves_a_part_that_may_be(
    tmp_path_factory: pytest.TempPathFactory,
    mistake: tuple[str, str, object],
    axes: np.ndarray,
    size: float,
    density: float,
    digits: int,
    is_turned: bool,
) -> None:
    """A casting of any size and density, in a frame that may be turned, with one mistake."""
    blocks = [(np.array(edges) * size, np.array(place) * size) for edges, place in CASTING]
    drawn = geometry(blocks)
    true = uniform(drawn.solid, density * drawn.solid.volume)
    if is_turned:
        true = replace(true, tensor=axes.T @ true.tensor @ axes, rotation=axes)
    numbers = mistake[2](true, drawn)  # type: ignore[operator]
    assert isinstance(numbers, DeclaredInertial)
    assume(max(map(abs, slots(numbers))) > 1e-10)
    text = arm_on_base(format_inertial(numbers, digits), drawn_boxes(blocks))
    folder = tmp_path_factory.mktemp("casting")
    findings = find(folder, text)
    if not any(finding.fix is not None and finding.fix.edits for finding in findings):
        return
    mended = repair(text, findings)
    left = [f for f in find(folder, mended) if str(f.severity) != "info"]
    assert [(f.code, f.message) for f in left] == []
    compile_in_mujoco(mended)


# On how many robots of a folder an offer of a rule, message and cause is tried.
ROBOTS_OF_A_KIND = 2
# What comes with a repair, and is not its fault.
KNOWN = {
    # Ten links have placeholders for inertias; two of them are then reported by another rule as well.
    ("Daniella1/urdf_files_dataset:r2_left_forearm", "JNT013"),
    # One jaw's COM fits the drawn part with the other sign; the other jaw was hidden beside it and differs by 0.3 mm.
    ("AalborgUniversity-RoboticSurgeryGroup/davinci_description:needle_driver", "INR009"),
    # With the collision in its place, a COM and an inertia are seen to be outside of all geometry.
    ("Gepetto/example-robot-data:alex_nub_hands", "GEO005"),
    # The COM is written as the drawing proves it; the tensors of both sides still differ, and nothing shows which is wrong.
    ("Gepetto/example-robot-data:alex_psyonic_hands", "SYM004"),
    ("Gepetto/example-robot-data:talos_reduced", "SYM004"),
}


# -- real robots -------------------------------------------------------------------------------------------------------


@pytest.mark.long
def test_every_offer_on_a_real_robot_is_right(corpus: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    """All edits are made in a copy: each finding is gone, no error or warning comes, every model expands and MuJoCo takes the
    links whose inertials changed."""
    pytest.importorskip("mujoco")
    runs = {name: robot.run for name, robot in check_robots(corpus, tmp_path_factory).items()}
    kinds = {name: {offer.kind for offer in collect_offers(run)} for name, run in runs.items()}
    # The smaller robots are checked sooner; what only large ones are offered is tried on these.
    ordered = sorted(kinds, key=lambda name: sum(model.links or 0 for model in runs[name].models))
    requests, tried, faults = list_requests(corpus), 0, {}
    for name in select_by_trait(ordered, kinds.__getitem__, times=ROBOTS_OF_A_KIND):
        known = {code for robot, code in KNOWN if robot == name}
        # What the check of the robot measured of its meshes is known.
        request = replace(requests[name], cache=get_robot_cache(tmp_path_factory))
        outcomes = try_offers(request, runs[name], apart=known)
        tried += len(outcomes)
        new = [o for o in outcomes if o.kind.partition(" ")[0] not in known]
        faults.update({(name, o.kind, o.subjects): fault for o in new if (fault := describe_fault(o))})
    assert tried
    assert faults == {}
