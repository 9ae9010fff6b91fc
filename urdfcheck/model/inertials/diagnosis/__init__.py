"""How the inertial of a link is judged: by what it may draw, by other links, and by verdicts of earlier runs."""
