"""The robot in 3D: its place in the page, and the scripts and data that fill it.

The view is three.js with the project's own code, built from ``report-ui/``. The page contains it and the meshes as deflated
text, and a few lines that unpack and run it. Without scripts or WebGL the place stays hidden and the page says so.
"""

from __future__ import annotations

import base64
import zlib
from functools import cache

from urdfcheck.output.html.page_frame import read_asset

# Compression level: the meshes are already packed for deflate; a higher level takes half a second and saves 1 %.
_EFFORT = 6


def render_viewer() -> str:
    """Render the place of the robot, and of the line that says why there is none."""
    return """<section id="viewer" aria-label="The robot in 3D" hidden>
<div class="uc-view"><div class="uc-bar"></div>
<div class="uc-labels" aria-hidden="true"></div><div class="uc-corner" aria-hidden="true"></div></div>
<details class="uc-joints"></details>
</section>
<p id="no-viewer" class="no-viewer"></p>
"""


def render_viewer_scripts(data_json: str, geometry: bytes) -> tuple[str, list[str]]:
    """Render the scripts and data at the end of the page; return them and the texts of all scripts that its policy must allow.

    ``data_json`` and ``geometry``: the values and the bytes of `scene_data.build_scene_data`."""
    data = data_json.replace("<", "\\u003c")
    blocks = f"""<script type="application/json" id="uc-data">{data}</script>
<script type="text/plain" id="uc-geom">{_pack_to_base64(geometry, _EFFORT)}</script>
<script type="text/plain" id="uc-app">{_pack_app_script()}</script>
<script>{read_asset("bootstrap.js")}</script>
"""
    return blocks, [read_asset("bootstrap.js"), read_asset("app.js")]


def read_viewer_style() -> str:
    """Read the style of the view."""
    return read_asset("viewer.css")


@cache
def _pack_app_script() -> str:
    return _pack_to_base64(read_asset("app.js").encode(), 9)


def _pack_to_base64(data: bytes, effort: int) -> str:
    packer = zlib.compressobj(effort, zlib.DEFLATED, -zlib.MAX_WBITS)
    return base64.b64encode(packer.compress(data) + packer.flush()).decode()
