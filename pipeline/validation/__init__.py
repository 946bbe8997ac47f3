"""The rod compared with the finite elements."""
