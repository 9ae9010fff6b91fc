"""The report for people: one HTML file that opens from a disk, loads nothing and needs no script."""

from urdfcheck.output.html.document import render
from urdfcheck.output.html.report_folder import iter_report_pages, make_unique_file_names

__all__ = ["iter_report_pages", "make_unique_file_names", "render"]
