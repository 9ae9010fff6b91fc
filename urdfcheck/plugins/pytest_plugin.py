"""``pytest --urdfcheck``: the robot models below the given paths become tests, next to those of the code.

There is one test for each model, launch file and package that ``urdfcheck check`` finds with its configuration. All of them
are checked in one run of urdfcheck in a separate process (:mod:`urdfcheck.plugins.pytest_service`); a test waits for its result.
With pytest-xdist each worker has such a process and requests one model at a time. pytest imports this module wherever urdfcheck
is installed: without ``--urdfcheck`` it must cost nothing.
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

# With `-c`, Python imports from its working directory: it is started in a folder with nothing but its own modules.
_PROGRAM = [sys.executable, "-c", "from urdfcheck.plugins.pytest_service import serve; serve()"]
_KNOWN = (".urdf", ".xacro", ".launch", ".launch.xml", "_launch.xml", ".launch.py", "_launch.py", "package.xml")
_GRACE = 5.0


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options of the plugin."""
    group = parser.getgroup("urdfcheck", "robot models as tests")
    group.addoption("--urdfcheck", action="store_true", help="check the robot models, a test for each (urdfcheck)")
    group.addoption(
        "--urdfcheck-fail-on", metavar="SEVERITY", help="error, warning, info or never: from here on a test fails"
    )
    group.addoption(
        "--urdfcheck-args", default="", metavar="WORDS", help='options of urdfcheck check, e.g. "--target gazebo"'
    )


def pytest_configure(config: pytest.Config) -> None:
    """Collect models if ``--urdfcheck`` is given."""
    config.addinivalue_line("markers", "urdfcheck: a robot model that urdfcheck checks")
    if config.getoption("--urdfcheck"):
        config.pluginmanager.register(_ModelCollector(config), "urdfcheck-models")


class _ModelCollector:
    """Collects the models of a session."""

    def __init__(self, config: pytest.Config) -> None:
        self.config = config
        self.checker: _CheckerProcess | None = None
        self.files: dict[str, list[tuple[int, str]]] = {}

    @pytest.hookimpl(tryfirst=True)
    def pytest_collection(self) -> None:
        self.checker = _CheckerProcess(self.config)
        if self.config.pluginmanager.has_plugin("dsession"):
            self.checker.end()  # the workers of pytest-xdist collect; here only wrong options are reported
            return
        for number, unit in enumerate(self.checker.units):
            for home in self.checker.iter_home_files(unit):
                self.files.setdefault(home, []).append((number, unit["arguments"]))

    def pytest_collect_file(self, file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
        units = self.files.get(os.path.realpath(file_path)) if file_path.name.lower().endswith(_KNOWN) else None
        if not units:
            return None
        names: dict[str, Any] = _escape_names(file_path, self.config.rootpath)
        return _ModelTestFile.from_parent(parent, path=file_path, units=units, checker=self.checker, **names)

    def pytest_unconfigure(self) -> None:
        if self.checker is not None:
            self.checker.end()


def _escape_names(path: Path, root: Path) -> dict[str, str]:
    """Return the names by which pytest prints a file whose own name a terminal or a CI system would obey; empty for any other."""
    from urdfcheck.output.shared.escaping import escape_for_log, escape_one_line

    typed = os.path.relpath(path, root).replace(os.sep, "/")
    shown = escape_for_log(escape_one_line(typed))
    if shown == typed:
        return {}
    for mark in "[]:":  # pytest takes an id apart at them
        shown = shown.replace(mark, f"\\x{ord(mark):02x}")
    return {"name": shown.rpartition("/")[2], "nodeid": shown}


class _ModelTestFile(pytest.File):
    """A file with a model, or several where the configuration names several sets of arguments."""

    def __init__(self, *, units: list[tuple[int, str]], checker: _CheckerProcess, **more: Any) -> None:
        super().__init__(**more)
        self.units = units
        self.checker = checker

    def collect(self) -> Iterator[pytest.Item]:
        for number, arguments in self.units:
            title = f"urdfcheck[{arguments}]" if arguments else "urdfcheck"
            yield _ModelItem.from_parent(self, name=title, number=number, checker=self.checker)


class _ModelItem(pytest.Item):
    """The test of one model."""

    def __init__(self, *, number: int, checker: _CheckerProcess, **more: Any) -> None:
        super().__init__(**more)
        self.number = number
        self.checker = checker
        self.add_marker("urdfcheck")

    def runtest(self) -> None:
        result = self.checker.get_result(
            self.number, (i.number for i in self.session.items if isinstance(i, _ModelItem))
        )
        if result["outcome"] == "skipped":
            pytest.skip(f"{self.get_shown_path().name}: {result['text']}")
        if result["outcome"] != "passed":
            raise _ModelFailedError(result["text"])
        self.add_report_section("call", "urdfcheck", result["text"])

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], *_: Any) -> Any:
        """Return the findings as the command prints them."""
        return str(excinfo.value) if isinstance(excinfo.value, _ModelFailedError) else super().repr_failure(excinfo)

    def reportinfo(self) -> tuple[Path, None, str]:
        return self.get_shown_path(), None, f"{self.name}: {self.parent.name if self.parent else ''}"

    def get_shown_path(self) -> Path:
        """Return the path of the file as it is printed."""
        names = _escape_names(self.path, self.config.rootpath)
        return self.config.rootpath / names["nodeid"] if names else self.path


