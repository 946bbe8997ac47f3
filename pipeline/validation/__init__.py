"""The rod held against the finite elements."""
