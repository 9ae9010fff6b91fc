"""The version of urdfcheck, and where its documentation is published."""

__version__ = "0.2.0"
# Address of the site that `make site` writes, with a slash at its end; empty until it is published. Reports link the rules there.
SITE = ""
