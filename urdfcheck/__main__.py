"""The command, also as ``python -m urdfcheck``."""

import os
import sys


def main() -> int:
    """Run the command as a process of its own, and return its exit code."""
    # Python puts the working directory first for -m, and for an empty entry of PYTHONPATH (a ROS shell often ends it with a
    # colon); what lies there is checked, and never imported.
    sys.path[:] = [path for path in sys.path if path not in {"", os.getcwd()}]

    import signal

    from urdfcheck import cli

    signal.signal(signal.SIGTERM, lambda *_: sys.exit(cli.FAILED))  # and clean up on the way out
    return cli.main()


if __name__ == "__main__":
    sys.exit(main())
