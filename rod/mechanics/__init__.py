"""Equilibrium of the rod."""
