"""What a start loads: the check of one changed file waits for it."""

from __future__ import annotations

import json
import subprocess
import sys

# What most models, or a second run on a model, do without.
RARELY_NEEDED = {
    "yaml",
    "trimesh",
    "pinocchio",
    "urdfcheck.core.drop_test",
    "urdfcheck.facts.likeness.mirror",
    "urdfcheck.facts.mesh.decode",
    "urdfcheck.model.ground.wheels",
    "urdfcheck.model.inertials.proposals",
    "urdfcheck.model.motion.collisions.lying_meshes",
    "urdfcheck.model.motion.collisions.restored_origins",
    "urdfcheck.model.shapes.visual_solid",
    "urdfcheck.source.launch.launch_file",
    "urdfcheck.source.launch.python_launch_file",
    "urdfcheck.source.text.yaml.reader",
    "urdfcheck.source.xacro.argument_values",
    "urdfcheck.source.xacro.expand",
}

START = """
import json, sys
from importlib import import_module
from urdfcheck.run.preload import PARENT_MODULES, preload_modules
for name in PARENT_MODULES:
    import_module(name)
preload_modules()
print(json.dumps(sorted(sys.modules)))
"""


def test_a_start_loads_nothing_that_most_models_do_without() -> None:
    done = subprocess.run([sys.executable, "-I", "-c", START], capture_output=True, text=True, check=True)
    assert set(json.loads(done.stdout)) & RARELY_NEEDED == set()
