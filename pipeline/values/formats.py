"""The vocabulary of the result files: states of a row, rods, columns, and the version of the keys."""

#: the `status` of a row of experiments.json whose pressure was reached
CONVERGED = "converged"
#: the rods in rows of validation.json: five parameters, the law from one cell
FIVE, ARM_LAW = "five", "arm_law"
#: the rods in the tables of curves, in the order of their columns, and how the names of these begin
CURVE_PREFIXES = {FIVE: "rod", ARM_LAW: ARM_LAW}
#: the columns of curves.csv; validation_curves.csv has the load before them
CURVE_COLUMNS = (
    *("experiment", "pressure_kPa", "s_mm", "x_mm", "y_mm", "theta_rad", "kappa_per_mm", "kappa_std_per_mm"),
    "moment_N_mm",
    *(f"{prefix}_{name}" for prefix in CURVE_PREFIXES.values() for name in ("x_mm", "y_mm", "kappa_per_mm")),
)
#: the tetrahedra of the body at rest
BODY = "mesh.vtu"
#: the page of a run at pairs of pressures
PAIRS_PAGE = "pairs.html"
#: number of the present set of keys, written as `format` to the files
FORMAT = 6
