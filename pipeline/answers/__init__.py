"""Answers from the results of a run: rods, budgets, comparisons with measurements, materials."""
