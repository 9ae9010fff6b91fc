"""A mistake of the program that exported a file explains most of its links together."""

from __future__ import annotations

from urdfcheck.facts.inertials.mistakes.file_habits import Evidence, Habit, decide_habit, list_candidates

GRAMS, SIGNS = ("mass_unit", "g"), ("products_sign", "")


def fits(gains: dict[tuple[str, str], float], other: float = 0.0) -> Evidence:
    """A link for which undoing each mistake makes its numbers e^gain times likelier; ``other``: the best slip of one hand."""
    return Evidence(likelihoods=gains, priors=dict.fromkeys(gains, -3.0), sound=0.0, alternative=max(0.0, other))


def test_what_no_link_shows_alone_most_show_together() -> None:
    links = [fits({SIGNS: 4.0})] * 6
    assert list_candidates(links[0]) == [SIGNS]
    assert decide_habit(links, [SIGNS]) == Habit("products_sign", "", 0.95)
    assert decide_habit(links[:2], [SIGNS]) is None


def test_one_link_is_no_habit_however_well_a_mistake_fits_it() -> None:
    links = [fits({GRAMS: 500.0}), *[fits({GRAMS: -20.0})] * 5]
    assert decide_habit(links, [GRAMS]) is None


def test_links_that_the_mistake_does_not_affect_say_nothing() -> None:
    links = [*[fits({SIGNS: 9.0})] * 3, *[fits({SIGNS: 0.1})] * 20]
    assert decide_habit(links, [SIGNS]) == Habit("products_sign", "", 0.95)


def test_a_part_that_the_mistake_makes_worse_is_outvoted_by_most_links() -> None:
    links = [*[fits({SIGNS: 20.0})] * 4, fits({SIGNS: -50.0})]
    found = decide_habit(links, [SIGNS])
    assert found is not None
    assert found.share == 0.8
    assert decide_habit([*links, *[fits({SIGNS: -50.0})] * 4], [SIGNS]) is None


def test_two_mistakes_that_explain_the_file_as_well_leave_it_open() -> None:
    assert decide_habit([fits({SIGNS: 12.0, GRAMS: 13.0})] * 4, [SIGNS, GRAMS]) is None
    found = decide_habit([fits({SIGNS: 12.0, GRAMS: 15.0})] * 4, [SIGNS, GRAMS])
    assert found is not None
    assert found.id == "mass_unit"


def test_slips_that_explain_each_link_better_are_no_habit() -> None:
    assert decide_habit([fits({SIGNS: 12.0}, other=30.0)] * 6, [SIGNS]) is None
