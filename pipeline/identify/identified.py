"""What the experiments of a run give: the five parameters at its pressures, or why there are none."""

from dataclasses import dataclass

from geometry import Reason
from pipeline.identify.parameters import Parameters, counts_as_equal_cells, identify_all
from pipeline.simulate.outcome import Outcomes
from pipeline.simulate.scene import Scene
from pipeline.simulate.too_short import too_coarse, too_short
from pipeline.store.context import RunContext


@dataclass(frozen=True)
class Identified:
    """The outcomes of a run and the parameters that follow from them."""

    outcomes: Outcomes
    parameters: tuple[Parameters, ...]  #: by ascending pressure
    refused: tuple[Reason, ...] = ()  #: why there are no parameters, or none at a pressure

    def failures(self, other_rod: bool) -> tuple[Reason, ...]:
        """What makes the run fail: a pressure without parameters only where there are no others and no other rod."""
        return () if self.parameters or other_rod else self.refused

    def remarks(self, other_rod: bool) -> tuple[Reason, ...]:
        """The other reasons."""
        return self.refused if self.parameters or other_rod else ()


def identify_run(scene: Scene, context: RunContext, outcomes: Outcomes) -> Identified:
    """The parameters at all pressures."""
    config = scene.config
    if reason := too_short(config) or too_coarse(config, scene.body):
        return Identified(outcomes, (), (reason,))
    equal, d = counts_as_equal_cells(config.design), config.identification.d_mm
    return Identified(outcomes, *identify_all(outcomes, scene.body.pitch, d, equal_cells=equal, context=context))
