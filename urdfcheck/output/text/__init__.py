"""The text report, for a terminal and for a CI log."""

from urdfcheck.output.text.full_finding import FIX_OPTIONS as FIX_OPTIONS
from urdfcheck.output.text.report import WIDTH as WIDTH
from urdfcheck.output.text.report import DetailLevel as DetailLevel
from urdfcheck.output.text.report import render as render
from urdfcheck.output.text.report import render_statistics as render_statistics
