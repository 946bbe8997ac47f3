"""The law of an arm that bends out of its plane, such as one with three chambers."""
