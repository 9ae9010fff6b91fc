"""What must hold of every input, whatever it is: one function, which the tests and the long runs share."""

from __future__ import annotations

import ast
import codecs
import contextlib
import io
import json
import os
import re
import sys
import tempfile
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from unittest import mock
from xml.parsers import expat

from fuzz import readings
from fuzz.cases import SECRET, Case
from jsonschema import Draft202012Validator

from urdfcheck.cli import FINDINGS, NOTHING, OK, compute_exit_code
from urdfcheck.core import Run, Severity
from urdfcheck.core.errors import ModelTimeout
from urdfcheck.facts.mesh.decode import decode_mesh
from urdfcheck.facts.mesh.decode_limits import MeshError
from urdfcheck.output import html, text
from urdfcheck.output.json import render as render_json
from urdfcheck.policy.limits import ResourceLimits
from urdfcheck.policy.policy import Policy
from urdfcheck.rules import load_rules
from urdfcheck.run.jobs import AuditOptions, Request
from urdfcheck.run.pipeline import IN_THIS_PROCESS, run
from urdfcheck.system import sandbox

# An input is small: the slowest sound one takes a twentieth of this. In MiB what it may add to the process.
SECONDS, MEMORY = 10.0, 600
# What only shows in a report when markup of a name is not escaped.
_MARKUP = re.compile("<fuzzmarkup|<img src=x", re.IGNORECASE)
_CONTROL = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")
_ODD = frozenset(
    {"os.system", "os.exec", "os.posix_spawn", "os.fork", "subprocess.Popen", "socket.connect", "socket.bind"}
)
_FORBIDDEN = ("/etc/passwd", "/dev/zero", "/dev/random", "/proc/self/environ", "/proc/self/mem")
# Expat has few encodings; that it lacks one says nothing about the text.
_ENCODINGS = {
    expat.errors.codes[expat.errors.XML_ERROR_UNKNOWN_ENCODING],
    expat.errors.codes[expat.errors.XML_ERROR_INCORRECT_ENCODING],
}

# So many findings of one rule and message are held against the schema in one process.
_ALIKE = 50

_validated: Counter[str] = Counter()
_seen: list[tuple[str, str]] | None = None


@dataclass(frozen=True, slots=True)
class Verdict:
    """``outcome``: clean | findings | nothing, or of a failure: exception | failure | exit | json | output | ran | time |
    memory | silent | died, with ``detail`` for a person and a ``key`` that failures with one cause share."""

    outcome: str
    detail: str = ""
    key: str = ""

    @property
    def failed(self) -> bool:
        return self.outcome not in {"clean", "findings", "nothing"}


def judge(case: Case, folder: Path, *, everything: bool = False) -> Verdict:
    """Write an input below ``folder``, check it, and say whether what must hold does.

    :param everything: also render text and HTML, and check twice more with a cache: the report has to be the same.
    """
    path = case.write(folder)
    before = {str(p) for p in folder.rglob("*") if "robot/self" not in str(p)}
    peak = _peak()
    try:
        with _watched() as events, _printed() as printed, sandbox.enforce_deadline(SECONDS):
            outcome = check(path, case.tier, scene=everything)
            problem = _wrong(outcome, everything=everything)
            if problem is None and everything:
                with tempfile.TemporaryDirectory() as cache:  # filled the first time, used the second
                    again = [check(path, case.tier, scene=True, cache=Path(cache)) for _ in range(2)]
                problem = _unsteady(outcome, again[0]) or _unsteady(outcome, again[1])
            said = printed()
    except ModelTimeout as error:
        return _failure("time", error)
    except Exception as error:
        return _failure("exception", error)
    if problem is not None:
        return problem
    odd = [f"{event} {what}" for event, what in events if _is_odd(event, what, folder)]
    if odd:
        return Verdict("ran", "; ".join(odd[:3]), odd[0].split(" ")[0])
    if said:
        warning = re.search(r"(\w+\.py:\d+): (\w+Warning)", said)
        return Verdict("output", f"printed: {said[:500]!r}", " ".join(warning.groups()) if warning else "printed")
    if _peak() - peak > MEMORY:
        return Verdict("memory", f"{_peak() - peak:.0f} MiB more than before", case.entry)
    if {str(p) for p in folder.rglob("*") if "robot/self" not in str(p)} != before:
        return Verdict("ran", "the folder has changed", "folder")
    if not any(f.severity is Severity.ERROR for f in outcome.findings) and outcome.units:
        with _printed(), sandbox.enforce_deadline(SECONDS):
            refused = _refused(case, path, outcome)
        if refused is not None:
            return Verdict("silent", f"no finding, but {refused}", re.sub(r"\d+|'[^']*'|\"[^\"]*\"", "…", refused)[:80])
    if not outcome.units:
        return Verdict("nothing")
    return Verdict("findings" if compute_exit_code(outcome, "error") == FINDINGS else "clean")


