"""Pieces of a periodic body between planes of mirror symmetry: pure bending of a cell and of the ends."""
