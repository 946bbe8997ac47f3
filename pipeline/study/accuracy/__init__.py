"""How the numbers depend on the mesh and on the solver."""
