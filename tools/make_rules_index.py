"""Makes rules/README.md from the pages: ``python tools/make_rules_index.py``."""

from __future__ import annotations

from pathlib import Path

from urdfcheck import catalogue

FAMILIES = {
    "XML": "XML and the URDF grammar",
    "XAC": "xacro sources",
    "PKG": "packages, paths and files",
    "KIN": "the kinematic tree",
    "JNT": "joints, axes and limits",
    "SYM": "odd ones out",
    "INR": "mass and inertia",
    "MSH": "meshes",
    "GEO": "shapes",
    "NAM": "names",
    "GZB": "Gazebo extensions",
    "CTL": "control interfaces",
    "LCH": "launch files",
    "URC": "urdfcheck itself",
}

INTRODUCTION = """\
# The rules

One page per rule: its metadata, its documentation and its first test. `urdfcheck rule CODE` prints a page.
How to add one stands in [CONTRIBUTING](../CONTRIBUTING.md). This index is made by `make reports`.
"""


def index() -> str:
    """The text of rules/README.md."""
    parts = [INTRODUCTION]
    rules = catalogue.rules()
    for family, title in FAMILIES.items():
        members = [rule for code, rule in rules.items() if code.startswith(family)]
        if not members:
            continue
        parts.append(
            f"\n## {family}: {title}\n\n| code | name | severity | confidence | finds |\n|---|---|---|---|---|\n"
        )
        for rule in members:
            page = f"{rule.code}-{rule.name}.md"
            parts.append(
                f"| [{rule.code}]({page}) | {rule.name} | {rule.severity} | {rule.confidence} | {_cell(rule.summary)} |\n"
            )
    return "".join(parts)


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


if __name__ == "__main__":
    (Path(__file__).parent.parent / "rules" / "README.md").write_text(index(), encoding="utf-8", newline="\n")
