"""Arms in time: finite elements against closed forms."""

import numpy as np
import pytest
import skfem

from benchmarks.in_time.elements import Motion, mass_matrix
from benchmarks.in_time.measured import segment_lines
from fem import Fixed, Gravity, Model, Pressure, StVenantKirchhoff, follow
from fem.discretisation import Discretisation
from geometry.arrays import Array
from pipeline.answers.measured.motions import DampedOscillation
from rod import Relaxation
from tests.bodies import box

#: tonne/mm3; MPa; part and time (s) of a branch; mm
DENSITY, E, G, TAU, LENGTH = 1.1e-9, 0.3, 0.4, 2e-3, 40.0
BAR = StVenantKirchhoff(E=E, nu=0.0)
BRANCH = (Relaxation((G,), (TAU,)),)


def bar(*effects: Pressure) -> Model:
    return Model(box((8, 1, 1), (LENGTH, 3.0, 3.0)), BAR, [Fixed("left")], effects, "p2p0")


def end_of(space: Discretisation) -> int:
    return int(np.argmax(space.points.sum(axis=1)))


def released(time: Array, rate: float) -> Array:
    """What is left of a sine at times (n,) s, whose undamped rate is given in rad/s, with the branch: by Laplace."""
    top = np.array([1.0, 1.0 / TAU, G * rate**2])
    bottom = np.array([1.0, 1.0 / TAU, (1.0 + G) * rate**2, rate**2 / TAU])
    poles = np.roots(bottom)
    parts = np.polyval(top, poles) / np.polyval(np.polyder(bottom), poles)
    return np.asarray((parts * np.exp(np.outer(time, poles))).sum(axis=1).real)


def test_the_mass_is_that_of_scikit_fem() -> None:
    mesh = box((3, 2, 2), (4.0, 3.0, 2.0))
    space = Discretisation.of(mesh, "p2")
    grid = skfem.MeshTet(mesh.points.T.copy(), np.asarray(mesh.tets, dtype=np.int64).T.copy())
    basis = skfem.Basis(grid, skfem.ElementTetP2())
    theirs = skfem.BilinearForm(lambda u, v, _: DENSITY * u * v).assemble(basis)
    assert np.allclose(mass_matrix(space, DENSITY).toarray(), theirs.toarray(), rtol=1e-9, atol=1e-12 * DENSITY)


def test_a_bar_rings_and_decays_as_the_closed_form_to_second_order() -> None:
    model, rate = bar(), 0.5 * np.pi / LENGTH * np.sqrt(E / DENSITY)
    period, tip = 2.0 * np.pi / rate, end_of(model.space)
    shape = np.zeros_like(model.space.points)
    shape[:, 0] = 1e-4 * np.sin(0.5 * np.pi * model.space.points[:, 0] / LENGTH)
    errors = []
    for count in (20, 40):
        motion = Motion(model, DENSITY, BRANCH, period / count)
        moments = list(motion.run(motion.begin(shape), lambda _: 0.0, 2 * count))
        found = [moment.displacement[tip, 0] / shape[tip, 0] for moment in moments]
        known = released(np.array([moment.time for moment in moments]), rate)
        errors.append(np.abs(found - known).max())
    assert errors[1] < 0.02
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.2)


def test_a_bar_without_mass_creeps_as_the_closed_form() -> None:
    model, late, stop = bar(Pressure("right", -1e-4 * E)), TAU * (1.0 + G), 3.0 * TAU
    motion = Motion(model, 1e-6 * DENSITY, BRANCH, stop / 60, high=0.0)
    tip = end_of(model.space)
    for moment in motion.run(motion.begin(np.zeros_like(model.space.points)), lambda time: time / stop, 60):
        time = moment.time
        known = (time - G / (1.0 + G) * late * (1.0 - np.exp(-time / late))) / stop
        assert moment.displacement[tip, 0] == pytest.approx(1e-4 * LENGTH * known, abs=1e-3 * 1e-4 * LENGTH)


def test_a_bar_that_swings_far_keeps_its_energy() -> None:
    law, sides = StVenantKirchhoff(E=E, nu=0.3), (LENGTH, 2.0, 2.0)
    weight = Gravity(DENSITY, (0.0, -4e4, 0.0))
    model = Model(box((12, 1, 1), sides), law, [Fixed("left")], [weight], "p2p0")
    bent = follow(model, [1.0]).steps[0].displacement
    motion = Motion(model, DENSITY, (Relaxation((), ()),), 1e-3)
    start, elastic = motion.begin(bent), model.system()
    energies = []
    for moment in motion.run(start, lambda _: 0.0, 300):
        kinetic = 0.5 * float(np.vdot(moment.velocity, motion.mass @ moment.velocity))
        energies.append(kinetic + elastic.energy(moment.displacement, 0.0, ()))
    assert np.ptp(energies) < 1e-2 * energies[0]


def test_frequency_and_damping_of_a_motion_that_creeps_come_back() -> None:
    time, rate, damping = np.arange(0.0, 3.0, 0.01), 2.0 * np.pi * 3.3, 0.06
    value = 20.0 + 2.0 * np.exp(-time / 0.8) - 15.0 * np.exp(-damping * rate * time) * np.cos(rate * time)
    found = DampedOscillation.of(time, value)
    size = np.hypot(1.0, damping)
    assert found[:2] == pytest.approx((3.3 * size, damping / size), rel=1e-4)


def test_holds_of_the_segment_are_foretold_from_one_of_them() -> None:
    lines = {(case, what): shown for case, what, _, _, shown, _ in segment_lines()}
    assert len(lines) == 10
    assert {shown for (case, _), shown in lines.items() if "40" in case} == {"+0 %"}
