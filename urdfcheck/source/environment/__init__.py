"""The environment variables by which a xacro decides: their usual values, and the robots of other values."""
