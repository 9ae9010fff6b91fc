"""What the importers of Newton and Isaac Sim share: both convert URDF to USD, in a separate environment."""
