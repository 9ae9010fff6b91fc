"""Mistakes that a whole file has: a unit or a convention belongs to the program that exported it, not to one link.

Each link says how well every such mistake explains its numbers (`Evidence`). A habit is the mistake that explains the links
together: log P(habit) + Σ over the links of max(log s + L(habit), log(1 - s) + L(other)), with ``s`` the share of the links that
have it, is greater by `MARGIN` than the same sum without a habit, where each link's mistake is as rare as `LOG_PRIORS` says.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence

from urdfcheck.core.records import dataclass

# What exporters and the conventions of a CAD program do to all links alike. The others are slips in one link. Not "rpy_missing":
# undoing it borrows the axes from the mesh, so that many links with something else fit it a little better.
HABITS = frozenset(
    {
        *("inertia_unit", "mass_unit", "com_unit", "units", "mesh_scale"),
        *("about_origin", "positive_notation", "steiner_twice", "products_sign", "axes_permuted", "quarter_turn"),
        *("com_missing", "rpy_twice", "diagonal_first"),
    }
)
# A habit is named when it beats "every link has its own mistake", and every other habit, by this many nats.
MARGIN = 5.0
# Shares of the links that have a habit, where there is one: most of them, or it is none.
_SHARES = (0.95, 0.8, 0.6)
# Explanations that differ by less are as good: they lead to the same numbers.
_EQUAL = 0.5
# Links that fit worse by this many nats with the habit undone than without it do not have it.
_EFFECT = 1.0

Key = tuple[str, str]
"""Id and detail of a mistake."""


def can_be_habit(mistake: str, detail: str) -> bool:
    """Whether a program makes a mistake in all links alike. A decimal point is a slip, but that of all six numbers of a tensor
    is a scale."""
    return mistake in HABITS or (mistake == "decimal_point" and detail.startswith("tensor "))


@dataclass(frozen=True, slots=True)
class Habit:
    """A mistake that most links of a file have."""

    id: str
    """One of `HABITS`."""
    detail: str
    """Its parameter, such as a unit."""
    share: float
    """Of the links that it affects."""

    @property
    def log_share(self) -> float:
        return math.log(self.share)

    @property
    def log_rest(self) -> float:
        return math.log(1.0 - self.share)

    def is_like(self, mistake: str, detail: str) -> bool:
        """Whether a mistake is this one, whatever its parameter; a decimal point has to be that of the same number."""
        return mistake == self.id and (detail == self.detail or mistake in HABITS)


@dataclass(frozen=True, slots=True)
class Evidence:
    """How well mistakes explain the numbers of one link; natural logarithms, comparable within the link only."""

    likelihoods: dict[Key, float]
    """Of each of `HABITS`: how likely the numbers without it are, its frequency aside. Missing: next to impossible."""
    priors: dict[Key, float]
    """How often each is made in one link."""
    sound: float
    """How likely the numbers are as they are."""
    alternative: float
    """Score, frequency included, of the best explanation that is not a habit, "no mistake" among them."""

    @property
    def best(self) -> float:
        """The score of the best explanation of this link alone."""
        return max([self.alternative, *(like + self.priors[key] for key, like in self.likelihoods.items())])

    def compute_gain(self, key: Key, share: float) -> float:
        """Compute by how much a habit that ``share`` of the links have makes the numbers likelier than the best explanation of
        this link alone."""
        with_habit = math.log(share) + self.likelihoods.get(key, -math.inf)
        return max(with_habit, math.log(1.0 - share) + self.alternative) - self.best

    def is_affected(self, key: Key) -> bool:
        """Whether the link shows if it has the mistake."""
        return abs(self.likelihoods.get(key, -math.inf) - self.sound) > _EFFECT

    def is_supporting(self, key: Key, share: float) -> bool:
        """Whether the link rather has the mistake than any that is not a habit."""
        with_habit = math.log(share) + self.likelihoods.get(key, -math.inf)
        return self.is_affected(key) and with_habit > math.log(1.0 - share) + self.alternative


def list_candidates(evidence: Evidence) -> list[Key]:
    """List the habits that explain a link about as well as anything does."""
    least = evidence.best - MARGIN
    return [
        key
        for key, likelihood in evidence.likelihoods.items()
        if likelihood + evidence.priors[key] > least and evidence.is_affected(key)
    ]


def decide_habit(links: Sequence[Evidence], candidates: Collection[Key]) -> Habit | None:
    """Return the one mistake that explains most links of a file together; None where none does, or two do.

    ``links``: of parts that differ, for copies and mirror images are one piece of evidence.
    """
    ranked: list[tuple[float, Key, float]] = []
    for key in candidates:
        prior = max((link.priors[key] for link in links if key in link.priors), default=-math.inf)
        score, share = max((prior + sum(link.compute_gain(key, share) for link in links), share) for share in _SHARES)
        if _has_most_links(links, key, share):
            ranked.append((score, key, share))
    ranked.sort(key=lambda entry: -entry[0])
    if not ranked or ranked[0][0] <= MARGIN:
        return None
    score, key, share = ranked[0]
    if any(score - other < MARGIN and not _is_same(links, key, rival) for other, rival, _ in ranked[1:]):
        return None
    return Habit(*key, share)


def _has_most_links(links: Sequence[Evidence], key: Key, share: float) -> bool:
    affected = [link for link in links if link.is_affected(key)]
    supporting = [link for link in affected if link.is_supporting(key, share)]
    return len(supporting) >= 2 and 2 * len(supporting) > len(affected)


def _is_same(links: Sequence[Evidence], key: Key, rival: Key) -> bool:
    """Whether two mistakes lead to the same numbers in all links."""
    pairs = ((link.likelihoods.get(key, -math.inf), link.likelihoods.get(rival, -math.inf)) for link in links)
    return all(one == other or abs(one - other) < _EQUAL for one, other in pairs)
