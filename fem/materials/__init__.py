"""Hyperelastic laws: energy, stress and tangent."""
