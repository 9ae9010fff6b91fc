"""Which other numbers an ``<inertial>`` should have: its own without a mistake, or those of the drawn part."""
