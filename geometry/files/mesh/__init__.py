"""Bodies from mesh files: their elements, their faces, and the material curve in their elements."""
