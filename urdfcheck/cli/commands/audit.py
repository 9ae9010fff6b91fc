"""``urdfcheck audit DATASET…``: check thousands of models; the result of each is kept as soon as it is finished."""

from __future__ import annotations

import argparse
import gc
import sys
from collections.abc import Sequence
from pathlib import Path

from urdfcheck.cli.options import EPILOG, CommandParser, add_options, build_request, ensure_paths
from urdfcheck.cli.output_files import CheckedFolders
from urdfcheck.cli.terminal import NOTHING, OK, combine_exit_code, make_progress_printer, say
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.run.preload import start_warm_worker


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of ``urdfcheck audit``."""
    p = CommandParser(
        prog="urdfcheck audit",
        description="Audit many models: a line of JSON each, a summary and a page. Interrupted runs resume.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    p.add_argument("paths", nargs="*", metavar="DATASET", help="folder of models, or any path that check takes")
    p.add_argument(
        *("-o", "--output"),
        type=Path,
        default=Path("urdfcheck-audit"),
        metavar="FOLDER",
        help="folder for the results and for what the next run needs (default: urdfcheck-audit)",
    )
    p.add_argument("--restart", action="store_true", help="discard what the folder holds and check everything again")
    p.add_argument(
        "--backend",
        default="local",
        metavar="local|dask=ADDRESS|ray[=ADDRESS]",
        help="run here (default) or on a running cluster (pip install urdfcheck[cluster])",
    )
    add_options(p, "audit")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    options = build_parser().parse_args(words)
    ensure_paths(options)
    backend, _, address = options.backend.partition("=")
    if (
        backend not in {"local", "dask", "ray"}
        or (backend == "local" and address)
        or (backend == "dask" and not address)
    ):
        raise UrdfcheckError(f"--backend {options.backend}: write local, dask=ADDRESS, ray or ray=ADDRESS")
    CheckedFolders.around(options.paths).ensure_own(options.output / "any")
    warm_worker = start_warm_worker() if backend == "local" else None

    from urdfcheck.dataset import cluster
    from urdfcheck.dataset.audit import INDEX, LINES, audit_dataset
    from urdfcheck.output.shared.audit import summary_text
    from urdfcheck.rules import load_rules
    from urdfcheck.run.pipeline import Execution, stream_reports
    from urdfcheck.system import libraries

    # `urdfcheck.__main__` has garbage collected rarely, which is right for a short run: of many models it would pile up.
    gc.set_threshold(10_000, 10, 10)
    request, settings = build_request(options)
    libraries.prefer_own_folders()
    done = audit_dataset(
        request,
        options.output,
        lambda units, work: (
            stream_reports(units, work, jobs=request.jobs, execution=Execution(warm_worker=warm_worker))
            if backend == "local"
            else cluster.stream_on_cluster(units, work, backend=backend, address=address or None)
        ),
        restart=options.restart,
        progress=make_progress_printer(),
    )
    if not done.checked and not done.unchanged:
        say("nothing to check: no model, launch file or package was found there")
        return OK if options.allow_empty else NOTHING
    sys.stdout.write(summary_text.render_audit_summary(done.summary, load_rules()))
    unchanged = f"{done.unchanged:,} unchanged, " if done.unchanged else ""
    say(f"{unchanged}{done.checked:,} checked; {options.output / LINES}, {options.output / INDEX}")
    fail_on = options.fail_on or settings.fail_on
    codes = [combine_exit_code(False, worst, level or fail_on) for level, worst in done.worst.items()]
    return max((combine_exit_code(bool(done.summary.failure_count), None, fail_on), *codes))
