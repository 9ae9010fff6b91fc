"""urdfcheck: a linter and physics audit for robot models.

From Python, :func:`check` does what the command does::

    import urdfcheck

    run = urdfcheck.check("my_robot.urdf", target="gazebo")
    for finding in run.active_findings:
        print(finding.code, finding.severity, finding.headline)
"""

from urdfcheck.version import __version__

# Type checkers take it for typing's, whose import would double the time that the import of this package takes.
TYPE_CHECKING = False

if TYPE_CHECKING:
    from urdfcheck.api import check as check
    from urdfcheck.api import diff as diff
    from urdfcheck.api import diff_commits as diff_commits
    from urdfcheck.core import Applicability as Applicability
    from urdfcheck.core import Cause as Cause
    from urdfcheck.core import Confidence as Confidence
    from urdfcheck.core import Edit as Edit
    from urdfcheck.core import Finding as Finding
    from urdfcheck.core import Fix as Fix
    from urdfcheck.core import Location as Location
    from urdfcheck.core import ModelInfo as ModelInfo
    from urdfcheck.core import Rule as Rule
    from urdfcheck.core import Run as Run
    from urdfcheck.core import Severity as Severity
    from urdfcheck.core import SkippedCheck as SkippedCheck
    from urdfcheck.core import Span as Span
    from urdfcheck.core import Suppression as Suppression
    from urdfcheck.core import UrdfcheckError as UrdfcheckError
    from urdfcheck.core.model_diff import Diff as Diff
    from urdfcheck.rules import load_rules as load_rules

# The module of each name. They are imported when they are first used (PEP 562): every start of the command imports this package.
_HOMES = {
    "check": "urdfcheck.api",
    "diff": "urdfcheck.api",
    "diff_commits": "urdfcheck.api",
    "Diff": "urdfcheck.core.model_diff",
    "load_rules": "urdfcheck.rules",
    **dict.fromkeys(
        (
            *("Applicability", "Cause", "Confidence", "Edit", "Finding", "Fix", "Location", "ModelInfo", "Rule", "Run"),
            *("Severity", "SkippedCheck", "Span", "Suppression", "UrdfcheckError"),
        ),
        "urdfcheck.core",
    ),
}

__all__ = [
    "Applicability",
    "Cause",
    "Confidence",
    "Diff",
    "Edit",
    "Finding",
    "Fix",
    "Location",
    "ModelInfo",
    "Rule",
    "Run",
    "Severity",
    "SkippedCheck",
    "Span",
    "Suppression",
    "UrdfcheckError",
    "__version__",
    "check",
    "diff",
    "diff_commits",
    "load_rules",
]

if not TYPE_CHECKING:  # a type checker would accept any name

    def __getattr__(name):
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        import importlib

        value = getattr(importlib.import_module(_HOMES[name]), name)
        globals()[name] = value
        return value

    def __dir__():
        return sorted({*globals(), *_HOMES})
