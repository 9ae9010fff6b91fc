"""Asks one program about files: ``serve.py ADAPTER SECONDS``, run by a Python that has the program, never by that of urdfcheck.

Reads paths from stdin, one a line, and prints a line of JSON for each. An adapter is a module of this folder with one function,
``ask(file)``: what the program reports, a row of severity (``info``, ``warning``, ``error``), the program's own name for the kind
of finding, the links or joints that it gives as the subject (joined by ``|``), and the text.
"""

from __future__ import annotations

import importlib
import json
import os
import resource
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterable
from pathlib import Path

# Severity, kind, subject, text.
Row = tuple[str, str, str, str]
Ask = Callable[[str], Iterable[Row]]
# Between two looks whether a check has ended, in seconds.
PAUSE = 0.02
# A robot of two boxes: the modules that a program imports late are loaded when it is asked about this one.
BOX = "<geometry><box size='1 1 1'/></geometry>"
INERTIAL = "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>"
LINK = f"<link name='{{}}'>{INERTIAL}<visual>{BOX}</visual><collision>{BOX}</collision></link>"
JOINT = "<joint name='j' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/></joint>"


def main() -> None:
    """Answer one file after the other."""
    answers, sys.stdout = sys.stdout, sys.stderr  # a program that prints does not print between the answers
    adapter, seconds = sys.argv[1], int(sys.argv[2])
    ask: Ask = importlib.import_module(adapter).ask
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)  # some programs leave a log where they are
        file = Path(folder, "robot.urdf")
        file.write_text(f"<robot name='r'>{LINK.format('a')}{LINK.format('b')}{JOINT}</robot>", encoding="utf-8")
        list(ask(str(file)))
        for line in sys.stdin:
            print(json.dumps(ask_apart(line.strip(), seconds, ask)), file=answers, flush=True)


def ask_apart(file: str, seconds: int, ask: Ask) -> dict[str, object]:
    """Ask about one file in a fork of this process, which has loaded the modules and no mesh of it.

    At the end of the time it is stopped with its engines. The answer has the seconds of processor time too, with those of the
    processes that it started. A program that crashes has refused the file.
    """
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.setsid()
        os.close(reading)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        answer = json.dumps(_ask_once(file, ask)).encode()
        while answer:
            answer = answer[os.write(writing, answer) :]
        os._exit(0)
    os.close(writing)
    os.set_blocking(reading, False)
    said, end = b"", time.monotonic() + seconds
    while time.monotonic() < end:
        try:
            read = os.read(reading, 1 << 16)
        except BlockingIOError:
            time.sleep(PAUSE)
            continue
        if not read:
            break
        said += read
    else:
        os.killpg(child, signal.SIGKILL)
    os.close(reading)
    _, status, usage = os.wait4(child, 0)
    if os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGKILL:
        outcome: dict[str, object] = {"said": [], "problem": "timeout"}
    elif os.WIFSIGNALED(status):
        crash = signal.Signals(os.WTERMSIG(status)).name
        outcome = {"said": [("error", "crash", "", f"ends with {crash}")], "problem": f"crash: {crash}"}
    else:
        outcome = json.loads(said)
    return {"file": file, **outcome, "seconds": usage.ru_utime + usage.ru_stime}


def _ask_once(file: str, ask: Ask) -> dict[str, object]:
    try:
        return {"said": sorted(set(ask(file))), "problem": ""}
    except (Exception, SystemExit) as error:
        return {"said": [("error", "crash", "", f"{type(error).__name__}: {error}")], "problem": type(error).__name__}


if __name__ == "__main__":
    main()
