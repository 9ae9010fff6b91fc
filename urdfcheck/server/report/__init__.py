"""The report with the robot in 3D, for an editor: written when it is asked for, and what of it belongs to a place in the text."""
