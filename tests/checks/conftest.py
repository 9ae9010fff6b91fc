"""The tests of a check speak of what it reports at each place, before places of one kind become one finding."""

from __future__ import annotations

from collections.abc import Iterable

import pytest

from urdfcheck.core import Finding
from urdfcheck.run import findings


@pytest.fixture(autouse=True)
def _each_place_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    def keep(found: Iterable[Finding], _units: object) -> list[Finding]:
        return list(found)

    monkeypatch.setattr(findings, "merge_kinds", keep)
