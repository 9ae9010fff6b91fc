"""Every public type of urdfcheck. Standard library only, so that no import of it costs anything.

What only outputs that draw need is in :mod:`urdfcheck.core.scene`.
"""

from urdfcheck.core.errors import Unavailable, UrdfcheckError
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
    Skip,
    Span,
    Suppression,
    Verdict,
)
from urdfcheck.core.rule import Option, Rule
from urdfcheck.core.run import ModelInfo, Run

__all__ = [
    "Applicability",
    "Cause",
    "Computed",
    "Confidence",
    "Edit",
    "Finding",
    "Fix",
    "Located",
    "Location",
    "ModelInfo",
    "NEWLINE",
    "Option",
    "Rule",
    "Run",
    "Severity",
    "Skip",
    "Span",
    "Suppression",
    "Unavailable",
    "UrdfcheckError",
    "Verdict",
]
