"""Every public type of urdfcheck. Standard library only, so that no import of it costs anything.

What only outputs that draw need is in :mod:`urdfcheck.core.scene`.
"""

# Type checkers take it for typing's, whose import would double the time that the import of this package takes.
TYPE_CHECKING = False

if TYPE_CHECKING:
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
    from urdfcheck.core.run import EngineAnswer, ModelInfo, NotChecked, Run

__all__ = [
    "NEWLINE",
    "Applicability",
    "Cause",
    "Computed",
    "Confidence",
    "Edit",
    "EngineAnswer",
    "FactUnavailableError",
    "Finding",
    "Fix",
    "Located",
    "Location",
    "ModelInfo",
    "NotChecked",
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

# The module of each name. They are imported when they are first used (PEP 562): the start of the command needs the errors only.
_HOMES = {
    **dict.fromkeys(("FactUnavailableError", "UrdfcheckError"), "errors"),
    **dict.fromkeys(
        (
            "NEWLINE",
            "Applicability",
            "Cause",
            "Computed",
            "Confidence",
            "Edit",
            "Finding",
            "Fix",
            "Located",
            "Location",
            "Severity",
            "SkippedCheck",
            "Span",
            "Suppression",
            "Verdict",
        ),
        "findings",
    ),
    **dict.fromkeys(("Rule", "RuleFamily", "RuleOption"), "rule"),
    **dict.fromkeys(("EngineAnswer", "ModelInfo", "NotChecked", "Run"), "run"),
}

if not TYPE_CHECKING:  # a type checker would accept any name

    def __getattr__(name):
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        import importlib

        value = getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)
        globals()[name] = value
        return value
