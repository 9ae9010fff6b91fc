"""The committed sample reports are what the code makes today."""

from __future__ import annotations

import subprocess
import sys

import pytest
from conftest import REPOSITORY

pytestmark = pytest.mark.slow


def test_sample_reports_are_current() -> None:
    done = subprocess.run(
        [sys.executable, "tools/make_reports.py", "--check"], cwd=REPOSITORY, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
