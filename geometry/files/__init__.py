"""Bodies from other programs: what their files share, and a folder for drawings, meshes and surfaces each."""
