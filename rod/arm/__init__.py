"""One arm: geometrically exact beam elements whose energy is the law of its sections."""
