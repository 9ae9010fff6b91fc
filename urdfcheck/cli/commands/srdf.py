"""``urdfcheck srdf MODEL``: write the pairs of links that MoveIt need not check."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from urdfcheck.cli.options import CommandParser, add_options, build_access_request
from urdfcheck.cli.output_files import CheckedFolders, write_file
from urdfcheck.cli.terminal import NOTHING, OK, print_document, report_accepted, say
from urdfcheck.core.errors import ModelNotCheckedError, UrdfcheckError


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of ``urdfcheck srdf``."""
    from urdfcheck.export.link_pairs import SAMPLES, THOROUGH

    p = CommandParser(
        prog="urdfcheck srdf",
        description="Write the disable_collisions of a robot's SRDF, as MoveIt's Setup Assistant does, with the evidence.",
    )
    p.add_argument("model", metavar="MODEL", help="a model, or whatever means exactly one")
    p.add_argument("-o", "--output", type=Path, metavar="FILE", help="write to a file instead of standard output")
    p.add_argument(
        "--thorough", action="store_true", help=f"sample {THOROUGH:,} joint configurations instead of {SAMPLES:,}"
    )
    add_options(p, "srdf")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    from urdfcheck.export.link_pairs import SAMPLES, THOROUGH, explain_missing_pairs, has_foreign_content, render_srdf

    options = build_parser().parse_args(words)
    path = Path(options.model)
    if options.output is not None and has_foreign_content(options.output):
        raise UrdfcheckError(
            f"{options.output} was not written by urdfcheck srdf alone: its other content would be lost"
        )

    from dataclasses import replace

    from urdfcheck.rules import load_rules
    from urdfcheck.run.pipeline import audit_single_model
    from urdfcheck.system import libraries

    # The findings about the file explain why there is no model.
    codes = frozenset(code for code, rule in load_rules().items() if "file" in rule.scopes)
    libraries.prefer_own_folders()
    request, policy = build_access_request(options, options.model, codes)
    audit_options = replace(request.options, samples=THOROUGH if options.thorough else SAMPLES, pairs=True)
    report = audit_single_model(replace(request, options=audit_options))
    if report.pairs is None:
        reason = f"{path}: {explain_missing_pairs(report.failures, report.skipped, report.findings)}"
        if report.failures or report.info is None or report.info.status == "checked":
            raise UrdfcheckError(reason)
        return report_accepted(ModelNotCheckedError(reason), policy)
    if not report.pairs.pairs:
        say(f"urdfcheck: {path}: no two links have collision geometry that can be read", sys.stderr)
        return NOTHING
    from urdfcheck.output.shared.escaping import escape_for_xml

    document = escape_for_xml(render_srdf(report.pairs))
    if options.output is not None:
        write_file(document, options.output, CheckedFolders.around([path]))
    else:
        print_document(document)
    return OK
