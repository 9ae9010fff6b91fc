"""Makes fixtures/hostile/README.md: ``python tools/make_hostile_table.py``.

What urdfcheck says is taken from a run. What the plain tools do is kept in fixtures/hostile/plain.json and only made anew with
``--plain``: each of them runs in a process of its own with 10 s, 2 GiB and a copy of the files. Among them are files that run
commands (they touch a file called ``marker``), so do it where that is harmless.
"""

from __future__ import annotations

import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import tomli

from urdfcheck.output.shared.escaping import escape_one_line

ROOT = Path(__file__).parent.parent
FOLDER = ROOT / "fixtures" / "hostile"
SECONDS, GIBIBYTES = 10, 2
SECRET = "hostile-secret-0123456789"
COMMANDS = {
    "xacro": [sys.executable, "-c", "import xacro; xacro.main()"],
    "check_urdf": ["check_urdf"],
    "trimesh": [sys.executable, "-c", "import sys, trimesh; print(trimesh.load(sys.argv[1]))"],
}

INTRODUCTION = """\
# Hostile files

Files that a stranger could put into a pull request: each attacks the program that checks it. `manifest.toml` lists them;
`tests/hostile_files.py` makes those that a repository cannot hold (pipes, links, names that are not text, very large ones)
and `tests/test_hostile.py` checks all of them through the command: what it finds, that nothing ran, that no file outside and no
secret of the environment is in any output, and that no output holds a character or a line that a terminal, a browser or a CI
system would obey.

**Some of these files run commands in other tools.** The commands only touch a file called `marker` in the working directory.

This page is made by `tools/make_hostile_table.py`. What the other tools do was seen with {versions}, each with {seconds} s of
processor time, {memory} GiB of memory and a copy of the files.
"""


def attacks() -> list[dict[str, Any]]:
    """The entries of the manifest."""
    found: list[dict[str, Any]] = tomli.loads((FOLDER / "manifest.toml").read_text(encoding="utf-8"))["attack"]
    return found


def found(report: Mapping[str, Any], attack: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The findings of a report in the files of an attack, each with its ``place`` as the manifest writes it."""
    start = f"hostile/{attack['id']}/"
    findings = []
    for finding in report["findings"]:
        location = finding["location"]
        if location is not None and location["file"].startswith(start):
            place = f"{location['file'][len(start) :]}:{location['line']}"
            findings.append({**finding, "place": place.replace("\n", "\\n")})
    return findings


def meant(expected: str, findings: Iterable[dict[str, Any]]) -> dict[str, Any] | None:
    """The finding that an entry of ``finds`` means; it may leave out the line, the file too, and the code's last digit."""
    code, _, place = expected.partition(" ")
    for finding in findings:
        if finding["code"].startswith(code) and finding["place"].startswith(place):
            return finding
    return None


def table(report: Mapping[str, Any]) -> str:
    """The text of fixtures/hostile/README.md from the JSON report of a run on all of them."""
    plain = json.loads((FOLDER / "plain.json").read_text(encoding="utf-8"))
    versions = ", ".join(f"{tool} {version}" for tool, version in plain["versions"].items())
    parts = [INTRODUCTION.format(versions=versions, seconds=SECONDS, memory=GIBIBYTES)]
    kind = None
    for attack in attacks():
        if attack["kind"] != kind:
            kind = attack["kind"]
            parts.append(f"\n## {kind[0].upper()}{kind[1:]}\n\n| attack | other tools | urdfcheck |\n|---|---|---|\n")
        others = "<br>".join(f"{tool}: {what}" for tool, what in plain["results"].get(attack["id"], {}).items())
        here = found(report, attack)
        own = "<br>".join(_said(meant(expected, here), expected) for expected in attack["finds"])
        parts.append(
            f"| {attack['how']} (`{attack['id']}`) | {others or '—'} | {own or 'No finding: it does nothing here.'} |\n"
        )
    return "".join(parts)


def _said(finding: Mapping[str, Any] | None, expected: str) -> str:
    if finding is None:
        return f"{expected}: missing"
    message = finding["message"]
    if expected.startswith("URC90 "):
        return "**URC905** or **URC906**: stopped by whichever limit is reached first"
    if finding["code"] == "URC906":  # where and after how many calls is a matter of the machine
        return f"**{finding['code']}**: the check is stopped when its time is over"
    # Paths are relative to the working directory, which lies deeper on one machine than on another.
    message = re.sub(r"(\.\./)+etc/", "/etc/", message)
    return f"**{finding['code']}** `{finding['place']}`: {_cell(message)}"


def _cell(text: str, most: int = 160) -> str:
    text = escape_one_line(text)
    text = text if len(text) <= most else text[:most].rstrip() + "…"
    return re.sub(r"([\\`*_{}\[\]<>|#$&~])", r"\\\1", text)


# -- runs --------------------------------------------------------------------------------------------------------------


def run(hostile: Path, secret: str, *words: str, cwd: Path | None = None) -> subprocess.CompletedProcess[bytes]:
    """urdfcheck on hostile files in a separate process, with a secret in its environment."""
    environment = {**os.environ, "URDFCHECK_HOSTILE_SECRET": secret, "COLUMNS": "40"}
    limits = ("--timeout", "5", "--memory", "3000", "--no-cache")
    words = (*words, *limits, hostile.name)
    return subprocess.run(
        [sys.executable, "-m", "urdfcheck", *words],
        cwd=hostile.parent if cwd is None else cwd,
        capture_output=True,
        env=environment,
        timeout=300,
    )


def _limited() -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 1))
    resource.setrlimit(resource.RLIMIT_AS, (GIBIBYTES << 30, GIBIBYTES << 30))
    resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 28, 1 << 28))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def plain_outcome(tool: str, file: Path) -> str:
    """What a tool does with a file, in a few words."""
    for marker in file.parent.glob("marker*"):
        marker.unlink()
    environment = {"PATH": os.environ["PATH"], "HOME": str(file.parent), "URDFCHECK_HOSTILE_SECRET": SECRET}
    with tempfile.TemporaryFile() as out:
        try:
            done = subprocess.run(
                [*COMMANDS[tool], file.name],
                cwd=file.parent,
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=out,
                env=environment,
                preexec_fn=_limited,
                timeout=4 * SECONDS,
            ).returncode
        except subprocess.TimeoutExpired:
            done = None
        out.seek(0)
        said = out.read(1 << 24)
    if any(file.parent.glob("marker*")):
        return "**runs the command**"
    if SECRET.encode() in said:
        return "**prints the secret**"
    if b"root:x:" in said:
        return "**prints /etc/passwd**"
    if done is None or done in {-9, -24}:
        return f"**does not end in {SECONDS} s**"
    # xacro prints of an exception its text, and that of a MemoryError is empty.
    if re.search(rb"^error: $|MemoryError|bad_alloc|Unable to allocate", said, re.MULTILINE):
        return f"**takes more than {GIBIBYTES} GiB**"
    if done < 0:
        return f"**crashes** (signal {-done})"
    return "accepts it" if done == 0 else "refuses it"


