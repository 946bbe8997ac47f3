"""The assembled equations: element formulations, sparsity pattern, factorization, constraints."""
