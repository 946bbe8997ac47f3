"""Tensile tests: which law, which constants."""
