"""From a drawing to named tetrahedra (Gmsh)."""
