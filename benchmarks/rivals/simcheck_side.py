"""What simcheck does: plants its defects, and checks files. Run by a Python that has simcheck, never by that of urdfcheck.

``simcheck_side.py plant ENTRY FOLDER`` prints what was written as one line of JSON. ``simcheck_side.py check SECONDS ENGINE``
reads paths from stdin, one a line, and prints a line of JSON for each; the engine ``none`` is simcheck's ``--static-only``.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import sys
import tempfile
import time
from pathlib import Path

from simcheck.checks.registry import Context
from simcheck.config import Config
from simcheck.core import check_file, load_asset
from simcheck.mutate import MUTATIONS, apply, copy_clean

# Between two looks whether a check has ended, in seconds.
PAUSE = 0.05


def main() -> None:
    """Do what the first word says."""
    if sys.argv[1] == "plant":
        print(json.dumps(plant(Path(sys.argv[2]), Path(sys.argv[3]))))
        return
    engines = () if sys.argv[3] == "none" else (sys.argv[3],)
    load_modules(engines)
    for line in sys.stdin:
        print(json.dumps(check_apart(Path(line.strip()), int(sys.argv[2]), engines)), flush=True)


def plant(entry: Path, folder: Path) -> dict[str, object]:
    """Write the sound robot and one copy for each operator that applies, like ``simcheck bench``."""
    config = Config(engines=())
    context = Context(load_asset(entry, config), config)
    clean = copy_clean(entry, folder)
    written = {}
    for name, mutation in MUTATIONS.items():
        made = apply(entry, name, folder, 0, context)
        if made is not None:
            written[name] = {"file": str(made[0]), "what": made[1], "expect": mutation.expect}
    return {"clean": str(clean), "planted": written}


def load_modules(engines: tuple[str, ...]) -> None:
    """Check a robot of two boxes, so that the modules that simcheck imports late are loaded."""
    box = "<geometry><box size='1 1 1'/></geometry>"
    link = f"<link name='{{}}'><visual>{box}</visual><collision>{box}</collision></link>"
    joint = "<joint name='j' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/></joint>"
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "robot.urdf")
        file.write_text(f"<robot name='r'>{link.format('a')}{link.format('b')}{joint}</robot>")
        check(file, engines)


def check_apart(file: Path, seconds: int, engines: tuple[str, ...]) -> dict[str, object]:
    """Check one file in a fork of this process, which has loaded the modules and no mesh of it.

    At the end of the time it is stopped with its engines. The answer has the seconds of processor time too, with those of the
    engines' processes.
    """
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.setsid()
        os.close(reading)
        answer = json.dumps(check(file, engines)).encode()
        while answer:
            answer = answer[os.write(writing, answer) :]
        os._exit(0)
    os.close(writing)
    os.set_blocking(reading, False)
    said, end = b"", time.monotonic() + seconds
    while True:
        try:
            read = os.read(reading, 1 << 16)
        except BlockingIOError:
            if time.monotonic() > end:
                break
            time.sleep(PAUSE)
            continue
        if not read:
            break
        said += read
    late = time.monotonic() > end
    if late:
        os.killpg(child, signal.SIGKILL)
    os.close(reading)
    _, _, usage = os.wait4(child, 0)
    outcome = json.loads(said) if said and not late else {"said": [], "problem": "timeout" if late else "no answer"}
    return {"file": str(file), **outcome, "seconds": usage.ru_utime + usage.ru_stime}


def check(file: Path, engines: tuple[str, ...]) -> dict[str, object]:
    """Check one file; what is reported, as severity, check, engine, target and message."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    try:
        report = check_file(file, Config(engines=engines))
    except Exception as error:
        return {"said": [], "problem": type(error).__name__}
    said = {(found.severity, found.check, found.engine, found.target, found.message) for found in report.findings}
    return {"said": sorted(said), "problem": "; ".join(report.stats.get("incomplete", ()))}


if __name__ == "__main__":
    main()
