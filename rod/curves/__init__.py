"""Measured curves and their curvature."""
