"""The warnings of the libraries that convert to USD."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def print_warnings() -> Iterator[None]:
    """Print warnings and errors inside the context, and nothing of lesser weight."""
    import usdex.core

    usdex.core.activateDiagnosticsDelegate()
    usdex.core.setDiagnosticsLevel(usdex.core.DiagnosticsLevel.eWarning)
    yield
    usdex.core.setDiagnosticsLevel(usdex.core.DiagnosticsLevel.eError)
