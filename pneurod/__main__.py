"""`python -m pneurod` is the console script `pneurod`."""

from pipeline.cli import main

if __name__ == "__main__":
    main()
