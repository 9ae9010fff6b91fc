"""What is kept between runs: never wrong, never in the way."""

from __future__ import annotations

import multiprocessing
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import trimesh
from conftest import FIXTURES

from urdfcheck.cli import main
from urdfcheck.facts.mesh.decode_limits import MeshError
from urdfcheck.facts.mesh.measure import measure_mesh, restore_mesh_facts
from urdfcheck.system.array_cache import ArrayCache
from urdfcheck.system.cache_folder import find_default_folder

pytestmark = pytest.mark.slow

WHEEL = FIXTURES / "car-3" / "meshes" / "wheel_1.STL"
KEY = "0123456789abcdef"


def files_of(folder: Path, pattern: str = "*.npz") -> list[Path]:
    return sorted(folder.rglob(pattern))


def test_an_entry_is_there_in_the_next_run(tmp_path: Path) -> None:
    ArrayCache(tmp_path).entry("kind", KEY)["part"] = {"a": np.arange(3), "b": np.eye(2)}
    entry = ArrayCache(tmp_path).entry("kind", KEY)
    assert list(entry) == ["part"]
    assert entry["part"]["a"].tolist() == [0, 1, 2]
    assert "part" not in ArrayCache(tmp_path).entry("kind", KEY[::-1])
    assert "part" not in ArrayCache(tmp_path).entry("other", KEY)


@pytest.mark.parametrize("shape", [(), (0,), (0, 3), (5,), (2, 3), (4, 3, 2), (10_000, 3)])
@pytest.mark.parametrize("dtype", ["f4", "f8", "i4", "i8", "u1", "?"])
def test_entries_are_npz_files_that_numpy_reads_too(tmp_path: Path, dtype: str, shape: tuple[int, ...]) -> None:
    array = np.arange(np.prod(shape, dtype=int)).reshape(shape).astype(dtype)
    ArrayCache(tmp_path).entry("kind", KEY)["part"] = {"a": array, "turned": array.T}
    (file,) = files_of(tmp_path)
    ours = ArrayCache(tmp_path).entry("kind", KEY)["part"]
    with np.load(file, allow_pickle=False) as theirs:
        for name, wanted in (("a", array), ("turned", array.T)):
            for found in (ours[name], theirs[name]):
                np.testing.assert_array_equal(found, wanted)
                assert (found.dtype, found.shape) == (wanted.dtype, wanted.shape)


def test_without_a_folder_nothing_is_kept() -> None:
    ArrayCache().entry("kind", KEY)["part"] = {"a": np.arange(3)}
    assert not ArrayCache().entry("kind", KEY)


@pytest.mark.parametrize("damage", [b"", b"PK\x03\x04 but no archive", b"half"])
def test_a_corrupt_file_is_dropped_without_harm(tmp_path: Path, damage: bytes) -> None:
    entry = ArrayCache(tmp_path).entry("kind", KEY)
    entry["part"] = {"a": np.arange(1000)}
    (file,) = files_of(tmp_path)
    file.write_bytes(file.read_bytes()[:300] if damage == b"half" else damage)
    again = ArrayCache(tmp_path).entry("kind", KEY)
    assert "part" not in again
    assert not files_of(tmp_path)
    again["part"] = {"a": np.arange(2)}
    assert len(ArrayCache(tmp_path).entry("kind", KEY)["part"]["a"]) == 2


