"""Arms in time against closed forms, against equilibria, and against themselves in space."""

import json
import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from geometry.arrays import Array
from pipeline.answers.measured.motions import DampedOscillation
from pipeline.results.laws import law_of_record
from rod import (
    Air,
    ArmLaw,
    Body,
    LineLoad,
    Load,
    Loading,
    Motion,
    MovingArm,
    Relaxation,
    Rod,
    RodError,
    Start,
    Steps,
    Support,
    TwoSlopes,
    frequencies,
    move,
)
from rod.arm_law.rates import CellRate, ClampRate, LawRate
from rod.in_time.regions import mixed, shares_of
from rod.weight import Mass
from tests.coarse import COARSE
from tests.rod.arm_law import test_space_law, test_volumes
from tests.rod.arm_law.test_arm_law import law_of
from tests.rod.arm_law.test_spatial import law_of_straight

LENGTH, B, GRAMS = 100.0, 2000.0, 10.0
#: 1/s2, and roots of 1 + cos cosh
SCALE, ROOTS = B / (1e-6 * GRAMS * LENGTH**3), np.array([1.87510407, 4.69409113, 7.85475744])
BAR = Rod(LENGTH, 0.0, TwoSlopes(B, B, 0.0, 0.0, 50.0), mass=Mass.even(LENGTH, GRAMS))
FIRST = ROOTS[0] ** 2 * math.sqrt(SCALE) / (2.0 * math.pi)
RUBBER = Relaxation.from_loss_factor(0.12, 1.0, 10.0)


@cache
def arm() -> ArmLaw:
    """The coarse arm."""
    law = law_of_record(json.loads((COARSE / "law.json").read_text(encoding="utf-8")))
    assert isinstance(law, ArmLaw)
    return law


@cache
def airy() -> ArmLaw:
    """An arm of a known potential, with the air that belongs to it."""
    law = law_of(*map(test_volumes.part, test_volumes.PRESSURES))
    return replace(law, mass=Mass.even(law.length, GRAMS))


def tip_at(motion: Motion, time: float) -> Array:
    return np.array([np.interp(time, motion.times_s, column) for column in motion.tips.T])


def first_mode(body: Body = Body(BAR), acting: Loading = Loading()) -> float:  # noqa: B008  frozen
    return frequencies(body, 0.0, acting, 1)[0].frequency_hz


def test_the_creep_belongs_to_the_relaxation() -> None:
    rubber = Relaxation((0.3, 0.2, 0.1), (0.02, 0.3, 4.0))
    t = np.linspace(0.0, 3.0, 3001)
    middle = 0.5 * (t[1:] + t[:-1])
    both = rubber.creep.compliance(3.0 - t[0]) * rubber.modulus(0.0)
    both += rubber.creep.compliance(3.0 - middle) @ np.diff(rubber.modulus(t))
    assert both == pytest.approx(1.0, abs=1e-6)
    assert rubber.creep.compliance(0.0) == pytest.approx(1.0 / 1.6)


@pytest.mark.parametrize(
    ("value", "low", "high"), [(0.12, 1.0, 10.0), (0.05, 0.1, 50.0), (0.3, 3.0, 8.0), (0.1, 5.0, 5.0)]
)
def test_a_loss_factor_is_the_same_over_its_frequencies(value: float, low: float, high: float) -> None:
    rubber = Relaxation.from_loss_factor(value, low, high)
    assert rubber.loss_factor(np.geomspace(low, high, 41)) == pytest.approx(np.full(41, value), rel=0.1)


def test_a_cantilever_has_the_frequencies_of_its_closed_form() -> None:
    found = [mode.frequency_hz for mode in frequencies(Body(BAR, spread=(1e-9, 1e-9)), 0.0)]
    assert found == pytest.approx(ROOTS**2 * math.sqrt(SCALE) / (2.0 * math.pi), rel=2e-5)
    hung, root = GRAMS, 1.2479174  # of 1 + cos cosh + r (cos sinh - sin cosh)
    closed = math.cos(root) * math.sinh(root) - math.sin(root) * math.cosh(root)
    assert 1.0 + math.cos(root) * math.cosh(root) + root * closed == pytest.approx(0.0, abs=1e-5)
    propped = Loading(along=[Support(LENGTH, y=0.0)])
    assert first_mode(acting=propped) == pytest.approx(3.92660231**2 * math.sqrt(SCALE) / (2.0 * math.pi), rel=2e-5)
    with_mass = first_mode(acting=Loading(tip_mass=hung))
    assert with_mass == pytest.approx(root**2 * math.sqrt(SCALE) / (2.0 * math.pi), rel=2e-5)


