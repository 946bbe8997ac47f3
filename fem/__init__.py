"""What the body does: hyperelastic finite elements under follower pressure and contact."""

from fem.contact import ContactError, SelfContact
from fem.effects import Effect, Gravity, Pressure
from fem.experiments import Experiment
from fem.loadpath import PathOptions, follow
from fem.linear import available_solver
from fem.material import Material, MaterialError, StVenantKirchhoff
from fem.model import Model
from fem.newton import NewtonOptions
from fem.solution import NotConverged, Solution, Step
from fem.supports import Fixed, Prescribed, SupportError

__all__ = [
    "ContactError",
    "Effect",
    "Experiment",
    "Fixed",
    "Gravity",
    "Material",
    "MaterialError",
    "Model",
    "NewtonOptions",
    "NotConverged",
    "PathOptions",
    "Prescribed",
    "Pressure",
    "SelfContact",
    "Solution",
    "StVenantKirchhoff",
    "Step",
    "SupportError",
    "available_solver",
    "follow",
]