@pytest.mark.parametrize("cut", [1, 12, 22, 40, 90, 200])
def test_every_damage_is_noticed(tmp_path: Path, cut: int) -> None:
    entry = ArrayCache(tmp_path).entry("kind", KEY)
    entry["part"] = {"a": np.arange(20), "b": np.arange(3)}
    (file,) = files_of(tmp_path)
    data = file.read_bytes()
    changed = bytearray(data)
    changed[200] ^= 1  # a number of the first array
    for damaged in (data[:-cut], data[cut:], data[: -cut // 2] + data, bytes(changed)):
        file.write_bytes(damaged)
        assert "part" not in ArrayCache(tmp_path).entry("kind", KEY)
        assert not file.exists()


def test_a_known_entry_needs_no_zipfile(tmp_path: Path) -> None:
    ArrayCache(tmp_path).entry("kind", KEY)["part"] = {"a": np.arange(3)}
    script = (
        "import sys; from pathlib import Path; from urdfcheck.system.array_cache import ArrayCache;"
        f"print(ArrayCache(Path(sys.argv[1])).entry('kind', {KEY!r})['part']['a'], 'zipfile' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", script, str(tmp_path)], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[0 1 2] False"


def test_pickled_objects_are_not_loaded(tmp_path: Path) -> None:
    entry = ArrayCache(tmp_path).entry("kind", KEY)
    entry["part"] = {"a": np.arange(2)}
    (file,) = files_of(tmp_path)
    np.savez(file, a=np.array([{"an": "object"}], dtype=object))
    assert "part" not in ArrayCache(tmp_path).entry("kind", KEY)


def test_a_folder_that_cannot_be_written_is_no_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("not a folder")
    entry = ArrayCache(tmp_path / "file").entry("kind", KEY)
    entry["part"] = {"a": np.arange(2)}
    assert entry["part"]["a"].tolist() == [0, 1]  # in this run
    assert ArrayCache(tmp_path / "file").compute_digest(WHEEL)[0] == ArrayCache().compute_digest(WHEEL)[0]


def test_a_file_is_not_read_again_until_it_changes(tmp_path: Path) -> None:
    cache, file = ArrayCache(tmp_path / "cache"), tmp_path / "mesh.stl"
    file.write_bytes(b"first")
    os.utime(file, (time.time() - 60,) * 2)
    digest, content = cache.compute_digest(file)
    assert content == b"first"
    assert cache.compute_digest(file) == (digest, None)
    file.write_bytes(b"other")
    assert cache.compute_digest(file) == (ArrayCache().compute_digest(file)[0], b"other")


def test_a_file_that_changed_a_moment_ago_is_not_trusted(tmp_path: Path) -> None:
    """It may change again within one tick of the file system's clock."""
    cache, file = ArrayCache(tmp_path / "cache"), tmp_path / "mesh.stl"
    file.write_bytes(b"first")
    status = file.stat()
    cache.compute_digest(file)
    file.write_bytes(b"other")
    os.utime(file, ns=(status.st_atime_ns, status.st_mtime_ns))
    assert cache.compute_digest(file)[1] == b"other"


def test_what_was_used_last_is_kept(tmp_path: Path) -> None:
    cache = ArrayCache(tmp_path)
    for number in range(4):
        cache.entry("kind", f"{KEY}{number}")["part"] = {"a": np.zeros(1000)}
    for age, file in enumerate(files_of(tmp_path)):
        os.utime(file, (time.time() - 10_000 * (age + 1),) * 2)
    assert "part" in ArrayCache(tmp_path).entry("kind", f"{KEY}3")  # the oldest, used now
    size = files_of(tmp_path)[0].stat().st_size
    cache.trim(2 * size)
    assert [f.parent.name[-1] for f in files_of(tmp_path)] == ["0", "3"]
    cache.clear()
    assert not files_of(tmp_path, "*.*")


def test_a_use_is_noted_once_an_hour(tmp_path: Path) -> None:
    cache = ArrayCache(tmp_path)
    cache.entry("kind", KEY)["part"] = {"a": np.zeros(10)}
    (file,) = files_of(tmp_path)
    for age, is_noted in ((60, False), (4000, True)):
        os.utime(file, (before := time.time() - age,) * 2)
        assert "part" in ArrayCache(tmp_path).entry("kind", KEY)
        assert (file.stat().st_mtime > before + 1) is is_noted


def test_an_entry_goes_as_a_whole(tmp_path: Path) -> None:
    """Only one of its files may have been read of late."""
    cache = ArrayCache(tmp_path)
    for number in range(2):
        entry = cache.entry("kind", f"{KEY}{number}")
        entry["small"], entry["large"] = {"a": np.zeros(10)}, {"a": np.zeros(5000)}
    for file in files_of(tmp_path):
        os.utime(file, (time.time() - 10_000 - 100 * (file.parent.name[-1] == "0"),) * 2)
    assert "small" in ArrayCache(tmp_path).entry("kind", f"{KEY}0")
    cache.trim(60_000)
    assert [f.parent.name[-1] for f in files_of(tmp_path)] == ["0", "0"]
    assert len([folder for folder in files_of(tmp_path, f"{KEY[2:]}*") if folder.is_dir()]) == 1


def test_what_others_keep_in_the_folder_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("URDFCHECK_CACHE_DIR", str(tmp_path))
    (tmp_path / "thesis.txt").write_text("mine")
    assert main(["cache", "clear"]) == 0
    assert (tmp_path / "thesis.txt").exists()


def test_a_user_without_a_home_has_no_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    import platformdirs

    def homeless(*_: object, **__: object) -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("URDFCHECK_CACHE_DIR")
    monkeypatch.setattr(platformdirs, "user_cache_path", homeless)
    assert find_default_folder() is None


def _fill(folder: Path) -> None:
    for turn in range(50):
        entry = ArrayCache(folder).entry("kind", KEY)
        entry["part"] = {"a": np.full(5000, turn)}
        values = ArrayCache(folder).entry("kind", KEY).get("part", {}).get("a")
        assert values is None or (len(values) == 5000 and (values == values[0]).all())


def test_several_processes_write_one_entry(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(Path(__file__).parents[2])  # where the new processes find this module
    workers = [multiprocessing.get_context("spawn").Process(target=_fill, args=(tmp_path,)) for _ in range(3)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert [worker.exitcode for worker in workers] == [0, 0, 0]
    assert [file.name for file in files_of(tmp_path, "*") if file.is_file()] == [
        "part.npz"
    ]  # nothing half written is left


def test_a_mesh_comes_back_as_it_was_measured(tmp_path: Path) -> None:
    cold = measure_mesh(WHEEL.read_bytes(), "stl", ArrayCache(tmp_path).entry("meshes", KEY))
    assert len(cold.components) == 1
    assert cold.hull.volume > 0
    warm = restore_mesh_facts(ArrayCache(tmp_path).entry("meshes", KEY))
    assert warm is not None
    for name in ("vertices", "faces", "bounds", "com", "covariance", "surface_covariance", "components"):
        np.testing.assert_array_equal(getattr(warm, name), getattr(cold, name), err_msg=name)
    assert (warm.volume, warm.area, warm.watertight) == (cold.volume, cold.area, cold.watertight)
    np.testing.assert_array_equal(warm.hull.vertices, cold.hull.vertices)


@pytest.mark.parametrize("damage", ["lost", "corrupt"])
def test_a_mesh_of_which_a_part_is_lost_is_measured_again(tmp_path: Path, damage: str) -> None:
    data = WHEEL.read_bytes()
    cold = measure_mesh(data, "stl", ArrayCache(tmp_path).entry("meshes", KEY))
    (surface,) = files_of(tmp_path, "surface.npz")
    surface.unlink() if damage == "lost" else surface.write_bytes(b"PK")
    parts = ArrayCache(tmp_path).entry("meshes", KEY)
    warm = restore_mesh_facts(parts, lambda: measure_mesh(data, "stl", parts))
    assert warm is not None
    np.testing.assert_array_equal(warm.vertices, cold.vertices)
    np.testing.assert_array_equal(ArrayCache(tmp_path).entry("meshes", KEY)["surface"]["faces"], cold.faces)


def test_a_mesh_that_could_not_be_read_is_remembered_as_such(tmp_path: Path) -> None:
    with pytest.raises(MeshError) as first:
        measure_mesh(b"", "stl", ArrayCache(tmp_path).entry("meshes", KEY))
    with pytest.raises(MeshError) as again:
        restore_mesh_facts(ArrayCache(tmp_path).entry("meshes", KEY))
    assert (again.value.reason_id, again.value.message) == (first.value.reason_id, first.value.message)


def test_the_command_says_where_and_how_much_and_clears(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("URDFCHECK_CACHE_DIR", str(tmp_path))
    ArrayCache(find_default_folder()).entry("kind", KEY)["part"] = {"a": np.zeros(10)}
    assert main(["cache", "info"]) == 0
    said = capsys.readouterr().out
    assert str(tmp_path) in said
    assert "1 file, " in said
    assert main(["cache", "clear"]) == 0
    assert not files_of(tmp_path)


@pytest.mark.parametrize("flags", [[], ["--no-cache"]])
@pytest.mark.usefixtures("one_process")
def test_a_run_keeps_measurements_unless_told_not_to(
    flags: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("URDFCHECK_CACHE_DIR", str(tmp_path))
    model = str(FIXTURES / "car-3" / "urdf" / "car-3.urdf")
    outputs = []
    for _ in range(2):
        main([model, "--format", "json", "--tier", "mesh", *flags])
        outputs.append([line for line in capsys.readouterr().out.splitlines() if '"seconds"' not in line])
    assert outputs[0] == outputs[1]  # cold and warm say the same
    assert bool(files_of(tmp_path)) == (not flags)


def test_bodies_are_compared_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    box = trimesh.creation.box((1, 1, 1))
    inwards = trimesh.creation.box((0.5, 0.5, 0.5), transform=trimesh.transformations.translation_matrix((3, 0, 0)))
    inwards.invert()
    data = trimesh.util.concatenate([box, inwards]).export(file_type="stl")
    cold = measure_mesh(data, "stl", ArrayCache(tmp_path).entry("meshes", KEY))
    assert cold.has_mixed_orientation
    monkeypatch.setattr("urdfcheck.facts.mesh.winding.has_body_against", None)
    warm = restore_mesh_facts(ArrayCache(tmp_path).entry("meshes", KEY))
    assert warm is not None
    assert warm.has_mixed_orientation
