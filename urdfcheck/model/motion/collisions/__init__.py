"""Self-collisions: at the neutral pose, over the joints' ranges, and when one joint moves alone."""