def check(path: Path, tier: str, *, scene: bool = False, cache: Path | None = None) -> Run:
    """The input as a run in this process."""
    root = path if path.is_dir() else path.parent
    codes, limits = frozenset(load_rules()), ResourceLimits(seconds=SECONDS)
    request = Request(
        paths=(path,),
        root=root,
        policy=Policy(codes=codes, tier=tier),
        options=AuditOptions(scene=scene, pairs=scene, samples=20, limits=limits),
        cache=cache,
    )
    with mock.patch.dict(os.environ, FUZZ_SECRET=SECRET):
        return run(request, IN_THIS_PROCESS)


# -- of every report -------------------------------------------------------------------------------------------------


def _wrong(outcome: Run, *, everything: bool) -> Verdict | None:
    crashed = [f for f in outcome.findings if f.code == "URC900"]
    if crashed:
        return Verdict("failure", crashed[0].message, _place(crashed[0].message))
    if outcome.failures:
        return Verdict("failure", "; ".join(outcome.failures), _place(outcome.failures[0]))
    stopped = [f for f in outcome.findings if f.code == "URC906" and f.message_id in {"time", "memory", "killed"}]
    if stopped:
        return Verdict(stopped[0].message_id, stopped[0].message, f"URC906 {stopped[0].message_id}")
    if compute_exit_code(outcome, "error") not in {OK, FINDINGS, NOTHING}:
        return Verdict("exit", f"exit code {compute_exit_code(outcome, 'error')}", "exit")
    written = render_json(outcome)
    try:
        written.encode()
        report = json.loads(written, parse_constant=_refuse_constant)
    except ValueError as error:
        return Verdict("json", str(error), str(error)[:60])
    report["findings"] = [f for f in report["findings"] if _is_new(f"{f.get('code')} {f.get('message_id')}")]
    report["skipped"] = [s for s in report["skipped"] if _is_new(f"skip {s.get('code')}")]
    for error in _schema().iter_errors(report):
        return Verdict("json", f"{error.json_path}: {error.message[:300]}", re.sub(r"\d+", "…", error.json_path))
    if SECRET in written or SECRET in repr(outcome.scenes):
        return Verdict("ran", "a secret is in the report", "secret")
    if everything:
        for name, written, wrong in (
            ("text", text.render(outcome, width=100, color=False), _CONTROL),
            ("html", html.render(outcome), _MARKUP),
        ):
            written.encode()
            found = wrong.search(written)
            if found:
                around = written[max(0, found.start() - 60) : found.end() + 20]
                return Verdict("output", f"{name}: {around!r}", f"{name} {found.group()!r}")
    return None


def _unsteady(first: Run, second: Run) -> Verdict | None:
    one, two = (re.sub(r'"seconds": [0-9.]+', '"seconds": 0', render_json(outcome)) for outcome in (first, second))
    # The text of a Python object is an address, in plain xacro as well; and where time stops an expansion differs.
    if one == two or " object at 0x" in one or '"URC906"' in one + two:
        return None
    differing = next((a, b) for a, b in zip(one.splitlines(), two.splitlines(), strict=False) if a != b)
    return Verdict("output", f"a second run differs: {differing}", "unsteady")


def _is_new(kind: str) -> bool:
    """Whether few of a kind were held against the schema: they are built alike, and it takes a third of the time."""
    _validated[kind] += 1
    return _validated[kind] <= _ALIKE


