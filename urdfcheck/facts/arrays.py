"""Names for the arrays of the package.

numpy's annotations say nothing about shapes that a type checker enforces: ``Vec3``, ``Mat3`` and ``Mat4`` say it to the reader,
and docstrings give the shape of any other `Array`.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
"""Floating-point numbers of any shape."""

Vec3: TypeAlias = Array
"""(3,), a place, a direction or three Euler angles."""

Mat3: TypeAlias = Array
"""(3, 3), a rotation or a tensor."""

Mat4: TypeAlias = Array
"""(4, 4), a homogeneous transform."""

Indices: TypeAlias = NDArray[np.int64]
"""Integers of any shape: rows of other arrays, such as the corners (F, 3) of triangles."""

Bools: TypeAlias = NDArray[np.bool_]
"""Flags of any shape, often a mask of another array's rows."""
