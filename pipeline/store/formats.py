"""The words and the version of the result files, for those who write them and those who read them."""

#: the `status` of a row of experiments.json: the pressure was reached, or it was not
CONVERGED, NOT_CONVERGED = "converged", "not converged"
