"""Imported once by the process that workers are forked from: what nearly every audit needs."""

import contextlib

import urdfcheck.worker  # noqa: F401
from urdfcheck.libraries import prefer_own

prefer_own()
for _name in ("numpy", "xacro", "yaml", "pinocchio", "coal", "trimesh"):
    with contextlib.suppress(ImportError):
        __import__(_name)
