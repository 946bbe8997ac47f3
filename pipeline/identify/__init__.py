"""Five parameters from the experiments, and the rods compared with finite elements."""
