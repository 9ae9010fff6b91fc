"""``python -m urdfcheck``."""

import os
import sys

# Python puts the working directory first for -m; what lies there is checked, and never imported.
sys.path[:] = [path for path in sys.path if path not in {"", os.getcwd()}]

from urdfcheck.cli import main  # noqa: E402

if __name__ == "__main__":
    sys.exit(main())
