"""Dimensions for wishes on an arm."""