@cache
def _schema() -> Draft202012Validator:
    return Draft202012Validator(
        json.loads((files("urdfcheck.output") / "report.schema.json").read_text(encoding="utf-8"))
    )


def _refuse_constant(name: str) -> None:
    raise ValueError(f"{name} is no JSON")


def _failure(outcome: str, error: BaseException) -> Verdict:
    last = traceback.extract_tb(error.__traceback__)
    ours = [frame for frame in last if "/urdfcheck/" in frame.filename] or last
    key = f"{type(error).__name__} {Path(ours[-1].filename).name}:{ours[-1].lineno}"
    return Verdict(outcome, "".join(traceback.format_exception(error))[-4000:], key)


def _place(message: str) -> str:
    """The type of an error and where it came from, out of what a failure says."""
    found = re.search(r"(\w+(?:Error|Exception|Interrupt|Exit)\w*).*?(\([\w.<> ]+:\d+\))?$", message, re.DOTALL)
    return message[:80] if found is None else " ".join(filter(None, found.groups()))


def _peak() -> float:
    """The most memory that this process ever had, in MiB."""
    import resource  # of POSIX, like much of what is watched here

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


# -- what ran --------------------------------------------------------------------------------------------------------


@contextlib.contextmanager
def _watched() -> Iterator[list[tuple[str, str]]]:
    """What Python reports of its own doings meanwhile."""
    global _seen
    _install()
    events = _seen = []
    try:
        yield events
    finally:
        _seen = None


@contextlib.contextmanager
def _printed() -> Iterator[Callable[[], str]]:
    """What is written to the terminal meanwhile, by C++ as well: a report speaks for the check, and nothing else."""
    with tempfile.TemporaryFile() as sink, warnings.catch_warnings(), contextlib.ExitStack() as after:
        for stream, number in ((sys.stdout, 1), (sys.stderr, 2)):
            stream.flush()
            before = os.dup(number)
            after.callback(os.close, before)
            after.callback(os.dup2, before, number)
            os.dup2(sink.fileno(), number)

        def read() -> str:
            return os.pread(sink.fileno(), 10_000, 0).decode("utf-8", "replace")

        # Each time, not only the first: Python shows these two on the terminal.
        warnings.simplefilter("always", RuntimeWarning)
        warnings.simplefilter("always", SyntaxWarning)
        warnings.showwarning = _show  # pytest collects them
        with contextlib.redirect_stderr(_Unbuffered(2)), contextlib.redirect_stdout(_Unbuffered(1)):
            yield read


def _show(message: object, category: type[Warning], file: str, line: int, *_: object) -> None:
    os.write(2, f"{file}:{line}: {category.__name__}: {message}\n".encode())


class _Unbuffered(io.TextIOBase):
    """Text straight to a file descriptor, whatever stands in for the standard streams."""

    def __init__(self, number: int) -> None:
        self.number = number

    def write(self, written: str) -> int:
        os.write(self.number, written.encode("utf-8", "replace"))
        return len(written)


@cache
def _install() -> None:
    def note(event: str, arguments: tuple[object, ...]) -> None:
        if _seen is not None and (event == "open" or event in _ODD):
            _seen.append(
                (event, os.fsdecode(arguments[0]) if isinstance(arguments[0], (str, bytes)) else repr(arguments))
            )

    sys.addaudithook(note)


def _is_odd(event: str, what: str, folder: Path) -> bool:
    if event != "open":
        is_git = os.path.isabs(what) and os.path.basename(what) == "git"
        return event != "subprocess.Popen" or not is_git  # which files are ignored
    try:
        real = os.path.realpath(what)
    except ValueError:
        return False
    outside = (str(folder / "outside.yaml"), str(folder / "outside.xacro"), str(folder / "robot/pipe.stl"))
    return real in _FORBIDDEN or real in outside or "CANARY" in what


# -- independent parsers ---------------------------------------------------------------------------------------------


