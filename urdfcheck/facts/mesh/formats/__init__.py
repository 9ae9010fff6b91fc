"""Readers of single mesh formats: bytes in, vertices and triangles out."""
