"""What urdfcheck measures of a part: its pieces written as STL files, drawn by a URDF, and read back."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path

from parts import Part

from urdfcheck.facts.inertials.declared_and_drawn import VisualGeometry
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder

# How a link draws a mesh: right, and with the exporter's unit not undone either way.
SCALES = (1.0, 1e3, 1e-3)


def drawn(part: Part) -> dict[float, VisualGeometry]:
    """The part as it is, and drawn too large and too small, by scale.

    :raises ValueError: when urdfcheck does not see a closed solid.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for i, piece in enumerate(part.pieces):
            piece.export(folder / f"{i}.stl")
        visuals = [
            "".join(
                f'<visual><geometry><mesh filename="{i}.stl" scale="{s} {s} {s}"/></geometry></visual>'
                for i in range(len(part.pieces))
            )
            for s in SCALES
        ]
        links = "".join(f'<link name="x{s}">{visual}</link>' for s, visual in zip(SCALES, visuals, strict=True))
        urdf = folder / "part.urdf"
        urdf.write_text(f'<robot name="part">{links}</robot>', encoding="utf-8")
        source = load_source(urdf, {}, PackageFinder(urdf, {}, []))
        assert source.root is not None
        # Every size counts as the part's own: MSH008 would keep the other rules from measuring the last two.
        model = Model(source=source, robot=source.root, mesh_limits={"largest": math.inf, "smallest": 0.0})
        found = {s: measure_link_geometry(model, model.link_by_name[f"x{s}"]) for s in SCALES}
    shown = {s: g for s, g in found.items() if g is not None and g.closed}
    if len(shown) < len(SCALES):
        raise ValueError(f"{part.name} is not seen as a closed solid")
    return shown