def mode_loads(count: int = 40) -> tuple[LineLoad, ...]:
    """Loads that bend the bar into its first mode."""
    edges = np.linspace(0.0, LENGTH, count + 1)
    x = ROOTS[0] * 0.5 * (edges[1:] + edges[:-1]) / LENGTH
    part = (math.sinh(ROOTS[0]) - math.sin(ROOTS[0])) / (math.cosh(ROOTS[0]) + math.cos(ROOTS[0]))
    shape = np.cosh(x) - np.cos(x) - part * (np.sinh(x) - np.sin(x))
    return tuple(LineLoad(a, b, (0.0, 2e-4 * q)) for a, b, q in zip(edges[:-1], edges[1:], shape, strict=True))


@pytest.mark.slow
def test_without_loss_the_energy_stays() -> None:
    """In 100 periods less than a thousandth of it goes; ten are followed here."""
    bent = Start(acting=Loading(along=mode_loads()))
    motion = move(Body(BAR), 0.0, 10.0 / FIRST, Loading(), bent, Steps(fixed=1.0 / (250.0 * FIRST)))
    height = motion.tips[:, 1]
    phase = 2.0 * math.pi * first_mode() * motion.times_s
    energies = []
    for part in (slice(0, 251), slice(-251, None)):
        rows = np.column_stack([np.cos(phase[part]), np.sin(phase[part])])
        energies.append(float((np.linalg.lstsq(rows, height[part])[0] ** 2).sum()))
    assert abs(energies[1] / energies[0] - 1.0) < 1e-4
    assert motion.reason == ""


def test_the_error_falls_with_the_square_of_the_step() -> None:
    bent, time = Start(acting=Loading(along=mode_loads())), 2.3 / FIRST
    body = Body(BAR, RUBBER)
    ends = [move(body, 0.0, time, Loading(), bent, Steps(fixed=time / n)).tips[-1] for n in (80, 160, 320, 1600)]
    errors = [float(np.linalg.norm(end - ends[-1])) for end in ends[:-1]]
    assert 3.0 < errors[0] / errors[1] < 5.5
    assert 3.0 < errors[1] / errors[2] < 5.5


def test_steps_by_their_error_keep_it() -> None:
    path = move(Body(arm(), RUBBER), 12.0, 0.6)
    fine = move(Body(arm(), RUBBER), 12.0, 0.6, steps=Steps(fixed=5e-4))
    for time in (0.2, 0.4, 0.6):
        assert tip_at(path, time) == pytest.approx(tip_at(fine, time), abs=2e-3 * arm().length)


@pytest.mark.parametrize("force", [5e-3, 5e-5, 5e-6])
def test_a_small_motion_rings_as_a_large_one(force: float) -> None:
    """From amplitudes of 14 mm to 0.01 mm."""
    body = Body(arm(), RUBBER)
    mode = frequencies(body, 0.0, count=1)[0]
    motion = move(body, 0.0, 3.0, Loading(), Start(acting=Loading((0.0, force))))
    time = np.linspace(0.0, 3.0, 900)
    ringing = DampedOscillation.of(time, CubicSpline(motion.times_s, motion.tips[:, 1])(time))
    assert ringing.frequency == pytest.approx(mode.frequency_hz, rel=5e-3)
    assert ringing.damping == pytest.approx(mode.damping_ratio, rel=3e-2)


def test_a_motion_ends_where_the_law_does() -> None:
    """Under a load that the law does not bear; a short wave may pass, which is told."""
    heavy = Loading(tip_mass="40 g", direction="lying")
    motion = move(Body(arm(), RUBBER), 0.0, 2.0, heavy, Start(acting=Loading()))
    known = arm().at(0.0).section.kappa
    assert f"the law, which is known from {known[0]:.3g} to {known[-1]:.3g} 1/mm" in motion.reason
    assert motion.times_s[-1] < 0.5
    assert motion.beyond_per_mm.max() <= 0.1 * np.ptp(known)
    waved = move(Body(arm(), RUBBER), 17.0, 0.4)
    assert (waved.reason, waved.beyond_per_mm[0]) == ("", 0.0)
    assert waved.notes[0].startswith(f"Cells bend by up to {waved.beyond_per_mm.max():.3g} 1/mm beyond")
    stiff = Body(arm(), Relaxation.from_loss_factor(0.02, 1.0, 10.0))
    at_once = move(stiff, 0.0, 0.06, start=Start(26.71), steps=Steps(6e-3))  # in its first step
    assert (at_once.times_s.tolist(), "beyond the law" in at_once.reason) == ([0.0], True)
    assert move(stiff, 5.0, 3.0, steps=Steps(0.5)).reason.startswith("A step of 0.5 s does not resolve a vibration")


