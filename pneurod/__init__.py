"""pneurod in Python: from the drawing of a pneumatic soft actuator to its rod model.

    import pneurod

    results = pneurod.characterize("configs/pneunet.yaml", out="results/pneunet", progress=True)
    results = pneurod.characterize(  # a design without a file
        pneurod.PneuNet(chambers=6, wall="1.2 mm"), material=pneurod.NeoHooke(mu="0.1 MPa"), pressures=["4 kPa"]
    )
    results = pneurod.read_results("results/pneunet")   # the same value, from the files of a finished run
    results.parameters                                  # a pandas frame, units in the column names
    rod = results.rod("31 kPa")                         # the pneurod.Rod that the verdict recommends
    shape = rod.solve(force=(0.0, 0.05))                # equilibrium under an end force in N, in milliseconds
    shape.end, shape.curve                              # of the material curve, mm, from its clamped end
    pneurod.compare("results/pneunet", "arm.csv")       # a measured arm beside its rod
    pneurod.calibrate("results/pneunet", "arm.csv")     # modulus and dimensions of that arm, with intervals

Units everywhere: mm, N, MPa, tonne/mm3, rad; pressures of a run in kPa. The four rooms are here under their own names:
`pneurod.fem` is the module `fem`. What needs a numerical library is imported when it is first used:
`import pneurod` alone loads none of them.
"""

from typing import TYPE_CHECKING

import fem
import geometry
import pipeline
import rod
from geometry.errors import PneurodError
from pipeline.api import measured, rods, runs, setup, studies
from pipeline.api.measured import *
from pipeline.api.options import show_plainly
from pipeline.api.rods import *
from pipeline.api.runs import *
from pipeline.api.setup import *
from pipeline.api.studies import *
from pipeline.values.errors import InputError, RunFailed
from pneurod import designs
from pneurod.designs import *

if TYPE_CHECKING:
    from pipeline.api.results import Results, read_results
    from pipeline.study.wishes.report import DesignReport
    from rod import (
        ArmLaw,
        FiveParameters,
        Interval,
        LawRod,
        LineLoad,
        PointLoad,
        Rod,
        RodError,
        RodSolution,
        RodWarning,
        Support,
    )

__all__ = [
    "ArmLaw",
    "DesignReport",
    "FiveParameters",
    "InputError",
    "Interval",
    "LawRod",
    "LineLoad",
    "PneurodError",
    "PointLoad",
    "Results",
    "Rod",
    "RodError",
    "RodSolution",
    "RodWarning",
    "RunFailed",
    "Support",
    "fem",
    "geometry",
    "pipeline",
    "read_results",
    "rod",
]
__all__ += measured.__all__
__all__ += rods.__all__
__all__ += runs.__all__
__all__ += setup.__all__
__all__ += studies.__all__
for _module in (measured, rods, runs, setup, studies):
    for _name in _module.__all__:
        show_plainly(getattr(_module, _name))
__all__ += designs.__all__

if not TYPE_CHECKING:  # a type checker reads the imports above and refuses every other name

    def __getattr__(name: str) -> object:
        """Import a public name when it is first used. Raises AttributeError for any other name."""
        if name not in __all__:
            raise AttributeError(f"module 'pneurod' has no attribute {name!r}; it has {', '.join(__all__)}")
        globals()[name] = value = _imported(name)
        return value


def __dir__() -> list[str]:
    return __all__


def _imported(name: str) -> object:
    if name in ("Results", "read_results"):
        from pipeline.api import results

        return getattr(results, name)
    if name == "DesignReport":
        from pipeline.study.wishes.report import DesignReport

        return DesignReport
    return getattr(rod, name)
