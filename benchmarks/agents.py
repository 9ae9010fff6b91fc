"""Mend planted defects through the tools for language models alone: ``python benchmarks/agents.py [ROBOTS] [--editor]``.

In each of so many published robots (``URDFCHECK_CORPUS``; the smallest that are one URDF file with a moving joint) one defect
is planted. A client of the Model Context Protocol starts ``urdfcheck mcp`` in a copy of the robot and asks for the findings. It
takes the first that was not there before and has an edit, asks for the edit to be written, and checks again. No language model
takes part: what is measured is whether the answers suffice. Prints a table in Markdown.

With ``--editor`` a client of the Language Server Protocol does the same in a buffer: it takes the first action that a new
diagnostic is offered and that edits the model.
"""

from __future__ import annotations

import asyncio
import json
import math
import os
import re
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from lsprotocol import types
from mcp import Client, StdioServerParameters, stdio_client
from pygls.lsp.client import LanguageClient

from urdfcheck.server.documents import TextPositions

_ERROR = types.DiagnosticSeverity.Error
_HEAD = re.compile(r"^\[(\w+)\] (?:error|warning) (\w+) (.*)\n(.*)$", re.MULTILINE)
_NUMBER = r"-?[\d.]+(?:[eE][-+]?\d+)?"
_LIMIT = re.compile(rf'(<limit\b[^>]*?lower=")({_NUMBER})("[^>]*?upper=")({_NUMBER})(")')
_MOVING = re.compile(r'<joint\b[^>]*type="(?:revolute|continuous|prismatic)".*?</joint>', re.DOTALL)


def swap_limits(joint: str) -> str:
    """Exchange lower and upper."""
    return _LIMIT.sub(lambda m: f"{m[1]}{m[4]}{m[3]}{m[2]}{m[5]}" if float(m[2]) < float(m[4]) else m[0], joint)


def write_degrees(joint: str) -> str:
    """Write the limits of a revolute joint in degrees."""
    if 'type="revolute"' not in joint:
        return joint
    return _LIMIT.sub(
        lambda m: f"{m[1]}{math.degrees(float(m[2])):.4g}{m[3]}{math.degrees(float(m[4])):.4g}{m[5]}", joint
    )


def zero_axis(joint: str) -> str:
    """Write an axis of no length."""
    return re.sub(r'(<axis\s+xyz=")[^"]*', r"\g<1>0 0 0", joint)


def misspell_parent(joint: str) -> str:
    """Leave out the last letter but one of the parent's name."""
    return re.sub(r'(<parent\s+link="[^"]+)[^"]([^"]")', r"\1\2", joint)


def lengthen_axis(joint: str) -> str:
    """Write an axis of length ten."""
    return re.sub(
        r'(<axis\s+xyz=")([^"]*)', lambda m: m[1] + " ".join(f"{10 * float(v):g}" for v in m[2].split()), joint
    )


def negate_mass(link: str) -> str:
    """Write a negative mass."""
    return re.sub(r'(<mass\s+value=")([^-"])', r"\1-\2", link)


def negate_moment(link: str) -> str:
    """Write a negative moment of inertia."""
    return re.sub(r'(izz=")([^-"])', r"\1-\2", link)


def misspell_mesh(link: str) -> str:
    """Write the name of a mesh file in other letters."""
    return re.sub(
        r'(<visual>.*?<mesh\s+filename="[^"]*/)([^"/.]+)', lambda m: m[1] + m[2].swapcase(), link, flags=re.DOTALL
    )


_IN_JOINT: tuple[Callable[[str], str], ...] = (swap_limits, write_degrees, zero_axis, misspell_parent, lengthen_axis)
_IN_LINK: tuple[Callable[[str], str], ...] = (negate_mass, negate_moment, misspell_mesh)
_LINK = re.compile(r"<link\b[^>]*>.*?</link>", re.DOTALL)