class _ModelFailedError(Exception):
    """A model has findings, which the text lists, or could not be checked."""


class _CheckerProcess:
    """The process that checks the models, and its answers."""

    def __init__(self, config: pytest.Config) -> None:
        folder = config.invocation_params.dir
        given = [folder / argument.partition("::")[0] for argument in config.args]
        self.paths = [path for path in given if path.is_dir() or path.name.endswith(_KNOWN)]
        # A worker of pytest-xdist runs some of the tests and does not know which.
        self.runs_all_tests = not hasattr(config, "workerinput")
        self.asked: set[int] = set()
        self.answers: dict[int, dict[str, Any]] = {}
        self.units: list[dict[str, Any]] = []
        if not self.paths:
            return
        words = shlex.split(config.getoption("--urdfcheck-args"))
        if level := config.getoption("--urdfcheck-fail-on"):
            words.append(f"--fail-on={level}")
        if not self.runs_all_tests:
            words.append("--jobs=1")
        terminal = config.get_terminal_writer()
        self.error_file = tempfile.TemporaryFile()  # noqa: SIM115 (it is open as long as the process)
        self.process = subprocess.Popen(
            _PROGRAM,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.error_file,
            cwd=os.path.dirname(os.__file__),
            encoding="utf-8",
            errors="surrogatepass",
        )
        assert self.process.stdin is not None  # both are pipes
        assert self.process.stdout is not None
        self.stdin, self.stdout = self.process.stdin, self.process.stdout
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
        """Yield the real path of the file whose test a unit is: its own if pytest collects it, else one that leads to it."""
        own_file = os.path.join(unit["path"], "package.xml") if unit["kind"] == "package" else unit["path"]
        given = [os.path.realpath(path) for path in self.paths]
        for file in (own_file, *unit["launches"], *(path for path in given if os.path.isfile(path))):
            real = os.path.realpath(file)
            if any(real == path or real.startswith(path + os.sep) for path in given):
                yield real
                return

    def get_result(self, number: int, all_numbers: Iterable[int]) -> dict[str, Any]:
        """Return the result of a unit; the first request has all units checked."""
        if number not in self.asked:
            wanted = sorted({*all_numbers} - self.asked) if self.runs_all_tests else [number]
            self.asked.update(wanted)
            self.send(wanted)
        while number not in self.answers:
            answer = self.receive()
            if "error" in answer:
                raise _ModelFailedError(f"urdfcheck failed: {answer['error']}")
            self.answers[answer["unit"]] = answer
        return self.answers[number]  # kept, because a plugin may run a test twice

    def send(self, message: object) -> None:
        with contextlib.suppress(OSError):  # it has exited: receive() reports that
            print(json.dumps(message), file=self.stdin, flush=True)

    def receive(self) -> dict[str, Any]:
        if line := self.stdout.readline():
            answer: dict[str, Any] = json.loads(line)
            return answer
        from urdfcheck.output.shared.escaping import escape_for_log

        self.process.wait()
        self.error_file.seek(0)
        errors = self.error_file.read().decode("utf-8", "replace").strip()
        return {
            "error": escape_for_log(errors.rpartition("\n")[2])
            or f"its process ended (exit code {self.process.returncode})"
        }

    def end(self) -> None:
        if not self.paths:
            return
        self.process.terminate()
        try:
            self.process.wait(_GRACE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        for file in (self.stdin, self.stdout, self.error_file):
            with contextlib.suppress(OSError):
                file.close()
