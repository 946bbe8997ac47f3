"""The convergence study of a design: error against seconds, and the discretisation for a requested accuracy."""
