"""Bodies from CAD files: solids, their measures, their cells and their meshes."""
