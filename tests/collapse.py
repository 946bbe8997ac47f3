"""A body of which a wall collapses onto another one and slides along it, for the tests of contact."""

from fem import Experiment, Model, Pressure, SelfContact, Yeoh
from geometry import GRADINGS, BisectedCircle

LAW = Yeoh(c10=0.0625, c20=0.00313, c30=0.0000625, kappa=0.405)


def collapsing(length: float, size: float = 6.5) -> tuple[Experiment, Model]:
    """A bisected circle of which the air of one half presses the divider into the other; up to 34 kPa.

    size: of the elements, mm; with 5 mm the corner of the divider folds.
    """
    design = BisectedCircle(length=length, radius=9.05, end_wall=4.4, wall=2.19, divider=1.54)
    effects = [
        Pressure("cavity", 0.034),
        SelfContact("cavity", starts_inactive=True, overlap=0.0),
        SelfContact("cavity_lower", starts_inactive=True, overlap=0.0),
    ]
    experiment = Experiment.of("II", design.body(size, GRADINGS["walls"]), 0.0)
    return experiment, experiment.model(LAW, effects, "p2")
