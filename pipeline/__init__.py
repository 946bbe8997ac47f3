"""From a configuration file to a report: everything that runs the other rooms and writes their results."""
