"""mjcf-doctor, as ``mjcf-doctor check`` does. It is made for MJCF: it is given the model that MuJoCo makes of the URDF.

Where MuJoCo refuses the file, mjcf-doctor says so in MuJoCo's words, and that is its answer here.
"""

from __future__ import annotations

from collections.abc import Iterator

from ask_mujoco import load
from mjcf_doctor import diagnose

SEVERITIES = ("info", "warning", "error")


def ask(file: str) -> Iterator[tuple[str, str, str, str]]:
    """Yield what it reports."""
    try:
        model = load(file)
    except ValueError as error:
        yield "error", "refused", "", " ".join(str(error).split())
        return
    for found in diagnose(model):
        # A pair of shapes is named `link:geom / link:geom`.
        parts = "|".join(part.partition(":")[0].strip() for part in found.subject.split(" / "))
        yield SEVERITIES[found.level], found.code, parts, f"{found.subject}: {found.message} {found.why}"
