"""Constants of a material law from tensile tests."""
