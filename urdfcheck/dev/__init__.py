"""Tools for who works on urdfcheck itself, in a checkout: ``python -m urdfcheck.dev``."""
