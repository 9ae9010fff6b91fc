"""Measure how soon an editor shows a finding after a key, against the command and against plain xacro.

``python benchmarks/editor.py MODEL…`` starts ``urdfcheck server``, opens the model, and toggles a link without a joint
in its buffer: each change makes the server send other diagnostics. The time is from the notification to the diagnostics, with the
pause of 0.035 or 0.1 s in which the server waits for more typing. All rows are medians of one run that takes turns. The processor
time of the server's processes (Linux) is about what an edit takes where nothing else runs, without the pause: one process after
the other uses nearly all of it. Of several models each has a line with the times of an edit, and the last line says how many are
within the budget. ``--arg NAME:=VALUE`` is an argument of the models.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import io
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from lsprotocol import types
from pygls.lsp.client import LanguageClient

from urdfcheck.source.package.finder import PackageFinder

# Seconds from a key to the findings, of a xacro with 30 links on a free machine.
BUDGET = 0.15
# Seconds in which the server has loaded what it needs.
LOADING = 10.0
LOOSE = '<link name="of_the_benchmark"/>'


def measure_seconds(work: Callable[[], object]) -> float:
    """Return the wall time of a function."""
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


def sum_processor_time(root: int) -> float:
    """Return the processor time in s of a process and all below it, ended ones included; 0 where /proc does not say it."""
    total, waiting = 0, [root]
    while waiting:
        process = waiting.pop()
        with contextlib.suppress(OSError):
            total += sum(map(int, Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[11:15]))
            waiting += map(int, Path(f"/proc/{process}/task/{process}/children").read_text().split())
    return total / os.sysconf("SC_CLK_TCK")


def expand_plainly(model: Path) -> None:
    """Expand a xacro file with xacro alone, in this process; it finds packages as urdfcheck does, without ROS."""
    import xacro
    import xacro.substitution_args as substitution

    substitution._eval_find = lambda name: str(PackageFinder(model).find(name))
    with contextlib.redirect_stderr(io.StringIO()):
        xacro.process_file(str(model)).toprettyxml(indent="  ")


class Editor:
    """A client that toggles the loose link and waits for what it is sent."""

    def __init__(self, model: Path, arguments: Sequence[str] = ()) -> None:
        self.model = model
        self.options = [word for argument in arguments for word in ("--arg", argument)]
        self.text = model.read_text(encoding="utf-8")
        self.version = 1
        self.sent = asyncio.Event()
        self.client = LanguageClient("benchmark", "1")
        self.client.feature(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)(lambda _: self.sent.set())

    async def start(self) -> None:
        """Start the server and wait until everything is checked, and its process has loaded what it needs."""
        await self.client.start_io(sys.executable, "-m", "urdfcheck", "server", *self.options)
        root = self.model.parent.as_uri()
        parameters = types.InitializeParams(capabilities=types.ClientCapabilities(), root_uri=root)
        await self.client.initialize_async(parameters)
        self.client.initialized(types.InitializedParams())
        item = types.TextDocumentItem(self.model.as_uri(), "xml", 1, self.text)
        self.client.text_document_did_open(types.DidOpenTextDocumentParams(item))
        await self.rest()
        await asyncio.sleep(LOADING)

    async def rest(self) -> None:
        """Wait until everything is checked."""
        await self.client.workspace_execute_command_async(types.ExecuteCommandParams("urdfcheck.check"))

    async def measure_edit(self) -> tuple[float, float]:
        """Return the time from an edit to the diagnostics of the source tier, and the processor time that it took."""
        self.version += 1
        text = self.text if self.version % 2 else self.text.replace("</robot>", f"{LOOSE}</robot>")
        document = types.VersionedTextDocumentIdentifier(self.version, self.model.as_uri())
        change = types.TextDocumentContentChangeWholeDocument(text)
        self.sent.clear()
        used, began = sum_processor_time(self.client._server.pid), time.perf_counter()
        self.client.text_document_did_change(types.DidChangeTextDocumentParams(document, [change]))
        await asyncio.wait_for(self.sent.wait(), 120)
        return time.perf_counter() - began, sum_processor_time(self.client._server.pid) - used

    async def end(self) -> None:
        """End the server."""
        await self.client.shutdown_async(None)
        self.client.exit(None)
        await self.client.stop()


async def measure(model: Path, repeats: int, arguments: Sequence[str]) -> dict[str, list[float]]:
    """Return the times of each row."""
    editor = Editor(model, arguments)
    await editor.start()
    times: dict[str, list[float]] = {"edit": [], "cpu": [], "check": [], "xacro": []}
    check = [sys.executable, "-m", "urdfcheck", "check", "--tier", "source", str(model)]
    for _ in range(repeats):
        seconds, processor_time = await editor.measure_edit()
        times["edit"].append(seconds)
        times["cpu"].append(processor_time)
        await editor.rest()
        times["check"].append(measure_seconds(lambda: subprocess.run(check, capture_output=True, check=False)))
        if model.name.endswith(".xacro"):
            times["xacro"].append(measure_seconds(lambda: expand_plainly(model)))
    await editor.end()
    return times


async def measure_edits(model: Path, repeats: int, arguments: Sequence[str]) -> list[tuple[float, float]]:
    """Return the time and the processor time of some edits, after one that counts for nothing."""
    editor = Editor(model, arguments)
    await editor.start()
    times = []
    for _ in range(repeats + 1):
        times.append(await editor.measure_edit())
        await editor.rest()
    await editor.end()
    return times[1:]


def print_edits(models: Sequence[Path], repeats: int, arguments: Sequence[str]) -> None:
    """Print the times of an edit of each model, and how many are within the budget."""
    middles = []
    for model in models:
        try:
            times = asyncio.run(measure_edits(model, repeats, arguments))
        except (asyncio.TimeoutError, OSError) as error:
            print(f"{'not measured':28} {model} ({type(error).__name__})")
            continue
        wall, processor = (statistics.median(column) for column in zip(*times, strict=True))
        middles.append(wall)
        print(f"{wall:6.3f} s, least {min(times)[0]:6.3f} s, processor time {processor:6.3f} s   {model}", flush=True)
    if middles:
        within = sum(middle <= BUDGET for middle in middles)
        print(f"{within} of {len(middles)} within {BUDGET} s; the median is {statistics.median(middles):.3f} s")


def main() -> None:
    """Print the medians and their ratios."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="+", type=Path)
    parser.add_argument("--repeats", type=int, default=11)
    parser.add_argument("--arg", action="append", default=[])
    options = parser.parse_args()
    models = [model.resolve() for model in options.models]
    if len(models) > 1:
        print_edits(models, options.repeats, options.arg)
        return
    times = asyncio.run(measure(models[0], options.repeats, options.arg))
    edit = statistics.median(times["edit"])
    for name, label in (
        ("edit", "edit to diagnostics, source tier, with the pause"),
        ("cpu", "processor time of this"),
        ("check", "urdfcheck check --tier source, a whole process"),
        ("xacro", "xacro alone, in a running Python"),
    ):
        if times[name]:
            middle = statistics.median(times[name])
            print(f"{label:55} {middle:7.3f} s   least {min(times[name]):7.3f} s   edit is {edit / middle:5.2f} of it")


if __name__ == "__main__":
    main()
