"""The robot in 3D: its place in the page, and the scripts and data that fill it.

The view is three.js with our own code, built from ``report-ui/``. It and the meshes stand in the page as deflated text; a few
lines unpack the view and run it. Without a script or WebGL the place stays hidden and the page says so.
"""

from __future__ import annotations

import base64
import zlib
from functools import cache

from urdfcheck.output.html.page_frame import read_asset

# The meshes are packed for deflate already: more effort than this takes half a second and saves a hundredth.
_EFFORT = 6


def render_viewer() -> str:
    """The place of the robot, and of the line that says why there is none."""
    return """<section id="viewer" aria-label="The robot in 3D" hidden>
<div class="uc-view"><div class="uc-bar"></div>
<div class="uc-labels" aria-hidden="true"></div><div class="uc-corner" aria-hidden="true"></div></div>
<details class="uc-joints"></details>
</section>
<p id="no-viewer" class="no-viewer"></p>
"""


def render_viewer_scripts(data_json: str, geometry: bytes) -> tuple[str, list[str]]:
    """The scripts and data at the end of the page, and the texts of all scripts that its policy must allow.

    ``data_json``: the values of `stage.stage_data`; ``geometry``: its bytes."""
    data = data_json.replace("<", "\\u003c")
    blocks = f"""<script type="application/json" id="uc-data">{data}</script>
<script type="text/plain" id="uc-geom">{_pack_to_base64(geometry, _EFFORT)}</script>
<script type="text/plain" id="uc-app">{_pack_app_script()}</script>
<script>{read_asset("bootstrap.js")}</script>
"""
    return blocks, [read_asset("bootstrap.js"), read_asset("app.js")]


def read_viewer_style() -> str:
    """What the view adds to the style of the page."""
    return read_asset("viewer.css")


@cache
def _pack_app_script() -> str:
    return _pack_to_base64(read_asset("app.js").encode(), 9)


def _pack_to_base64(data: bytes, effort: int) -> str:
    packer = zlib.compressobj(effort, zlib.DEFLATED, -zlib.MAX_WBITS)
    return base64.b64encode(packer.compress(data) + packer.flush()).decode()
