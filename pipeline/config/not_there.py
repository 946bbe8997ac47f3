"""What users look for under a key that does not exist: what to write instead, or that it is not there."""

_FIBRE = "write effects: {hoops: {threads: {EA: 40 N, pitch: 2 mm}}}; a sheet is effects: {strain_limiting_layer: on}"
_DYNAMICS = "a run has states at rest alone; the arm moves by pneurod move, damped by material.loss_factor"
_CREEP = "write material: {relaxation: [{g: 0.08, tau: 0.9 s}]}, for pneurod move; cycles of rubber are left out"
_FRICTION = "walls that touch slide without friction; exported rods have that of MuJoCo"
_TIP_LOAD = "write end: {y: -0.1 N} for a force in experiment III; the rod takes any: pneurod rod --force, --tip-mass"
_GRAVITY = "write effects: {gravity: hanging}, or lying, standing, 30 deg"
_VOLUME = "a run prescribes pressures; a prescribed volume of air is there in Python only, fem.follow_volume"
_CURVED = "arms are straight at rest; the law of an arm that is cast curved does not exist"
_ABSOLUTE = "pressures are differences to the air outside; write pressures, and negative fractions for a vacuum"

#: key in small letters -> the clause
_CLAUSES: dict[str, tuple[str, ...]] = {
    _FIBRE: ("fibre", "fiber", "fibres", "fibers", "reinforcement", "fibre_angle", "fiber_angle"),
    _DYNAMICS: ("dynamics", "dynamic", "inertia", "damping", "time", "transient", "viscosity"),
    _CREEP: ("creep", "relaxation", "viscoelasticity", "viscoelastic", "prony", "tau", "hysteresis", "mullins"),
    _FRICTION: ("friction",),
    _TIP_LOAD: ("tip_load", "tip_force", "tip_mass", "payload", "end_load", "end_force"),
    _GRAVITY: ("gravity", "orientation", "weight"),
    _VOLUME: ("volume", "volumes", "volume_control", "fluid"),
    _CURVED: ("curvature", "rest_curvature", "precurvature", "initial_curvature"),
    _ABSOLUTE: ("absolute_pressure", "absolute_pressures", "ambient_pressure", "atmosphere"),
}
NOT_THERE = {name: clause for clause, names in _CLAUSES.items() for name in names}
