"""Every public type of urdfcheck. Standard library only, so that no import of it costs anything.

What only outputs that draw need is in :mod:`urdfcheck.core.scene`.
"""

from urdfcheck.core.errors import FactUnavailableError, UrdfcheckError
from urdfcheck.core.findings import (
    NEWLINE,
    Applicability,
    Cause,
    Computed,
    Confidence,
    Edit,
    Finding,
    Fix,
    Located,
    Location,
    Severity,
    SkippedCheck,
    Span,
    Suppression,
    Verdict,
)
from urdfcheck.core.rule import Rule, RuleFamily, RuleOption
from urdfcheck.core.run import ModelInfo, Run

__all__ = [
    "NEWLINE",
    "Applicability",
    "Cause",
    "Computed",
    "Confidence",
    "Edit",
    "FactUnavailableError",
    "Finding",
    "Fix",
    "Located",
    "Location",
    "ModelInfo",
    "Rule",
    "RuleFamily",
    "RuleOption",
    "Run",
    "Severity",
    "SkippedCheck",
    "Span",
    "Suppression",
    "UrdfcheckError",
    "Verdict",
]
