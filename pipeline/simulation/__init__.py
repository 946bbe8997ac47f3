"""The scene and the experiments that are simulated in it."""