def _refused(case: Case, path: Path, outcome: Run) -> str | None:
    """Why this input should have had a finding, although there is no error: what another parser says of it."""
    if case.mesh:
        return _no_mesh(case, outcome)
    if case.reading:
        misread = any(f.message_id in {"misdeclared", "undecoded"} for f in outcome.findings)
        return None if misread else readings.find_difference(path)
    data = path.read_bytes() if path.is_file() else b""
    if path.suffix == ".urdf":
        return _malformed(data) or (_pinocchio(data, outcome) if case.tier == "full" else None)
    if path.suffix == ".xacro":
        plain = case.plain and b"$(find" not in data
        refused = _plain_xacro(path) if plain else None
        return refused or (_no_yaml(case.files["values.yaml"]) if b"'values.yaml'" in data else None)
    # What a launch file or a manifest lacks is no error of a model: there has to be a finding at all.
    quiet = not any(
        f.location.span is not None and f.location.span.file.endswith(_judged(path)) for f in outcome.findings
    )
    if path.suffix == ".py":
        return _no_python(data) if quiet else None
    return _malformed(data if path.is_file() else case.files["package.xml"]) if quiet else None


def _judged(path: Path) -> str:
    return path.name if path.is_file() else "package.xml"


def _malformed(data: bytes) -> str | None:
    """What expat says of bytes that are no XML without a document type."""

    def refuse(*_: object) -> None:
        raise ValueError("a document type")

    # Where a byte order mark and the declaration contradict each other, expat alone takes the declaration's word.
    parser = expat.ParserCreate("utf-8" if data.startswith(codecs.BOM_UTF8) else None)
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        return None if error.code in _ENCODINGS else f"expat refuses it: {error}"
    except ValueError as error:
        return None if "encoding" in str(error) else f"it has {error}"
    except LookupError:
        return None
    return None


def _pinocchio(data: bytes, outcome: Run) -> str | None:
    if any(f.code == "XML014" for f in outcome.findings):
        return None
    import pinocchio

    from urdfcheck.model.motion.pinocchio_model import capture_stderr

    with capture_stderr():
        try:
            pinocchio.buildModelFromXML(data.decode("utf-8", "surrogateescape"))
        except UnicodeError:
            return None
        except (ValueError, RuntimeError) as error:
            # What urdfdom reads and Pinocchio refuses is a warning of some rule.
            enough = "valid URDF model" not in str(error) and any(
                f.severity >= Severity.WARNING for f in outcome.findings
            )
            return None if enough else f"Pinocchio refuses it: {error}"
    return None


def _no_yaml(data: bytes) -> str | None:
    import yaml

    try:
        yaml.compose(data, Loader=yaml.SafeLoader)
    except (yaml.YAMLError, UnicodeError, RecursionError) as error:
        return f"yaml refuses it: {type(error).__name__}: {error}"
    return None


def _no_python(data: bytes) -> str | None:
    try:
        ast.parse(data)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        return f"Python refuses it: {type(error).__name__}: {error}"
    return None


def _plain_xacro(path: Path) -> str | None:
    import xacro

    with contextlib.redirect_stderr(io.StringIO()), contextlib.redirect_stdout(io.StringIO()):
        try:
            xacro.process_file(str(path))
        except Exception as error:
            return f"xacro refuses it: {type(error).__name__}: {error}"
        except SystemExit:
            return "xacro exits"
    return None


def _no_mesh(case: Case, outcome: Run) -> str | None:
    if any(f.code.startswith(("MSH", "PKG", "GEO", "URC")) for f in outcome.findings):
        return None
    import trimesh

    kind, data = case.mesh.rpartition(".")[2].lower(), case.files[case.mesh]
    data = data.replace(b"\r", b"\n") if kind in {"obj", "off"} else data  # trimesh knows one end of a line
    try:
        decode_mesh(data, kind)
    except MeshError as error:
        return f"the mesh {error}"
    # What other readers refuse (a texture coordinate that is no number) may still be a surface; no triangle is none.
    try:
        parts = trimesh.load_scene(io.BytesIO(data), file_type=kind).geometry.values()
    except Exception:
        return None
    return None if sum(len(part.faces) for part in parts) else "trimesh finds no triangle in the mesh"
