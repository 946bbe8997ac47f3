"""What the body is: designs, solids, meshes and the material curve."""
