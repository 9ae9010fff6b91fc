"""Two states of a git repository as two folders, so that they are compared like any others."""
