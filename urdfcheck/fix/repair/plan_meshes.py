"""COLLADA files with another unit than the metre, or another axis than z that is up: the same drawing without either."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.fix.repair.mesh_writing import bake_collada
from urdfcheck.fix.repair.steps import RepairOptions, RepairStep
from urdfcheck.model import Model
from urdfcheck.source.package.finder import format_path
from urdfcheck.system.files import MAX_MESH, read_regular


def plan_meshes(model: Model, options: RepairOptions) -> Iterator[RepairStep]:
    """Yield a step for each COLLADA file whose size or orientation depends on the program that draws it."""
    if options.meshes == "none":
        return
    for uses, facts in model.meshes.list_measured():
        path = uses[0].resource.path
        unit, axis = 1.0 if facts.unit is None else facts.unit, facts.up_axis or "Z_UP"
        if path is None or facts.format != "dae" or facts.bad_unit is not None or (unit == 1.0 and axis == "Z_UP"):
            continue
        baked = bake_collada(
            read_regular(path, MAX_MESH), unit=unit, up_axis=axis, upright=options.up_axis == "upright"
        )
        name = format_path(path)
        if baked is None:
            yield RepairStep(stage="meshes", subject=name, text="it has no scene to write a scale to", is_done=False)
            continue
        done = [] if unit == 1.0 else [f"unit {unit:g} m written into the coordinates"]
        if axis != "Z_UP":
            upright = options.up_axis == "upright" and axis == "Y_UP"
            done.append(f"{axis} replaced by Z_UP, {'rotated upright' if upright else 'drawn as before in RViz'}")
        yield RepairStep(stage="meshes", subject=name, text=", ".join(done), files={str(path): baked})
