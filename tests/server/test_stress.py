"""Random edits while diagnostics are asked for: the server survives, and at rest it shows what the command reports.

``URDFCHECK_SERVER_EDITS`` is the number of edits of each robot. With ``URDFCHECK_CORPUS``, ten real robots are edited too.
"""

from __future__ import annotations

import contextlib
import json
import os
import random
import re
import shutil
import time
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest
from conftest import FIXTURES, command
from lsprotocol import types
from pygls.exceptions import JsonRpcException

from .editor import Editor

pytestmark = [pytest.mark.slow, pytest.mark.long]

EDITS = int(os.environ.get("URDFCHECK_SERVER_EDITS", "12"))
# Real robots of many kinds, by the ids of their corpus.
ROBOTS = (
    "PR2/pr2_common:pr2_no_arms",
    "frankaemika/franka_ros:panda",
    "ros/urdf_tutorial:08-macroed",
    "ros-simulation/gazebo_ros_demos:rrbot",
    "ROBOTIS-GIT/turtlebot3:turtlebot3_burger",
    "ridgeback/ridgeback:ridgeback",
    "joshnewans/articubot_one:robot",
    "TheRobotStudio/SO-ARM100:so100",
    "ros-industrial/fanuc:m10ia",
    "chvmp/robots:quadruped",
)
# Texts that matter to the parsers, and some that are more than one unit of UTF-16.
PIECES = (
    "<",
    ">",
    '"',
    "/>",
    "</link>",
    "${",
    "}",
    "$(arg ",
    "🤖",
    "é",
    "\n",
    " ",
    "1e9",
    "-",
    "0",
    "<!-- ",
    " -->",
    "&amp;",
)


def list_models() -> Iterator[object]:
    """The fixtures and the ten robots: the folder that is copied, and the model in it."""
    yield pytest.param(FIXTURES / "car-3", "urdf/car-3.urdf", id="car-3")
    yield pytest.param(FIXTURES / "car-3-fixed", "urdf/car_3.urdf.xacro", id="car-3-fixed")
    if "URDFCHECK_SERVER_EDITS" not in os.environ:
        return
    for folder in map(Path, filter(None, os.environ.get("URDFCHECK_CORPUS", "").split(os.pathsep))):
        entries = json.loads((folder / "corpus.json").read_text()) if (folder / "corpus.json").is_file() else []
        for entry in entries:
            if entry["id"] in ROBOTS:
                repository, _, model = entry["entry"].partition("/")
                yield pytest.param(folder / repository, model, id=entry["id"])


def mutate(text: str, chance: random.Random) -> str:
    """Insert, delete, repeat or replace a piece of a text."""
    start = chance.randrange(len(text) + 1)
    end = min(len(text), start + chance.choice((0, 1, 3, 30)))
    kind = chance.randrange(4)
    if kind == 0:
        return text[:start] + chance.choice(PIECES) + text[start:]
    if kind == 1:
        return text[:start] + text[end:]
    if kind == 2:
        return text[:end] + text[start:end] + text[end:]
    digit = next((i for i in range(start, len(text)) if text[i].isdigit()), None)
    return text if digit is None else text[:digit] + str(chance.randrange(10)) + text[digit + 1 :]


def list_reported(folder: Path, paths: list[Path]) -> list[tuple[str, str, str, int, int]]:
    """What the command reports on some files, in units of UTF-16: file, code, title, line and column."""
    done = command(*map(str, paths), "--format", "json", cwd=folder)
    found = []
    for finding in json.loads(done.stdout)["findings"]:
        if finding["suppressed"] or finding["location"] is None:
            continue
        for one in finding.get("occurrences") or [finding]:
            subjects = {subject["path"] for subject in one["subjects"]}
            # An editor shows it at each of the elements that it is about.
            others = [place["location"] for place in one.get("related", ()) if place["subject"] in subjects]
            for place in (one["location"], *others):
                line, units = _find_units(folder / place["file"], place)
                found.append((place["file"], finding["code"], one["headline"], line, units))
    return sorted(set(found))


