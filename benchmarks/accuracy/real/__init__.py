"""Published robots, as they are and with one thing changed."""
