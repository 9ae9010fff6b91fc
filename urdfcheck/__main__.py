"""``python -m urdfcheck``."""

import sys

from urdfcheck.cli import main

if __name__ == "__main__":
    sys.exit(main())
