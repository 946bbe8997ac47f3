"""Runs of bodies with two cavities at pairs of pressures."""