def _find_units(path: Path, place: Mapping[str, int]) -> tuple[int, int]:
    """The line of a place, from 0, and the column in units of UTF-16."""
    text = path.read_bytes().decode("utf-8", "replace").replace("\r\n", "\n").replace("\r", "\n")
    before = text.split("\n")[place["line"] - 1][: place["column"] - 1]
    return place["line"] - 1, len(before.encode("utf-16-le")) // 2


def list_shown(editor: Editor) -> list[tuple[str, str, str, int, int]]:
    """What the editor shows of all files, as `list_reported` does; what has no place in a text is at its beginning."""
    editor.rest()
    found = []
    for uri, diagnostics in editor.client.diagnostics.items():
        name = os.path.relpath(uri.removeprefix("file://"), editor.folder)
        for one in diagnostics:
            at = one.range.start
            found.append((name, str(one.code), one.message, at.line, at.character))
    return sorted(set(found))


@pytest.mark.parametrize(("source", "model"), list(list_models()))
def test_random_edits_end_with_what_the_command_reports(source: Path, model: str, tmp_path: Path) -> None:
    chance = random.Random(model)
    folder = Path(shutil.copytree(source, tmp_path / source.name))
    editor = Editor(folder)
    path = folder / model
    original = editor.open(path)
    editor.rest()
    files = [path, *_list_included(original, folder)]
    for included in files[1:]:
        editor.open(included)
    originals = {file: editor.texts[file] for file in files}
    for number in range(EDITS):
        file = chance.choice(files)
        # Never far from a robot: most files that one types in parse.
        text = originals[file] if chance.random() < 0.3 else editor.texts[file]
        editor.type(file, mutate(text, chance))
        if chance.random() < 0.3:
            _ask(editor, file, chance)
        if chance.random() < 0.2:
            time.sleep(chance.random())
        if number % 100 == 99:
            _compare(editor, files)
    _compare(editor, files)
    editor.type(path, original)
    for file in files:
        editor.type(file, originals[file])
    _compare(editor, files)
    assert editor.end().returncode == 0


def _compare(editor: Editor, files: list[Path]) -> None:
    for file in files:
        editor.save(file)
    assert list_shown(editor) == list_reported(editor.folder, files)


def _list_included(text: str, folder: Path) -> list[Path]:
    """Some xacro files of the folder that a model names."""
    names = {name.rpartition("/")[2] for name in re.findall(r'filename="([^"]*)"', text)}
    return sorted(path for path in folder.rglob("*.xacro") if path.name in names)[:3]


def _ask(editor: Editor, path: Path, chance: random.Random) -> None:
    """Ask something about a random place; any answer is right that is one."""
    text = editor.texts[path]
    at = types.Position(chance.randrange(text.count("\n") + 1), chance.randrange(80))
    document = editor.identify(path)
    client = editor.client
    editor.wait(client.text_document_hover_async(types.HoverParams(document, at)))
    editor.wait(client.text_document_definition_async(types.DefinitionParams(document, at)))
    editor.wait(client.text_document_document_symbol_async(types.DocumentSymbolParams(document)))
    editor.wait(client.text_document_folding_range_async(types.FoldingRangeParams(document)))
    editor.wait(client.text_document_code_lens_async(types.CodeLensParams(document)))
    known = types.ReferenceContext(include_declaration=True)
    editor.wait(client.text_document_references_async(types.ReferenceParams(known, document, at)))
    if chance.random() < 0.3:
        with contextlib.suppress(JsonRpcException):  # a refusal
            editor.wait(client.text_document_rename_async(types.RenameParams(document, at, "renamed")))
    context = types.CodeActionContext([])
    editor.wait(client.text_document_code_action_async(types.CodeActionParams(document, types.Range(at, at), context)))
