"""The convergence study: error against seconds."""
