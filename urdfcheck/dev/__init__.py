"""Tools for people who work on urdfcheck itself, in a checkout: ``python -m urdfcheck.dev``."""
