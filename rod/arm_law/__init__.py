"""The arm's own law: moment, stretch and rigidities of a cell over curvature and pressure, and its two ends."""
