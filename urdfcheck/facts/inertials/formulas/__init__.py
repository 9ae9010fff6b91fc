"""Formulas of moments of inertia as they are typed: as polynomials, and compared with those of boxes and cylinders."""
