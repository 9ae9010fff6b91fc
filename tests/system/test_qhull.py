"""Qhull loads without the rest of scipy, and scipy works after that."""

from __future__ import annotations

import subprocess
import sys

import pytest

SCRIPT = """
import sys
import numpy as np
from urdfcheck.system.qhull import load_qhull
qhull = load_qhull()
assert load_qhull() is qhull
assert {"scipy.spatial", "scipy.linalg", "scipy.sparse"}.isdisjoint(sys.modules)
assert qhull.ConvexHull(np.eye(4)[:, :3]).volume > 0.1
from scipy import linalg
from scipy.spatial import ConvexHull, QhullError, cKDTree
assert (ConvexHull, QhullError) == (qhull.ConvexHull, qhull.QhullError)
assert cKDTree(np.eye(3)).query(np.ones(3))[0] > 1.0
assert linalg.det(2.0 * np.eye(3)) == 8.0
assert load_qhull().ConvexHull is ConvexHull
"""


ELSEWHERE = """
from urdfcheck.system import qhull
qhull._COMPILED = ("scipy.linalg.no_such_module", "scipy.spatial._qhull")
loaded = qhull.load_qhull()
import scipy.spatial
assert loaded is scipy.spatial
"""


@pytest.mark.parametrize("script", [SCRIPT, ELSEWHERE], ids=["alone", "built in another way"])
def test_qhull_loads_and_leaves_scipy_as_it_is(script: str) -> None:
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