def plant(text: str, operator: Callable[[str], str]) -> str:
    """Return the text with one defect, in the last element that can have it; the text itself where none can."""
    pattern = _MOVING if operator in _IN_JOINT else _LINK
    for match in reversed(list(pattern.finditer(text))):
        changed = operator(match[0])
        if changed != match[0]:
            return text[: match.start()] + changed + text[match.end() :]
    return text


def list_robots() -> Iterator[tuple[str, Path, Path]]:
    """Yield the id, folder and model of the robots that are one URDF file, the smallest first."""
    found = []
    for folder in map(Path, filter(None, os.environ.get("URDFCHECK_CORPUS", "").split(os.pathsep))):
        index = folder / "corpus.json"
        for entry in json.loads(index.read_text(encoding="utf-8")) if index.is_file() else ():
            model = folder / entry["entry"]
            if (
                model.suffix == ".urdf"
                and model.is_file()
                and _MOVING.search(model.read_text(encoding="utf-8", errors="replace"))
            ):
                root = folder / (entry["package_roots"] or [entry["entry"]])[0]
                found.append((sum(f.stat().st_size for f in root.rglob("*") if f.is_file()), entry["id"], root, model))
    for _, name, root, model in sorted(found):
        yield name, root, model


async def mend(folder: Path, model: str, planted: str) -> tuple[str, str]:
    """Plant a text and mend it through the tools. Return what came of it, and the finding that led to it."""
    words = ["-I", "-m", "urdfcheck", "mcp", str(folder)]
    async with Client(stdio_client(StdioServerParameters(command=sys.executable, args=words))) as client:

        async def ask(tool: str, **given: Any) -> str:
            answer = await client.call_tool(tool, given)
            return str(answer.content[0].text)

        file = folder / model
        sound = file.read_text(encoding="utf-8")
        before = {(code, headline) for _, code, _, headline in _HEAD.findall(await ask("check", paths=[model]))}
        file.write_text(planted, encoding="utf-8")
        new = [
            found for found in _HEAD.findall(await ask("check", paths=[model])) if (found[1], found[3]) not in before
        ]
        if not new:
            return "not found", ""
        for name, code, _, headline in new:
            said = await ask("fix", paths=[model], ids=[name], write=True)
            if "\nwritten\n" not in said:
                continue
            left = {(code, headline) for _, code, _, headline in _HEAD.findall(await ask("check", paths=[model]))}
            now = file.read_text(encoding="utf-8")
            if now == sound:
                return "mended, as it was", f"{code} {headline}"
            return ("mended, otherwise" if left <= before else "made other findings"), f"{code} {headline}"
        return "advice only", f"{new[0][1]} {new[0][3]}"