@pytest.mark.parametrize(("pressure", "step"), [(31.228, 1e-3), (32.389, 2e-3), (34.0, 2e-3)])
def test_a_sudden_pressure_with_walls_that_touch_is_followed(pressure: float, step: float) -> None:
    """Between two pressures the clamped end is known badly at its last moments; it jumped there."""
    assert move(Body(arm(), RUBBER), pressure, 0.06, steps=Steps(step)).reason == ""


def test_an_arm_in_a_loop_moves_as_under_a_table() -> None:
    rows = np.column_stack([np.linspace(0.0, 0.5, 101), 5.0 * np.sin(np.linspace(0.0, 3.0, 101)) ** 2])
    table, arm_now = move(Body(arm(), RUBBER), rows, 0.5), MovingArm.at_rest(Body(arm(), RUBBER))
    seen = [arm_now.step(0.005, pressure_kPa=pressure) for pressure in rows[1:, 1]]
    for time in (0.1, 0.3, 0.5):
        now = seen[round(time / 0.005) - 1]
        assert now.time == pytest.approx(time)
        assert now.tip == pytest.approx(tip_at(table, time), abs=2e-3 * arm().length)
        assert now.pressure == pytest.approx(np.interp([time], *rows.T))
    assert seen[-1].shape.shape == (len(table.s), 2)
    assert seen[-1].curvature.shape == (len(table.s) - 1,)


def test_a_force_in_a_loop_bends_the_arm_into_its_equilibrium() -> None:
    body = Body(airy(), Relaxation.from_loss_factor(0.4, 1.0, 10.0))
    now = MovingArm.at_rest(body, 20.0)
    for _ in range(400):
        seen = now.step(0.01, force=(0.0, 0.02))
    still = airy().at(20.0).solve(force=(0.0, 0.02))
    assert seen.tip == pytest.approx(still.end, abs=5e-3 * airy().length)
    assert seen.volume[0] == pytest.approx(airy().at(20.0).volumes(still), rel=1e-3)
    assert seen.angle == pytest.approx(math.degrees(still.theta[-1]), abs=1.0)


@pytest.mark.parametrize("in_space", [False, True])
def test_a_copy_and_a_stored_state_go_on_as_the_arm_does(in_space: bool) -> None:
    law = replace(test_space_law.law(), mass=Mass.even(test_space_law.LENGTH, 15.0)) if in_space else arm()
    body, high = Body(law, RUBBER), (5.0, 2.0, 1.0) if in_space else 8.0
    first = MovingArm.at_rest(body)
    for _ in range(20):
        first.step(0.005, pressure_kPa=high)
    other, stored = first.copy(), {name: value.copy() for name, value in first.state.items()}
    later = MovingArm.at_rest(body)
    later.state = stored
    ends = []
    for one in (first, other, later):
        for _ in range(20):
            seen = one.step(0.005, pressure_kPa=np.multiply(0.5, high), force=(1e-4, 0.0))
        ends.append(seen)
    for seen in ends[1:]:
        assert seen.time == ends[0].time
        np.testing.assert_array_equal(seen.shape, ends[0].shape)
    assert ends[0].shape.shape[1] == (3 if in_space else 2)
    assert ends[0].pressure.shape == (3 if in_space else 1,)


def test_a_step_that_fails_leaves_the_arm_where_it_was() -> None:
    now = MovingArm.at_rest(Body(arm(), RUBBER))
    now.step(0.01, pressure_kPa=2.0)
    before = now.state
    for more, told in (
        ({"pressure_kPa": 90.0}, "is outside"),
        ({"pressure_kPa": (1.0, 2.0)}, "a number for each of"),
        ({"force": (0.0, 0.0, 1.0)}, "in space from the start"),
        ({"force": (0.0, 5.0)}, "beyond the law"),
    ):
        with pytest.raises(RodError, match=told):
            now.step(0.2, **more)
        for name, value in now.state.items():
            np.testing.assert_array_equal(value, before[name])
    with pytest.raises(RodError, match="no state of this arm"):
        now.state = {"time": np.zeros(1)}


