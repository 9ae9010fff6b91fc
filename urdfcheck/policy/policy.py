"""What the rules look for in a model, and how they judge it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from typing import Any

from urdfcheck.core import Severity
from urdfcheck.core.records import dataclass
from urdfcheck.policy.suppression import SuppressionEntry

# How much is computed, each with all before it.
TIERS = ("source", "mesh", "full")


@dataclass(frozen=True, slots=True, kw_only=True)
class Policy:
    """Settings of the rules for one model, launch file or package: configuration and command line resolved."""

    codes: frozenset[str]
    """Codes of the selected rules."""
    unrequested: frozenset[str] = frozenset()
    """Codes of rules that were not asked for by name: of these, notes on request are left out (`Rule.on_request`)."""
    postponed: frozenset[str] = frozenset()
    """Codes of rules that are selected only where their notes are asked for: to look for these takes long."""
    pedantic: bool = False
    """Whether notes that are warnings for a pedantic reader are warnings (`Rule.pedantic`)."""
    is_for_tests: bool = False
    """Whether the model is data of tests: of these, only errors are reported that hold wherever the file is read."""
    is_kept_aside: bool = False
    """Whether it is such a model because it is kept and not used: of these, errors are not reported either."""
    is_left_over: bool = False
    """Whether it is kept aside because no file of the project names it, and one names another model of its package."""
    kinematics_only: bool = False
    """Whether findings about masses, inertias and forces alone are left out (`Rule.dynamics`)."""
    tier: str = "full"
    """How much is computed: source | mesh | full."""
    options: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """Code → option → value, where it differs from the default on the rule's page."""
    severities: Mapping[str, str] = field(default_factory=dict)
    """Code → severity that replaces the one of the page."""
    targets: tuple[str, ...] = ()
    """Programs that will read the model; what one of them rejects or drops is an error."""
    suppress: tuple[SuppressionEntry, ...] = ()
    """Entries of the configuration that suppress findings."""
    unchecked: Severity = Severity.ERROR
    """Severity of the causes for which a model cannot be checked; a warning where that is accepted. Neither `codes`,
    `severities` nor `suppress` hold for these causes. A cause that leaves the model right is an info anyway."""

    @property
    def accepts_unchecked(self) -> bool:
        """Whether a model that cannot be checked is accepted."""
        return self.unchecked < Severity.ERROR


def keep_aside(policy: Policy, *, is_left_over: bool = False) -> Policy:
    """Return the settings for a model that is kept and not used; that it cannot be checked is accepted."""
    unchecked = min(policy.unchecked, Severity.WARNING)
    return replace(policy, is_for_tests=True, is_kept_aside=True, is_left_over=is_left_over, unchecked=unchecked)