class Buffer:
    """A client of `urdfcheck server` with one document, of which the text is never saved."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.version = 0
        self.text = file.read_text(encoding="utf-8")
        self.shown: dict[str, list[types.Diagnostic]] = {}
        self.client = LanguageClient("benchmark", "1")

        @self.client.feature(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        def take(sent: types.PublishDiagnosticsParams) -> None:
            self.shown[sent.uri] = list(sent.diagnostics)

    async def start(self) -> None:
        """Start the server, and open the document."""
        await self.client.start_io(sys.executable, "-m", "urdfcheck", "server")
        root = self.file.parent.as_uri()
        await self.client.initialize_async(types.InitializeParams(types.ClientCapabilities(), root_uri=root))
        self.client.initialized(types.InitializedParams())
        item = types.TextDocumentItem(self.file.as_uri(), "xml", 0, self.text)
        self.client.text_document_did_open(types.DidOpenTextDocumentParams(item))

    async def type(self, text: str) -> None:
        """Replace the text."""
        self.version, self.text = self.version + 1, text
        document = types.VersionedTextDocumentIdentifier(self.version, self.file.as_uri())
        change = types.TextDocumentContentChangeWholeDocument(text)
        self.client.text_document_did_change(types.DidChangeTextDocumentParams(document, [change]))

    async def list_diagnostics(self) -> list[types.Diagnostic]:
        """Return the errors and warnings of the document, the errors first, once everything is checked."""
        await self.client.workspace_execute_command_async(types.ExecuteCommandParams("urdfcheck.check"))
        found = self.shown.get(self.file.as_uri(), [])
        known = [one for one in found if one.severity in {_ERROR, types.DiagnosticSeverity.Warning}]
        return sorted(known, key=lambda one: one.severity != _ERROR)

    async def repair(self, diagnostic: types.Diagnostic) -> bool:
        """Apply the first repair of a diagnostic that edits this document alone; return whether there is one."""
        document = types.TextDocumentIdentifier(self.file.as_uri())
        context = types.CodeActionContext([diagnostic])
        params = types.CodeActionParams(document, diagnostic.range, context)
        for action in await self.client.text_document_code_action_async(params) or ():
            changes = action.edit.changes if isinstance(action, types.CodeAction) and action.edit is not None else None
            is_repair = action.title.startswith(f"{diagnostic.code}: ")
            if is_repair and changes is not None and [*changes] == [self.file.as_uri()]:
                await self.type(self.apply(changes[self.file.as_uri()]))
                return True
        return False

    def apply(self, edits: Sequence[types.TextEdit]) -> str:
        """Return the text with some edits."""
        positions, text = TextPositions(self.text), self.text
        for edit in sorted(edits, key=lambda edit: edit.range.start, reverse=True):
            start, end = positions.find_offset(edit.range.start), positions.find_offset(edit.range.end)
            text = text[:start] + edit.new_text + text[end:]
        return text

    async def end(self) -> None:
        """End the server."""
        await self.client.shutdown_async(None)
        self.client.exit(None)
        await self.client.stop()


async def mend_in_editor(folder: Path, model: str, planted: str) -> tuple[str, str]:
    """Do the same as `mend` in the buffer of an editor."""
    buffer = Buffer(folder / model)
    await buffer.start()
    try:
        sound = buffer.text
        before = {(one.code, one.message) for one in await buffer.list_diagnostics()}
        await buffer.type(planted)
        new = [one for one in await buffer.list_diagnostics() if (one.code, one.message) not in before]
        if not new:
            return "not found", ""
        for diagnostic in new:
            if await buffer.repair(diagnostic):
                left = {(one.code, one.message) for one in await buffer.list_diagnostics()}
                led = f"{diagnostic.code} {diagnostic.message}"
                if buffer.text == sound:
                    return "mended, as it was", led
                return ("mended, otherwise" if left <= before else "made other findings"), led
        return "advice only", f"{new[0].code} {new[0].message}"
    finally:
        await buffer.end()


def main() -> int:
    """Print a row for each robot."""
    words = [word for word in sys.argv[1:] if word != "--editor"]
    way = mend_in_editor if "--editor" in sys.argv else mend
    wanted = int(words[0]) if words else 20
    operators = (*_IN_JOINT, *_IN_LINK)
    print("| robot | planted | outcome | led by |\n|---|---|---|---|", flush=True)
    done = 0
    for name, root, model in list_robots():
        text = model.read_text(encoding="utf-8", errors="replace")
        turn = [*operators[done % len(operators) :], *operators[: done % len(operators)]]
        operator = next((one for one in turn if plant(text, one) != text), None)
        if operator is None:
            continue
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder) / root.name
            shutil.copytree(root, copy, symlinks=True)
            (copy / ".git").mkdir(exist_ok=True)
            (copy / model.relative_to(root)).chmod(0o644)
            place = model.relative_to(root).as_posix()
            outcome, led = asyncio.run(way(copy, place, plant(text, operator)))
        print(f"| {name} | {operator.__name__} | {outcome} | {led} |", flush=True)
        done += 1
        if done == wanted:
            break
    return 0


if __name__ == "__main__":
    sys.exit(main())
