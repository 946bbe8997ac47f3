"""What the body does: hyperelastic finite elements under follower pressure and contact."""

from fem.archive import step_from_arrays, step_to_arrays
from fem.compiling import compile_kernels
from fem.contact import ACTIVATION, BEHIND, ContactError, SelfContact
from fem.crossing import crossing
from fem.discretisation import Discretisation
from fem.effects import Effect, Gravity, LineForce, Pressure
from fem.experiments import Experiment
from fem.extremes import beyond_the_law, in_words
from fem.fields import element_fields
from fem.layer import LayerError, StrainLimitingLayer
from fem.linear import available_solver
from fem.loadpath import PathOptions, follow, follow_volume
from fem.material import Material, MaterialError, StVenantKirchhoff
from fem.material_hencky import Hencky
from fem.material_rubber import MooneyRivlin, NeoHooke, Yeoh
from fem.model import Model
from fem.newton import NewtonOptions
from fem.recovery import StressError, stress_error
from fem.solution import End, NotConverged, Seconds, Solution, Step
from fem.supports import Fixed, Prescribed, SupportError
from fem.uniaxial import Uniaxial, uniaxial, uniaxial_terms

__all__ = [
    "ACTIVATION",
    "BEHIND",
    "ContactError",
    "Discretisation",
    "Effect",
    "End",
    "Experiment",
    "Fixed",
    "Gravity",
    "Hencky",
    "LayerError",
    "LineForce",
    "Material",
    "MaterialError",
    "Model",
    "MooneyRivlin",
    "NeoHooke",
    "NewtonOptions",
    "NotConverged",
    "PathOptions",
    "Prescribed",
    "Pressure",
    "Seconds",
    "SelfContact",
    "Solution",
    "StVenantKirchhoff",
    "Step",
    "StrainLimitingLayer",
    "StressError",
    "SupportError",
    "Uniaxial",
    "Yeoh",
    "available_solver",
    "beyond_the_law",
    "compile_kernels",
    "crossing",
    "element_fields",
    "follow",
    "follow_volume",
    "in_words",
    "step_from_arrays",
    "step_to_arrays",
    "stress_error",
    "uniaxial",
    "uniaxial_terms",
]
