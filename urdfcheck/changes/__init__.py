"""Two versions of a robot, a package or a folder: read like a check, compared, put into words."""
