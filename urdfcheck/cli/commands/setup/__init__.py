"""Commands that set a project or a machine up, and check nothing."""
