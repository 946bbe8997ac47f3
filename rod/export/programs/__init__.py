"""Programs that are written for an arm, each with its table in place of that of `table.py`."""
