"""The version of the code that a result is kept under, read from its files or from what an earlier process read."""

from __future__ import annotations

from pathlib import Path

import pytest

from urdfcheck.system import installation

GROUPS = (
    ("urdfcheck.facts.mesh", "urdfcheck.model.meshes"),
    ("urdfcheck.facts",),
    ("urdfcheck.model.motion.joint_loads", "urdfcheck.facts.arrays"),
)


@pytest.fixture(autouse=True)
def start_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(installation, "_recalled", {})
    monkeypatch.setattr(installation, "_digest_module", installation.cache(installation._digest_module.__wrapped__))


def list_versions(monkeypatch: pytest.MonkeyPatch, folder: Path | None) -> tuple[list[str], bool]:
    """The versions as a new process computes them, and whether it reads sources for that."""
    installation._recalled.clear()
    installation._digest_module.cache_clear()
    read: list[Path] = []
    with monkeypatch.context() as patch:
        read_bytes = Path.read_bytes
        patch.setattr(Path, "read_bytes", lambda path: read.append(path) or read_bytes(path))  # type: ignore[func-returns-value]
        if folder is not None:
            installation.recall_digests(folder)
        versions = [installation.compute_code_version(*modules, library="x") for modules in GROUPS]
    return versions, any(path.suffix == ".py" for path in read)


def test_what_is_kept_is_what_the_sources_give(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    direct = list_versions(monkeypatch, None)
    assert direct[1]
    assert list_versions(monkeypatch, tmp_path) == direct
    assert list_versions(monkeypatch, tmp_path) == (direct[0], False)
    assert len(set(direct[0])) == len(GROUPS)


def test_a_damaged_copy_and_another_installation_read_the_sources(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    direct = list_versions(monkeypatch, tmp_path)
    (kept,) = (tmp_path / "code").iterdir()
    kept.write_bytes(kept.read_bytes()[:-9])
    assert list_versions(monkeypatch, tmp_path) == direct
    monkeypatch.setattr(installation, "compute_installation_stamp", lambda: "0" * 64)
    assert list_versions(monkeypatch, tmp_path) == direct


def test_a_changed_module_has_another_version(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before, _ = list_versions(monkeypatch, None)
    changed = Path(installation.__file__).parent.parent / "facts" / "arrays.py"
    read_bytes = Path.read_bytes
    monkeypatch.setattr(Path, "read_bytes", lambda path: read_bytes(path) + b"#" * (path == changed))
    after, _ = list_versions(monkeypatch, None)
    assert [one == other for one, other in zip(before, after, strict=True)] == [True, False, False]
    assert list_versions(monkeypatch, tmp_path)[0] == after
