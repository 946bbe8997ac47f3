"""Bodies from other programs: their files, their frame, their faces, and the material curve in their elements."""
