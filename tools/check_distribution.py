"""Build the wheel and the sdist, and try them as a user gets them: ``check_distribution.py FOLDER [--tag v0.2.0]``.

The wheel is built from the sdist, which proves that the sdist is whole. It is installed into an environment of its own, and its
command audits a copy of car-3 from another folder, so that nothing of the checkout can help.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import venv
import zipfile
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent
# What car-3 is known for; all of its findings are compared in the tests.
WHEEL_PITCH = "SYM001"
# What a wheel must not hold: robots of the tests, and files that attack a linter.
FOREIGN = ("fixtures/", "tests/", "benchmarks/", "report-ui/", "integrations/", "packaging/")


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


def build_distributions(folder: Path) -> tuple[Path, Path]:
    """Build the sdist, and the wheel from it. Return both."""
    subprocess.run([sys.executable, "-m", "build", "--outdir", str(folder), str(REPOSITORY)], check=True)
    (wheel,), (sdist,) = folder.glob("*.whl"), folder.glob("*.tar.gz")
    return wheel, sdist


def install_wheel(wheel: Path, folder: Path) -> Path:
    """Install a wheel with all that it needs into a new environment. Return its command."""
    venv.create(folder, with_pip=True)
    programs = folder / ("Scripts" if os.name == "nt" else "bin")
    subprocess.run([programs / "python", "-m", "pip", "install", "--quiet", str(wheel)], check=True)
    return programs / "urdfcheck"


def main() -> int:
    """Exit code 1 where something is wrong with what would be released."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="where the sdist and the wheel are written; empty before")
    parser.add_argument("--tag", help="the tag of the release, which must name the version: v0.2.0")
    words = parser.parse_args()
    wheel, sdist = build_distributions(words.folder)
    subprocess.run([sys.executable, "-m", "twine", "check", "--strict", str(wheel), str(sdist)], check=True)
    version = wheel.name.split("-")[1]
    faults = list_faults_of_wheel(wheel)
    if words.tag is not None and words.tag != f"v{version}":
        faults.append(f"the tag is {words.tag}, and the version is {version} (urdfcheck/version.py)")
    with tempfile.TemporaryDirectory() as folder:
        command = install_wheel(wheel, Path(folder) / "environment")
        faults += list_faults_of_command([str(command)], version, Path(folder))
    for fault in faults:
        print(fault, file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
