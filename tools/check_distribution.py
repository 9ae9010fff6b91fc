"""Build what is released, and try it as a user gets it: ``check_distribution.py FOLDER [--tag v0.2.0]``.

That is the sdist, the wheel of urdfcheck and that of urdfcheck-core. Both wheels are built from the sdist, which proves that it
is whole. Each is installed into a new environment, whose size and time are printed, and its command audits a copy of
car-3 from another folder, so that nothing of the checkout can help.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import time
import venv
import zipfile
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent
# What car-3 is known for; all of its findings are compared in the tests.
WHEEL_PITCH = "SYM001"
# What urdfcheck-core finds of it as well, in the source and in the meshes, and a rule of each library that it leaves out.
CORE_FINDS = (WHEEL_PITCH, "LCH002", "INR016")
CORE_SKIPS = {
    "XML014": "Pinocchio is not installed",
    "COL001": "coal is not installed",
}
# The sources of urdfcheck-core, in the checkout and in the sdist.
CORE = Path("packages", "urdfcheck-core")
# What a wheel must not hold: robots of the tests, and files that attack a linter.
FOREIGN = ("fixtures/", "tests/", "benchmarks/", "report-ui/", "editors/", "integrations/", "packaging/")


def list_faults_of_wheel(wheel: Path) -> list[str]:
    """Return what is missing in a wheel or too much in it."""
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
    pages = {f"urdfcheck/_rules/{page.name}" for page in (REPOSITORY / "rules").glob("*.md")}
    demos = REPOSITORY / "fixtures" / "demos"
    robots = {f"urdfcheck/_demos/{file.relative_to(demos).as_posix()}" for file in demos.rglob("*") if file.is_file()}
    samples = {f"urdfcheck/_vscode/{file.name}" for file in (REPOSITORY / "integrations/vscode").iterdir()}
    needed = {"urdfcheck/py.typed", "urdfcheck/output/report.schema.json", *pages, *robots, *samples}
    missing = [f"{wheel.name} lacks {name}" for name in sorted(needed - names)]
    return missing + [f"{wheel.name} holds {name}" for name in sorted(names) if name.startswith(FOREIGN)]


def list_faults_of_command(
    command: list[str], version: str, folder: Path, environment: dict[str, str] | None = None
) -> list[str]:
    """Return what an installed command does wrong, run in a folder that is not the checkout's."""
    copy, report = folder / "car-3", folder / "report.json"
    shutil.copytree(REPOSITORY / "fixtures" / "car-3", copy)
    faults = []

    def ask(*words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([*command, *words], cwd=folder, env=environment, capture_output=True, text=True)

    said = ask("--version").stdout.strip()
    if said != f"urdfcheck {version}":
        faults.append(f"--version says {said!r} instead of urdfcheck {version}")
    page = ask("rule", WHEEL_PITCH)
    if page.returncode or WHEEL_PITCH not in page.stdout:
        faults.append(f"rule {WHEEL_PITCH} does not show its page: {page.stderr}")
    demo = ask("demo", "quadruped", "-o", "demo")
    if demo.returncode or not (folder / "demo" / "report.html").is_file():
        faults.append(f"demo ended with {demo.returncode} and without its report: {demo.stderr}")
    html = folder / "report.html"
    done = ask("car-3", "--fail-on", "never", "-o", f"json={report}", "-o", f"html={html}")
    if done.returncode or not html.is_file():
        return [*faults, f"the audit of car-3 ended with {done.returncode}: {done.stderr}"]
    found = {finding["code"] for finding in json.loads(report.read_text(encoding="utf-8"))["findings"]}
    return faults if WHEEL_PITCH in found else [*faults, f"the audit of car-3 did not find {WHEEL_PITCH}"]


def list_faults_of_core(command: list[str], folder: Path, environment: dict[str, str] | None = None) -> list[str]:
    """Return what an installed command of urdfcheck-core does wrong: it finds what it can, and says what it skips."""
    copy, report = folder / "car-3-in-core", folder / "core.json"
    shutil.copytree(REPOSITORY / "fixtures" / "car-3", copy)

    def audit(*words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([*command, *words], cwd=folder, env=environment, capture_output=True, text=True)

    done = audit("check", copy.name, "-o", f"json={report}")
    if done.returncode != 1:
        return [f"urdfcheck-core ended with {done.returncode} instead of 1 for the errors of car-3: {done.stderr}"]
    said = json.loads(report.read_text(encoding="utf-8"))
    found = {finding["code"] for finding in said["findings"]}
    reasons = {skip["code"]: skip["reason"] for skip in said["skipped"]}
    faults = [f"urdfcheck-core did not find {code} in car-3" for code in CORE_FINDS if code not in found]
    for code, reason in CORE_SKIPS.items():
        if reason not in reasons.get(code, ""):
            faults.append(f"urdfcheck-core skipped {code} because {reasons.get(code)!r} instead of {reason!r}")
        if reason not in " ".join(done.stdout.split()):
            faults.append(f"the report of urdfcheck-core does not say that {reason}")
    accepted = audit("check", copy.name, "--tier", "mesh", "--fail-on", "never")
    if accepted.returncode or "not installed" in accepted.stdout:
        faults.append(
            f"urdfcheck-core --tier mesh ended with {accepted.returncode}: {accepted.stdout}{accepted.stderr}"
        )
    return faults


def build_distributions(folder: Path) -> tuple[Path, Path, Path]:
    """Build the sdist, and the wheels of urdfcheck and urdfcheck-core from it. Return wheel, wheel of core and sdist."""
    subprocess.run([sys.executable, "-m", "build", "--outdir", str(folder), str(REPOSITORY)], check=True)
    (wheel,), (sdist,) = folder.glob("urdfcheck-*.whl"), folder.glob("*.tar.gz")
    with tempfile.TemporaryDirectory() as unpacked:
        with tarfile.open(sdist) as archive:
            archive.extractall(unpacked, filter="data")
        sources = Path(unpacked, sdist.name.removesuffix(".tar.gz"), CORE)
        subprocess.run([sys.executable, "-m", "build", "--wheel", "--outdir", str(folder), str(sources)], check=True)
    (core,) = folder.glob("urdfcheck_core-*.whl")
    return wheel, core, sdist


def install_wheel(wheel: Path, folder: Path) -> Path:
    """Install a wheel with all that it needs into a new environment, and print what that took. Return its command."""
    venv.create(folder, with_pip=True)
    programs = folder / ("Scripts" if os.name == "nt" else "bin")
    began = time.perf_counter()
    subprocess.run([programs / "python", "-m", "pip", "install", "--quiet", "--no-cache-dir", str(wheel)], check=True)
    seconds = time.perf_counter() - began
    size = sum(file.lstat().st_size for file in folder.rglob("*") if file.is_file()) / 1e6
    print(f"{wheel.name}: installed in {seconds:.0f} s, {size:.0f} MB with pip", flush=True)
    return programs / "urdfcheck"


def main() -> int:
    """Exit code 1 where something is wrong with what would be released."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="where the sdist and the wheel are written; empty before")
    parser.add_argument("--tag", help="the tag of the release, which must name the version: v0.2.0")
    words = parser.parse_args()
    wheel, core, sdist = build_distributions(words.folder)
    subprocess.run([sys.executable, "-m", "twine", "check", "--strict", str(wheel), str(core), str(sdist)], check=True)
    version = wheel.name.split("-")[1]
    faults = list_faults_of_wheel(wheel) + list_faults_of_wheel(core)
    if words.tag is not None and words.tag != f"v{version}":
        faults.append(f"the tag is {words.tag}, and the version is {version} (urdfcheck/version.py)")
    with tempfile.TemporaryDirectory() as folder:
        command = install_wheel(wheel, Path(folder) / "environment")
        faults += list_faults_of_command([str(command)], version, Path(folder))
        light = install_wheel(core, Path(folder) / "core")
        faults += list_faults_of_core([str(light)], Path(folder))
    for fault in faults:
        print(fault, file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
