"""A model as plain values: to draw, to compare, and to hand to MoveIt."""
