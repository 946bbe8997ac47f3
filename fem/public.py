"""The names that users and the other rooms write as `fem.NAME`."""

from fem.discretisation import Discretisation
from fem.effects.barrier import OVERLAP
from fem.effects.contact import ACTIVATION, ContactError, SelfContact
from fem.effects.effect import Effect
from fem.effects.hoops import Hoops, faces_along
from fem.effects.loads import Gravity, LineForce, Pressure
from fem.effects.membrane import LayerError, Membrane, StrainLimitingLayer
from fem.equations.pardiso import available_solver
from fem.experiments import Experiment
from fem.materials import Hencky, Material, MaterialError, MooneyRivlin, NeoHooke, Ogden, StVenantKirchhoff, Yeoh
from fem.materials.material import Uniaxial
from fem.materials.regions import ByRegion, Solid, laws_of
from fem.materials.rubber import IsochoricLaw
from fem.model import Model
from fem.path.loadpath import follow, follow_volume
from fem.path.newton import NewtonOptions
from fem.path.options import PathObserver, PathOptions
from fem.post.extremes import outside_stable_range, unstable_stretches
from fem.post.fields import element_fields
from fem.post.recovery import StressError, stress_error
from fem.post.self_intersection import crossing_at_rest, self_intersection
from fem.reasons import sentence
from fem.solution import End, NotConverged, Seconds, Solution, Step, step_from_arrays, step_to_arrays
from fem.supports import Fixed, Prescribed, SharedPlane, Support, SupportError
from fem.warm_up import compile_kernels

__all__ = [
    "ACTIVATION",
    "OVERLAP",
    "ByRegion",
    "ContactError",
    "Discretisation",
    "Effect",
    "End",
    "Experiment",
    "Fixed",
    "Gravity",
    "Hencky",
    "Hoops",
    "IsochoricLaw",
    "LayerError",
    "LineForce",
    "Material",
    "MaterialError",
    "Membrane",
    "Model",
    "MooneyRivlin",
    "NeoHooke",
    "NewtonOptions",
    "NotConverged",
    "Ogden",
    "PathObserver",
    "PathOptions",
    "Prescribed",
    "Pressure",
    "Seconds",
    "SelfContact",
    "SharedPlane",
    "Solid",
    "Solution",
    "StVenantKirchhoff",
    "Step",
    "StrainLimitingLayer",
    "StressError",
    "Support",
    "SupportError",
    "Uniaxial",
    "Yeoh",
    "available_solver",
    "compile_kernels",
    "crossing_at_rest",
    "element_fields",
    "faces_along",
    "follow",
    "follow_volume",
    "laws_of",
    "outside_stable_range",
    "self_intersection",
    "sentence",
    "step_from_arrays",
    "step_to_arrays",
    "stress_error",
    "unstable_stretches",
]
