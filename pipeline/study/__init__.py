"""Studies of many runs: sweeps, effects, accuracy, wishes, pairs of pressures."""
