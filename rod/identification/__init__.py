"""Moment and curvature to five parameters."""
