"""What the outcome of some work depends on."""
