"""Commands that answer another program until it ends."""
