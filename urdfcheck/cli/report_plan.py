"""Where the outcome of ``urdfcheck check`` goes."""

from __future__ import annotations

import argparse
import importlib
from pathlib import Path

from urdfcheck.cli.job_summary import find_summary_file
from urdfcheck.cli.output_files import CheckedFolders, is_folder_output, parse_run_outputs
from urdfcheck.core.records import dataclass
from urdfcheck.output import DRAWING_FORMATS


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportPlan:
    """Where the outcome of a run goes, decided before the run starts."""

    printed_format: str
    files: tuple[tuple[str, Path], ...]
    """Format and file of each ``--output``."""
    page_folders: frozenset[Path]
    """Those of `files` that are folders with a page per model."""
    checked: CheckedFolders
    job_summary: Path | None
    """The file of GitHub's job summary; None outside a job."""

    @classmethod
    def from_options(cls, options: argparse.Namespace) -> ReportPlan:
        """Read ``--format`` and ``--output``.

        :raises UrdfcheckError: see `parse_run_outputs`.
        """
        files = parse_run_outputs(options.output, options.paths)
        pages = {file for text, (_, file) in zip(options.output, files, strict=True) if is_folder_output(text)}
        for_github = "github" in {options.format, *(name for name, _ in files)}
        return cls(
            printed_format=options.format,
            files=tuple(files),
            page_folders=frozenset(pages),
            checked=CheckedFolders.around(options.paths),
            job_summary=find_summary_file() if for_github else None,
        )

    @property
    def formats(self) -> frozenset[str]:
        """All formats that are rendered."""
        names = {self.printed_format, *(name for name, _ in self.files)}
        return frozenset(names if self.job_summary is None else {*names, "markdown"})

    @property
    def needs_scene(self) -> bool:
        """Whether a format draws the model."""
        return bool(self.formats & DRAWING_FORMATS)

    def import_formats(self) -> None:
        """Import the modules of all formats."""
        for name in self.formats:
            importlib.import_module(f"urdfcheck.output.{name}")
