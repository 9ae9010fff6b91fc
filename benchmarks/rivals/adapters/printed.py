"""What a program prints, native code included, for adapters of programs that report nothing in another way."""

from __future__ import annotations

import ctypes
import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def capture_lines() -> Iterator[list[str]]:
    """Fill the list, at the end of the block, with the lines that were written to stdout and stderr."""
    lines: list[str] = []
    flush = ctypes.CDLL(None).fflush
    with tempfile.TemporaryFile() as file:
        saved = os.dup(1), os.dup(2)
        flush(None)
        for number in (1, 2):
            os.dup2(file.fileno(), number)
        try:
            yield lines
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            flush(None)
            for number, old in zip((1, 2), saved, strict=True):
                os.dup2(old, number)
                os.close(old)
            file.seek(0)
            lines += file.read().decode(errors="replace").splitlines()