def test_an_arm_without_loss_is_followed_by_short_steps() -> None:
    """Its clamped end has no mass, and its moment and force come and go with every wave along the arm."""
    motion = move(Body(arm()), 20.0, 0.05, steps=Steps(fixed=5e-4))
    assert motion.reason == ""


def test_a_free_inflated_arm_creeps_as_if_its_pressure_grew() -> None:
    """kappa_0(p J): moment and pressure scale with the modulus."""
    rubber = Relaxation((0.8, 0.1), (0.08, 10.0))
    motion = move(Body(arm(), rubber), 20.0, 6.0)
    for time in (4.0, 6.0):
        felt = 20.0 * float(rubber.creep.compliance(time))
        assert tip_at(motion, time) == pytest.approx(arm().at(felt).solve().end, abs=2e-3 * arm().length)
    assert motion.pressures_kPa[-1] == pytest.approx([20.0])


def with_base(part: float) -> ArmLaw:
    """The coarse arm, with derivatives by the moduli of its body and of a base that has a part of them."""
    cells, clamps = arm().cells, arm().clamps
    moments = [c.moment - c.pressure * c.moment_by_pressure for c in cells]  # moduli and pressure scale the moment
    still = [np.zeros_like(c.moment) for c in cells], [np.zeros((len(c.moment), 2, 2)) for c in cells]
    rows = tuple(CellRate(*parts, np.array(0.0)) for parts in zip(moments, *still, strict=True))
    ends = tuple(ClampRate(np.zeros_like(c.rotation), np.zeros_like(c.offset)) for c in clamps)
    whole = LawRate(1.0, "MPa", 0.0, 0.0, 0.0, rows, ends)
    return replace(arm(), rates={"material.E": whole.times(1.0 - part), "materials.base.E": whole.times(part)})


def test_regions_share_what_an_arm_carries_by_the_derivatives_of_its_law() -> None:
    parts = shares_of(with_base(0.3), (("material",), ("materials.base",)), 17.0)
    for part, share in zip(parts, (0.7, 0.3), strict=True):
        assert part == pytest.approx((share, share), rel=1e-2)
    both = mixed((RUBBER, Relaxation((0.2,), RUBBER.times_s[:1])), (0.7, 0.3))
    assert both.times_s == RUBBER.times_s
    assert both.shares == pytest.approx((0.7 * RUBBER.shares[0] + 0.06, *(0.7 * g for g in RUBBER.shares[1:])))
    with pytest.raises(RodError, match="no derivatives by the moduli of materials"):
        shares_of(arm(), (("materials.base",),), 17.0)


def test_a_loaded_bar_creeps_and_a_held_one_relaxes() -> None:
    """As J and G; the bar is held at a height while a load is taken from its middle."""
    rubber, force = Relaxation((0.3, 0.2), (0.05, 8.0)), 1e-3
    motion = move(Body(BAR, rubber), 0.0, 5.0, Loading((0.0, force)), Start(acting=Loading()))
    sag = force * LENGTH**3 / (3.0 * B)
    assert motion.tips[-1, 1] == pytest.approx(sag * float(rubber.creep.compliance(5.0)), rel=3e-3)
    held = Start(acting=Loading((0.0, force)))
    back = move(Body(BAR, rubber), 0.0, 5.0, Loading(), held).tips[-1, 1]
    assert back == pytest.approx(sag * (1.0 - float(rubber.creep.compliance(5.0))), rel=2e-2)


@pytest.mark.parametrize("grams", [0.0, 5.0, 40.0])
def test_damping_is_half_the_loss_factor_at_every_frequency(grams: float) -> None:
    """Of a bar whose first frequency is 3 to 8 Hz; the motion decays as the ratio says."""
    rubber = Relaxation.from_loss_factor(0.1, 1.0, 30.0)
    acting = Loading(tip_mass=grams)
    mode = frequencies(Body(BAR, rubber), 0.0, acting)[0]
    assert mode.damping_ratio == pytest.approx(0.05, rel=0.08)
    period = 1.0 / mode.frequency_hz
    bent = Start(acting=Loading(along=mode_loads(), tip_mass=grams))
    motion = move(Body(BAR, rubber), 0.0, 6.0 * period, acting, bent, Steps(fixed=period / 150.0))
    assert decrement(motion) == pytest.approx(2.0 * math.pi * mode.damping_ratio, rel=0.05)


