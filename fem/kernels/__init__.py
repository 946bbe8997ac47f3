"""Hot loops compiled by numba (the only place where speed may cost clarity)."""

import numba

# Set here, before any kernel is defined. numba's OpenMP layer brings libgomp beside the Intel OpenMP of PARDISO: with
# both in one process the first factorization of a matrix came out wrong (thousands of negative pivots); numba's own
# queue does not.
numba.config.THREADING_LAYER = "workqueue"
