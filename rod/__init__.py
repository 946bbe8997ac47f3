"""The body as one line: curvature, the five parameters, and the rod that carries them."""