def decrement(motion: Motion) -> float:
    """Logarithmic, of the height of the tip."""
    turns = np.diff(np.sign(np.diff(motion.tips[:, 1])))
    swing = np.abs(np.diff(motion.tips[np.flatnonzero(turns) + 1, 1]))
    return math.log(swing[2] / swing[6]) / 2.0


def test_what_the_pressure_adds_to_the_rigidity_does_not_relax() -> None:
    """Moments beside the curvature without load give the rigidity there with and without pressure."""
    rod, still, h = arm().at(10.0), arm().at(0.0), 2e-4
    kappa = rod.section.kappa_0 + np.array([-h, h])
    moments = [np.interp(kappa, one.section.kappa, one.section.moment) for one in (rod, still)]
    with_it, without = np.diff(moments)[:, 0]
    body = Body(arm(), Relaxation.from_loss_factor(0.1, 0.5, 50.0))
    part = body.relaxing(rod)
    assert part == pytest.approx(without / with_it, rel=0.02)
    assert part == pytest.approx(0.75, abs=0.02)
    mode = frequencies(body, 10.0)[0]
    assert mode.damping_ratio == pytest.approx(0.05 * part, rel=0.1)
    period = 1.0 / mode.frequency_hz
    pulled = Start(10.0, Loading((0.0, 2e-3)))
    motion = move(body, 10.0, 6.0 * period, Loading(), pulled, Steps(fixed=period / 150.0))
    assert decrement(motion) == pytest.approx(2.0 * math.pi * mode.damping_ratio, rel=0.05)


def test_the_rubber_relaxes_wholly_where_pressure_adds_nothing() -> None:
    """To lines, to a law of chambers whose rigidity stays; and where a law is not known without pressure."""
    space = test_space_law.law()
    assert Body(BAR).relaxing(BAR.arm) == 1.0
    assert Body(space).relaxing(space.at((5.0, 2.0, 0.0))) == pytest.approx(1.0)
    assert Body(airy()).relaxing(airy().at(20.0)) == pytest.approx(1.0)
    high = law_of(*map(test_volumes.part, (10.0, 20.0)))
    assert Body(high).relaxing(high.at(20.0)) == 1.0


@pytest.mark.parametrize("exponent", [1.0, 1.4])
def test_air_that_is_shut_in_keeps_its_amount_under_a_force(exponent: float) -> None:
    """The motion ends in the equilibrium with as much air."""
    air, force = Air(exponent=exponent, dead_volume=2000.0), (0.0, 0.02)
    rubber = Relaxation.from_loss_factor(0.4, 1.0, 10.0)
    motion = move(Body(airy(), rubber), air, 4.0, Loading(force), Start(20.0, Loading()))
    pressure, volume = motion.pressures_kPa[:, 0], motion.volumes_mm3[:, 0]
    amounts = [air.amount(p, v) for p, v in zip(pressure, volume, strict=True)]
    assert np.ptp(amounts) < 1e-5
    law = airy().at(float(pressure[-1]))
    still = law.solve(force=force)
    assert volume[-1] == pytest.approx(law.volumes(still), rel=1e-3)
    assert motion.tips[-1] == pytest.approx(still.end, abs=5e-3 * airy().length)
    assert pressure[-1] > 20.2


def test_a_supply_fills_the_arm_up_to_its_pressure_and_a_flow_fills_it_evenly() -> None:
    blown = move(Body(airy(), RUBBER), Air(supply=20.0, conductance=2000.0), 2.0)
    assert blown.pressures_kPa[-1] == pytest.approx([20.0], abs=0.05)
    air = Air(flow=[[0.0, 1000.0], [0.5, 1000.0], [0.5001, 0.0]])
    filled = move(Body(airy(), RUBBER), air, 0.5)
    inside = [(101.325 + p) * v for p, v in zip(filled.pressures_kPa[:, 0], filled.volumes_mm3[:, 0], strict=True)]
    assert (inside[-1] - inside[0]) / 101.325 == pytest.approx(500.0, rel=1e-2)


