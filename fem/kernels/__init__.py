"""Hot loops compiled by numba (the only place where speed may cost clarity)."""
