"""Two versions of a mechanism compared: matched by name and structure, aligned part by part, moved and loaded alike."""
