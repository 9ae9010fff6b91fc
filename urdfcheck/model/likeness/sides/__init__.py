"""What the other side of a robot shows about the origin and the axis of a joint."""
