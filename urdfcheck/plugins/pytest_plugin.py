"""``pytest --urdfcheck``: the robot models below the given paths are tests, next to those of the code.

A test for each model, launch file and package, as ``urdfcheck check`` finds them with its configuration. All of them are
checked in one run of urdfcheck, in a process of its own; a test waits for its result. With pytest-xdist each of its processes
has one, and asks for the models one at a time. Everybody's pytest imports this module: without ``--urdfcheck`` it costs nothing.
"""

from __future__ import annotations

import contextlib
import json
import os
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import pytest

# Python looks for modules in the folder where `-c` is started: there is nothing but its own.
_PROGRAM = [sys.executable, "-c", "from urdfcheck.cli.commands.serve import serve; serve()"]
_KNOWN = (".urdf", ".xacro", ".launch", ".launch.xml", "_launch.xml", ".launch.py", "_launch.py", "package.xml")
_GRACE = 5.0


def pytest_addoption(parser: pytest.Parser) -> None:
    """The options of the plugin."""
    group = parser.getgroup("urdfcheck", "robot models as tests")
    group.addoption("--urdfcheck", action="store_true", help="check the robot models, a test for each (urdfcheck)")
    group.addoption(
        "--urdfcheck-fail-on", metavar="SEVERITY", help="error, warning, info or never: from here on a test fails"
    )
    group.addoption(
        "--urdfcheck-args", default="", metavar="WORDS", help='options of urdfcheck check, e.g. "--target gazebo"'
    )


def pytest_configure(config: pytest.Config) -> None:
    """Collect models only where that was asked for."""
    config.addinivalue_line("markers", "urdfcheck: a robot model that urdfcheck checks")
    if config.getoption("--urdfcheck"):
        config.pluginmanager.register(_ModelCollector(config), "urdfcheck-models")


class _ModelCollector:
    """The models of a session."""

    def __init__(self, config: pytest.Config) -> None:
        self.config = config
        self.checker: _CheckerProcess | None = None
        self.files: dict[str, list[tuple[int, str]]] = {}

    @pytest.hookimpl(tryfirst=True)
    def pytest_collection(self) -> None:
        self.checker = _CheckerProcess(self.config)
        if self.config.pluginmanager.has_plugin("dsession"):
            self.checker.end()  # pytest-xdist has its processes collect; here it is said what is wrong with the options
            return
        for number, unit in enumerate(self.checker.units):
            for home in self.checker.iter_home_files(unit):
                self.files.setdefault(home, []).append((number, unit["arguments"]))

    def pytest_collect_file(self, file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
        units = self.files.get(os.path.realpath(file_path)) if file_path.name.endswith(_KNOWN) else None
        return _ModelTestFile.from_parent(parent, path=file_path, units=units, checker=self.checker) if units else None

    def pytest_unconfigure(self) -> None:
        if self.checker is not None:
            self.checker.end()


class _ModelTestFile(pytest.File):
    """A file with models: more than one where the configuration names several sets of arguments."""

    def __init__(self, *, units: list[tuple[int, str]], checker: _CheckerProcess, **more: Any) -> None:
        super().__init__(**more)
        self.units = units
        self.checker = checker

    def collect(self) -> Iterator[pytest.Item]:
        for number, arguments in self.units:
            title = f"urdfcheck[{arguments}]" if arguments else "urdfcheck"
            yield _ModelItem.from_parent(self, name=title, number=number, checker=self.checker)


class _ModelItem(pytest.Item):
    """The check of one model."""

    def __init__(self, *, number: int, checker: _CheckerProcess, **more: Any) -> None:
        super().__init__(**more)
        self.number = number
        self.checker = checker
        self.add_marker("urdfcheck")

    def runtest(self) -> None:
        fared = self.checker.get_result(
            self.number, (i.number for i in self.session.items if isinstance(i, _ModelItem))
        )
        if fared["outcome"] == "skipped":
            pytest.skip(f"{self.path.name}: {fared['text']}")
        if fared["outcome"] != "passed":
            raise _ModelFailedError(fared["text"])
        self.add_report_section("call", "urdfcheck", fared["text"])

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], *_: Any) -> Any:
        """The findings, as the command prints them."""
        return str(excinfo.value) if isinstance(excinfo.value, _ModelFailedError) else super().repr_failure(excinfo)

    def reportinfo(self) -> tuple[Path, None, str]:
        return self.path, None, f"{self.name}: {self.parent.name if self.parent else ''}"


