"""Whether a design and its results are plausible: sentences with a suggestion, for what is possible but unusual.

What is impossible is refused by `pipeline.config`. A rule looks at a configuration before anything is solved, at its
mesh, or at the states that were reached, and gives a sentence, empty where nothing is unusual.
"""
