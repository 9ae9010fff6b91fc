"""Runs a guide as a reader would: in an empty folder it writes the guide's files, applies its edits and calls its commands."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from conftest import command

from urdfcheck.cli.demo_robots import split_diff

_FENCE = re.compile(
    r"^```(?P<language>\w+)(?: file=(?P<file>\S+))?(?: exit=(?P<exit>\d))?\n(?P<text>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
_SECONDS = re.compile(r"\b\d+(?:\.\d+)? s\b")
LEFT_OUT = "…"
"""A line of its own: any number of lines that the guide does not show."""


@dataclass(frozen=True, slots=True)
class Step:
    """A command of a guide, with what it prints there."""

    line: str
    shown: tuple[str, ...]
    code: int


def run_guide(text: str, folder: Path) -> str:
    """Do all that a guide says in a folder; its files and commands are relative to where its last ``cd`` leads.

    :return: the guide with what the commands print now, where it shows all of it.
    :raises AssertionError: for another exit code, or where a part of what a command prints is shown and is not printed.
    """

    here = folder

    def do_fence(fence: re.Match[str]) -> str:
        nonlocal here
        file = here / fence["file"] if fence["file"] else None
        if file is not None and fence["language"] == "diff":
            before, after = split_diff(fence["text"])
            old = file.read_text(encoding="utf-8")
            assert old.count(before) == 1, f"{fence['file']} has these lines {old.count(before)} times:\n{before}"
            file.write_text(old.replace(before, after), encoding="utf-8")
        elif file is not None:
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(fence["text"], encoding="utf-8")
        elif fence["language"] == "console":
            printed = []
            for step in _read_steps(fence["text"], int(fence["exit"] or 0)):
                change = re.fullmatch(r"cd (\S+)", step.line)
                if change is not None:
                    here = (here / change[1]).resolve(strict=True)
                printed.append(f"$ {step.line}\n" if change is not None else _renew(step, here))
            start = fence.start("text") - fence.start()
            return f"{fence[0][:start]}{''.join(printed)}```"
        return fence[0]

    return _FENCE.sub(do_fence, text)


def _read_steps(text: str, code: int) -> list[Step]:
    """The commands of a block; the exit code is that of the last one."""
    blocks = re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]
    return [
        Step(lines[0], tuple(lines[1:]), code if number == len(blocks) else 0)
        for number, lines in enumerate((block.splitlines() for block in blocks), 1)
    ]


def _renew(step: Step, folder: Path) -> str:
    printed = _call(step, folder)
    if LEFT_OUT in step.shown:
        _ensure_shown_lines(step, printed)
        printed = [*step.shown]
    elif [_SECONDS.sub("", line) for line in printed] == [_SECONDS.sub("", line) for line in step.shown]:
        printed = [*step.shown]
    return "".join(f"{line}\n" for line in (f"$ {step.line}", *printed))


def _call(step: Step, folder: Path) -> list[str]:
    """Run a command; return the lines that it prints."""
    words = shlex.split(step.line)
    if words[0] == "urdfcheck" and not {"|", "&&"} & {*words}:
        done = command(*words[1:], cwd=folder)
    else:
        person = {f"GIT_{role}_{key}": value for role in ("AUTHOR", "COMMITTER") for key, value in _PERSON.items()}
        path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
        done = subprocess.run(
            ["bash", "-ec", step.line],
            cwd=folder,
            env={**os.environ, **person, "PATH": path, "GIT_CONFIG_GLOBAL": os.devnull},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
    said = f"{done.stdout}{done.stderr or ''}"
    assert done.returncode == step.code, f"{step.line}: exit code {done.returncode}, not {step.code}\n{said}"
    return [line.rstrip() for line in said.splitlines()]


_PERSON = {"NAME": "you", "EMAIL": "you@example.com", "DATE": "2026-01-02T03:04:05Z"}


def _ensure_shown_lines(step: Step, printed: list[str]) -> None:
    """Find the lines that a guide shows in what is printed, in their order and without gaps but those that it marks."""
    lines = [_SECONDS.sub("", line) for line in printed]
    parts = [[*part] for is_shown, part in groupby(step.shown, lambda line: line != LEFT_OUT) if is_shown]
    place = 0
    for number, part in enumerate(parts):
        wanted = [_SECONDS.sub("", line) for line in part]
        last = len(lines) - len(wanted)
        places: Iterable[int] = range(place, last + 1)
        if number == 0 and step.shown[0] != LEFT_OUT:
            places = [0]
        elif number == len(parts) - 1 and step.shown[-1] != LEFT_OUT:
            places = [last]
        found = next((i for i in places if i >= place and lines[i : i + len(wanted)] == wanted), None)
        assert found is not None, "\n".join(("$ " + step.line, "does not print", *part, "but", *printed))
        place = found + len(wanted)
