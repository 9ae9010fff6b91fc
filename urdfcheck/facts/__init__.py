"""Pure physics and geometry: arrays in, numbers out; no findings, no configuration, no XML."""
