"""The list of the keyboard shortcuts of a page."""

from __future__ import annotations

from collections.abc import Iterable

# Layers of the 3D view, in the order of their keys.
LAYERS = ("visual", "collision", "COM", "inertia", "ellipsoid", "axes", "frames", "holes", "overlaps", "ground")
VIEWER_KEYS = (
    ("h", "the whole robot in 3D"),
    ("1 to 9, 0", "3D layers: " + ", ".join(f"{number % 10} {layer}" for number, layer in enumerate(LAYERS, 1))),
    (
        "\u2190 \u2191 \u2192 \u2193, + \u2212",
        "orbit and zoom the 3D view when it has the focus; with Shift, arrows move it",
    ),
)


def render_key_help(keys: Iterable[tuple[str, str]]) -> str:
    """Render a dialog with keys and what they do, and the status line in which the page's script reports."""
    rows = "".join(f"<div><dt><kbd>{key}</kbd></dt><dd>{what}</dd></div>" for key, what in keys)
    return (
        f'<dialog id="keys" aria-labelledby="keys-title"><h2 id="keys-title">Keys</h2><dl>{rows}</dl>'
        '<button type="button" id="close-keys">Close</button></dialog><p id="said" class="sr" role="status"></p>'
    )