def test_an_arm_swings_across_its_plane_and_in_it_as_in_the_plane() -> None:
    law = law_of_straight(planar=2000.0, lateral=1500.0, torsional=500.0, shear=1e4, axial=1e4, in_plane_shear=1e4)
    body = Body(law, spread=(6.0, 8.0))
    flat, across = frequencies(body, 10.0, count=1)[::-1]
    assert (flat.in_plane, across.in_plane) == (True, False)
    assert flat.frequency_hz / across.frequency_hz == pytest.approx(math.sqrt(2000.0 / 1500.0), rel=0.02)
    fixed = Steps(fixed=0.002)
    swung = Start(10.0, Loading((0.0, 0.0, 1e-3)))
    motion = move(body, 10.0, 0.6, Loading(), swung, fixed)
    z = motion.tips[:, 2]
    k = np.flatnonzero(np.diff(np.sign(z)))
    zeros = motion.times_s[k] - z[k] * 0.002 / (z[k + 1] - z[k])
    assert 0.5 / np.diff(zeros).mean() == pytest.approx(across.frequency_hz, rel=0.02)
    assert np.abs(motion.tips[:, 1] - motion.tips[0, 1]).max() < 1e-2 * np.abs(z).max()
    bent = Start(10.0, Loading((0.0, 0.02)))
    plane, space = (move(body, 10.0, 0.2, Loading(), bent, fixed._replace(in_space=flag)) for flag in (False, True))
    assert space.tips[:, :2] == pytest.approx(plane.tips, abs=1e-4)
    assert space.axis.shape[2] == 3


def test_a_law_of_two_curvatures_moves_to_its_equilibrium() -> None:
    law = replace(test_space_law.law(), mass=Mass.even(test_space_law.LENGTH, 15.0))
    pressures = (5.0, 2.0, 0.0)
    motion = move(Body(law, Relaxation.from_loss_factor(0.4, 1.0, 10.0)), pressures, 2.0, steps=Steps(fixed=0.01))
    assert motion.tips[-1] == pytest.approx(law.at(pressures).solve_in_space(Load()).end, abs=0.05)
    assert motion.pressures_kPa.shape[1] == motion.volumes_mm3.shape[1] == 3


def test_a_mass_hangs_on_its_end_and_a_support_holds_it() -> None:
    hanging = Loading(tip_mass="5 g", direction="lying")
    body = Body(BAR, Relaxation.from_loss_factor(0.4, 1.0, 30.0))
    motion = move(body, 0.0, 3.0, hanging, Start(acting=Loading()))
    still = BAR.solve(direction="lying", tip_mass="5 g")
    assert motion.tips[-1] == pytest.approx(still.end, abs=0.02)
    prop = Loading(along=[Support(LENGTH, y=0.0)], direction="lying")
    light = Loading(along=[Support(LENGTH, y=0.0)])
    held = move(body, 0.0, 3.0, prop, Start(acting=light))
    weight = 9.81e-3 * GRAMS
    assert held.tips[-1, 1] == pytest.approx(0.0, abs=1e-6)
    assert held.reactions[-1] == pytest.approx([3.0 / 8.0 * weight], rel=2e-2)


def test_what_cannot_begin_is_refused_and_what_ends_early_says_why() -> None:
    body = Body(arm(), RUBBER)
    for pressure, told in (
        ([[0.0, 1.0], [0.0, 2.0]], "must rise"),
        ([[0.1, 1.0], [0.2, 2.0]], "from 0 s on"),
        ("much", "is a number in kPa"),
        ([1.0, 2.0], "is a number in kPa"),
    ):
        with pytest.raises(RodError, match=told):
            move(body, pressure, 1.0)
    with pytest.raises(RodError, match="The mass of the arm is not known"):
        move(Body(replace(arm(), mass=None)), 20.0, 1.0)
    with pytest.raises(RodError, match="has no volumes"):
        move(body, Air(), 1.0)
    with pytest.raises(RodError, match="from 1 to"):
        Air(exponent=2.0)
    high = float(arm().pressures[-1])
    early = move(body, [[0.0, 0.0], [0.5, 1.5 * high]], 0.5, steps=Steps(fixed=0.01))
    assert "is outside" in early.reason
    assert 0.3 < early.times_s[-1] < 0.5
    coarse = move(Body(arm()), 20.0, 2.0, steps=Steps(fixed=0.2))
    assert "does not resolve a vibration" in coarse.reason
    assert early.shapes([0.0, 1.0]).shape == (2, len(early.s), 2)
