"""The command, also as ``python -I -m urdfcheck``; without ``-I``, Python takes modules from the working directory."""

import os
import sys


def main() -> int:
    """Run the command as a separate process, and return its exit code."""
    # First of all: until then, any import may be of a file that is to be checked.
    folders = _drop_working_folders()

    import gc
    import signal

    # What is loaded at the start is never garbage, and to look through it each 700 new objects takes a sixth of a warm run
    # (mypy has the same line for the same reason). The workers collect garbage between their jobs.
    gc.set_threshold(200_000, 30, 30)

    from urdfcheck import cli

    signal.signal(signal.SIGTERM, lambda *_: sys.exit(cli.FAILED))  # and clean up on the way out
    try:
        code = cli.main(working_folders=folders)
    except Exception:  # Python would end with 1, which says that the models have findings
        import traceback

        traceback.print_exc()
        print("urdfcheck: crashed, which is a bug of urdfcheck: please report it with these lines", file=sys.stderr)
        code = cli.FAILED
    # The process ends, and its memory with it: Python would look through all of it for garbage twice.
    gc.freeze()
    return code


def _drop_working_folders() -> list[str]:
    """Take the working directory, and what PYTHONPATH names relative to it, out of ``sys.path``.

    Return the folders among them from which Python may have imported something already, which nothing can undo.
    """
    try:
        here = os.getcwd()
    except OSError:  # it was deleted
        return []
    entries = [] if sys.flags.ignore_environment else os.environ.get("PYTHONPATH", "").split(os.pathsep)
    used = [os.path.join(here, entry).rstrip(os.sep) for entry in entries if not os.path.isabs(entry)]
    if entries == [""]:  # as if it were not set
        used = []
    if __name__ == "__main__" and not (sys.flags.isolated or getattr(sys.flags, "safe_path", False)):
        used.append(here)  # -m puts it first
    sys.path[:] = [path for path in sys.path if path not in {"", here, *used}]
    return list(dict.fromkeys(used))


if __name__ == "__main__":
    sys.exit(main())
