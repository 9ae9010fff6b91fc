"""Whether joints turn about the lines, and to the sides, for which their parts are made."""
