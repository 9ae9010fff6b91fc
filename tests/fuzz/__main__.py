"""``python -m tests.fuzz``: see README.md."""

import os
import sys
from pathlib import Path

# Before numpy comes: a process that has threads must not be forked.
os.environ.update(dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1"))
sys.path.insert(0, str(Path(__file__).parents[1]))

if __name__ == "__main__":
    if "--atheris" in sys.argv:  # whose modules are instrumented as they are imported: none may be there yet
        from fuzz.guided import main
    else:
        from fuzz.campaign import main
    sys.exit(main())
