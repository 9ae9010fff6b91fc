"""The memory of the process that puts the report together does not grow with the models that share a file."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from conftest import check
from conftest import command as urdfcheck

from urdfcheck.core.findings import iter_occurrences
from urdfcheck.run import findings, report_sizes, source_texts
from urdfcheck.run.jobs import UnitReport
from urdfcheck.run.source_texts import SourceTexts, limit_texts
from urdfcheck.system import process_pool
from urdfcheck.system.process_pool import Worker, WorkerDiedError

pytestmark = [pytest.mark.slow, pytest.mark.skipif(sys.platform == "win32", reason="resource is a module of POSIX")]

XMLNS = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="9"/></inertial>'


def write_models(folder: Path, count: int, *, large: int, shared: bool) -> None:
    """Models of some bytes, each with an error in a file with so many characters of four bytes."""
    folder.mkdir()
    comment = "<!-- \U0001f600 " + "x" * large + " -->"
    macro = f'<xacro:macro name="m"><link name="a">{INERTIAL}</link></xacro:macro>'
    for index in range(count):
        name = "shared.xacro" if shared else f"own{index}.xacro"
        (folder / name).write_text(f"<robot {XMLNS}>{macro}<!-- {'' if shared else index} -->{comment}</robot>")
        (folder / f"m{index}.urdf.xacro").write_text(
            f'<robot name="r{index}" {XMLNS}><xacro:include filename="{name}"/><xacro:m/></robot>'
        )


def measure_peak(folder: Path) -> int:
    """The most memory that the parent takes, in bytes."""
    program = (
        "import resource, sys; from urdfcheck import cli; cli.main(sys.argv[1:]);"
        "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == 'darwin' else 1024), file=sys.stderr)"
    )
    words = [str(folder), "--tier", "source", "--no-cache", "--jobs", "1", "-q"]
    done = subprocess.run([sys.executable, "-c", program, *words], capture_output=True, text=True)
    assert done.stdout.count("INR003"), done.stderr
    return int(done.stderr.split()[-1])


def test_the_parent_keeps_a_file_of_many_models_once(tmp_path: Path) -> None:
    size = 2 * 1024**2
    write_models(tmp_path / "few", 2, large=size, shared=True)
    write_models(tmp_path / "many", 10, large=size, shared=True)
    more = measure_peak(tmp_path / "many") - measure_peak(tmp_path / "few")
    assert more < 2 * 4 * size, "eight models more, and each had four bytes a character"


def test_beyond_the_bound_findings_come_without_their_lines_and_the_report_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_models(tmp_path / "models", 3, large=10_000, shared=False)
    monkeypatch.setattr(source_texts, "MAX_RUN_TEXTS", 100_000)  # two of the three fit
    words = ["models", "--tier", "source", "--no-cache", "--select", "INR003"]
    done = urdfcheck(*words, cwd=tmp_path)
    assert (done.stdout.count("✖ INR003"), done.stdout.count("^\n")) == (3, 2), "no finding is lost"
    said = "skipped URC905: a file is not quoted beside the findings: the texts of all files take more than 0 MiB"
    assert said in " ".join(done.stdout.split())
    monkeypatch.setattr(source_texts, "MAX_RUN_TEXTS", 10**9)
    done = urdfcheck(*words, cwd=tmp_path)
    assert (done.stdout.count("^\n"), "not quoted" in done.stdout) == (3, False)


def test_the_largest_texts_of_a_report_are_left_out_first(monkeypatch: pytest.MonkeyPatch) -> None:
    texts = {"large": "x" * 1_000, "small": "y" * 10, "middle": "z" * 100}
    assert limit_texts(texts) == (texts, "")
    monkeypatch.setattr(source_texts, "MAX_REPORT_TEXTS", 400)
    kept, said = limit_texts(texts)
    assert set(kept) == {"small", "middle"}
    assert said.startswith("a file is not quoted")


def test_equal_texts_are_one_object() -> None:
    store = SourceTexts()
    reports = [store.share(UnitReport(sources={name: "".join(["a", "b" * 100])}), name) for name in ("one", "two")]
    first, second = (text for report in reports for text in report.sources.values())
    assert first is second
    assert not any(report.skipped for report in reports)


def _answer(size: int) -> bytes:
    return b"x" * size


def test_an_answer_without_bound_ends_its_worker(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(process_pool, "MAX_ANSWER", 1_000_000)
    worker = Worker.start()
    worker.send_job(_answer, [100])
    assert worker.receive_answer() == b"x" * 100
    worker.send_job(_answer, [10_000_000])
    with pytest.raises(WorkerDiedError):
        worker.receive_answer()


# -- findings and scenes -----------------------------------------------------------------------------------------------


def write_noisy(folder: Path, links: int) -> Path:
    """A model with an error and with a warning of each of many links."""
    path = folder / "noisy.urdf"
    bodies = "".join(f'<link name="l{i}"><inertial><mass value="0"/></inertial></link>' for i in range(links))
    path.write_text(f'<robot name="r">{bodies}</robot>')
    return path


def test_findings_beyond_the_bound_of_a_model_are_counted_and_the_worst_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_noisy(tmp_path, 50)
    whole = check(path, tier="source")
    worst = max(finding.severity for finding in whole.findings)
    monkeypatch.setattr(findings, "MAX_FINDINGS_SIZE", 5_000)
    outcome = check(path, tier="source")
    listed, everything = (len(list(iter_occurrences(run.findings))) for run in (outcome, whole))
    assert 0 < listed < everything
    assert max(finding.severity for finding in outcome.findings) == worst
    told = [skip for skip in outcome.skipped if "more finding" in skip.reason]
    counted = sum(int(skip.reason.partition(" ")[0]) for skip in told)
    assert listed + counted == everything
    monkeypatch.setattr(findings, "MAX_FINDINGS_SIZE", 0)
    (left,) = check(path, tier="source").findings
    assert left.severity == worst


def test_findings_and_scenes_beyond_the_bound_of_a_run_are_left_out_and_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for count, name in enumerate("abc", start=20):  # what copies show is one finding
        (tmp_path / name).mkdir()
        write_noisy(tmp_path / name, count)
    monkeypatch.setattr(report_sizes, "MAX_RUN_FINDINGS", 4_000)
    outcome = check(tmp_path, tier="source", scene=True)
    assert len(outcome.scenes) == 3
    assert {finding.model.partition("/")[0] for finding in outcome.findings} == {"a", "b", "c"}, "one of each"
    assert any("those of all models take more" in skip.reason for skip in outcome.skipped)
    monkeypatch.setattr(report_sizes, "MAX_RUN_SCENES", 1)
    outcome = check(tmp_path, tier="source", scene=True)
    assert outcome.scenes == ()
    assert sum("not drawn" in skip.reason for skip in outcome.skipped) == 3
    monkeypatch.setattr(report_sizes, "MAX_SCENE", 1)
    assert sum("not drawn" in skip.reason for skip in check(tmp_path, tier="source", scene=True).skipped) == 3