class _ModelFailedError(Exception):
    """A model has findings, or could not be checked; the text says it."""


class _CheckerProcess:
    """The process that does the work, and what it has answered so far."""

    def __init__(self, config: pytest.Config) -> None:
        folder = config.invocation_params.dir
        given = [folder / argument.partition("::")[0] for argument in config.args]
        self.paths = [path for path in given if path.is_dir() or path.name.endswith(_KNOWN)]
        # A process of pytest-xdist gets some of the tests, and does not know which.
        self.whole = not hasattr(config, "workerinput")
        self.asked: set[int] = set()
        self.answers: dict[int, dict[str, Any]] = {}
        self.units: list[dict[str, Any]] = []
        if not self.paths:
            return
        words = shlex.split(config.getoption("--urdfcheck-args"))
        if level := config.getoption("--urdfcheck-fail-on"):
            words.append(f"--fail-on={level}")
        if not self.whole:
            words.append("--jobs=1")
        terminal = config.get_terminal_writer()
        self.complaints = tempfile.TemporaryFile()  # noqa: SIM115 (it is open as long as the process)
        self.process = subprocess.Popen(
            _PROGRAM,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.complaints,
            cwd=os.path.dirname(os.__file__),
            encoding="utf-8",
            errors="surrogatepass",
        )
        self.send(
            {
                "words": [*words, "--", *map(str, self.paths)],
                "folder": str(folder),
                "width": terminal.fullwidth,
                "color": terminal.hasmarkup,
            }
        )
        first = self.receive()
        if "units" not in first:
            self.end()
            raise pytest.UsageError(f"urdfcheck: {first['error']}")
        self.units = first["units"]

    def iter_home_files(self, unit: dict[str, Any]) -> Iterator[str]:
        """The file that a unit is a test of, as a real path: its own if pytest comes there, else the one that leads to it."""
        own = os.path.join(unit["path"], "package.xml") if unit["kind"] == "package" else unit["path"]
        given = [os.path.realpath(path) for path in self.paths]
        for file in (own, *unit["launches"], *(path for path in given if os.path.isfile(path))):
            real = os.path.realpath(file)
            if any(real == path or real.startswith(path + os.sep) for path in given):
                yield real
                return

    def get_result(self, number: int, all_: Iterable[int]) -> dict[str, Any]:
        """How a unit fared; the first who asks has all of them checked."""
        if number not in self.asked:
            wanted = sorted({*all_} - self.asked) if self.whole else [number]
            self.asked.update(wanted)
            self.send(wanted)
        while number not in self.answers:
            answer = self.receive()
            if "error" in answer:
                raise _ModelFailedError(f"urdfcheck failed: {answer['error']}")
            self.answers[answer["unit"]] = answer
        return self.answers[number]  # it stays: a plugin may run a test twice

    def send(self, what: object) -> None:
        assert self.process.stdin is not None
        with contextlib.suppress(OSError):  # it has gone: its answer says so
            print(json.dumps(what), file=self.process.stdin, flush=True)

    def receive(self) -> dict[str, Any]:
        assert self.process.stdout is not None
        if line := self.process.stdout.readline():
            answer: dict[str, Any] = json.loads(line)
            return answer
        from urdfcheck.output.shared.inert import escape_for_log

        self.process.wait()
        self.complaints.seek(0)
        said = self.complaints.read().decode("utf-8", "replace").strip()
        return {
            "error": escape_for_log(said.rpartition("\n")[2])
            or f"its process ended (exit code {self.process.returncode})"
        }

    def end(self) -> None:
        if not self.paths:
            return
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.terminate()
        try:
            self.process.wait(_GRACE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        for file in (self.process.stdin, self.process.stdout, self.complaints):
            with contextlib.suppress(OSError):
                file.close()
