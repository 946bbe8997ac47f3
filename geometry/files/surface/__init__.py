"""Bodies from surfaces of triangles, filled with elements."""