def plain_results(hostile: Path) -> dict[str, dict[str, str]]:
    """What each tool does with the file of each attack that is meant for it."""
    results: dict[str, dict[str, str]] = {}
    for attack in attacks():
        folder = hostile / attack["id"]
        meshes = sorted(folder.glob("part.*")) if not (folder / "part.xacro").exists() else []
        jobs = [("trimesh", mesh) for mesh in meshes]
        if not meshes and (folder / "robot.urdf.xacro").exists():
            jobs = [("xacro", folder / "robot.urdf.xacro")]
        elif not meshes and (folder / "robot.urdf").exists() and not list(folder.glob("*.launch*")):
            jobs = [("check_urdf", folder / "robot.urdf")]
        if attack["id"] != "shape-links":
            results[attack["id"]] = {tool: plain_outcome(tool, file) for tool, file in jobs}
    return results


def _versions() -> dict[str, str]:
    from importlib.metadata import version

    # The tool of urdfdom does not tell its version.
    query = ["dpkg-query", "-W", "-f", "${Version}", "liburdfdom-tools"]
    urdfdom = subprocess.run(query, capture_output=True, text=True).stdout or "of unknown version"
    return {"xacro": version("xacro"), "check_urdf": f"(urdfdom {urdfdom})", "trimesh": version("trimesh")}


def main() -> None:
    sys.path.insert(0, str(ROOT / "tests"))
    import hostile_files

    with tempfile.TemporaryDirectory() as temporary:
        hostile = hostile_files.build(Path(temporary), SECRET)
        if "--plain" in sys.argv:
            if shutil.which("check_urdf") is None:
                sys.exit("check_urdf is missing: apt-get install liburdfdom-tools")
            found = {"versions": _versions(), "results": plain_results(hostile)}
            text = json.dumps(found, indent=1, ensure_ascii=False) + "\n"
            (FOLDER / "plain.json").write_text(text, encoding="utf-8", newline="\n")
    with tempfile.TemporaryDirectory() as temporary:
        hostile = hostile_files.build(Path(temporary), SECRET)
        report = json.loads(run(hostile, SECRET, "--format", "json").stdout)
    (FOLDER / "README.md").write_text(table(report), encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
