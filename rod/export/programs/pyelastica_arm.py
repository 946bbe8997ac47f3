"""A pneumatic arm in PyElastica, written by pneurod. SI units; it bends in the plane x, y.

    python THIS_FILE --pressure 17 --force 0 0.02 --plot arm.png

simulates the arm until it rests under a pressure in kPa and a dead force on its end in N, and prints where the end is.
A third component of the force acts along z, if the arm is known to turn out of its plane.
`build`, `Law`, `simulate` and `curve` can be imported from another program.
"""

import argparse
import sys

import elastica
import numpy as np

from rod.export.programs.table import TABLE, at

#: the arm rests where no node moves faster than this part of the length in the time of a radian of its first vibration
REST = 1e-5


def _springs(now, turn):
    """Moments (m,) and their slopes (m,) of the hinges at angles (m,)."""
    kind, rows = TABLE["kind"], np.arange(len(turn))
    angle, moment = now["angle_rad"][kind], now["moment_N_m"][kind]
    i = (turn[:, None] > angle[:, 1:-1]).sum(axis=1)
    slope = (moment[rows, i + 1] - moment[rows, i]) / (angle[rows, i + 1] - angle[rows, i])
    return moment[rows, i] + slope * (turn - angle[rows, i]), slope


def _legs(now):
    """(m, 2): from each hinge to the next one, and from the last to the end of the material curve."""
    return np.vstack([now["legs_m"], now["points_m"][-1]])


def _directions(now):
    """(m,): angles of the legs in their pieces."""
    return np.arctan2(*_legs(now).T[::-1])


def _turned(vectors, angles):
    """Vectors (n, 2) turned by angles (n,)."""
    cosine, sine = np.cos(angles), np.sin(angles)
    return np.stack([vectors[:, 0] * cosine - vectors[:, 1] * sine, vectors[:, 0] * sine + vectors[:, 1] * cosine], 1)


def equilibrium(pressure_kPa, force=(0.0, 0.0)):
    """Angles (m,) of the hinges under a dead force (x, y) on the end, by Newton's method, without shear."""
    now = at(pressure_kPa)
    turn = now["angle_rad"][TABLE["kind"], TABLE["rest"]]
    behind = np.maximum.outer(np.arange(len(turn)), np.arange(len(turn)))
    for _ in range(100):
        legs = _turned(_legs(now), np.cumsum(turn))
        lever = np.cumsum(legs[::-1], axis=0)[::-1]
        moment, slope = _springs(now, turn)
        missing = lever[:, 0] * force[1] - lever[:, 1] * force[0] - moment
        matrix = np.diag(slope) + lever[behind, 1] * force[1] + lever[behind, 0] * force[0]
        step = np.linalg.solve(matrix, missing)
        turn = turn + step * min(1.0, 0.2 / max(np.abs(step).max(), 1e-300))
        if np.abs(step).max() < 1e-10:
            return turn
    raise ValueError(f"no equilibrium under {force[0]:g}, {force[1]:g} N was found")


def build(pressure_kPa, force=(0.0, 0.0)):
    """The CosseratRod in its equilibrium in the plane; `Law` has to act on it. Its first element is clamped."""
    now, turn = at(pressure_kPa), equilibrium(pressure_kPa, force)
    base = now["base_m"]
    nodes = np.cumsum(np.vstack([[0.0, base[1]], [base[0], 0.0], _turned(_legs(now), np.cumsum(turn))]), axis=0)
    lengths = np.linalg.norm(np.diff(nodes, axis=0), axis=1)
    area = np.pi * TABLE["radius"] ** 2
    rod = elastica.CosseratRod.straight_rod(
        len(lengths),
        np.array([*nodes[0], 0.0]),
        np.array([1.0, 0.0, 0.0]),
        np.array([0.0, 0.0, 1.0]),
        lengths.sum(),
        TABLE["radius"],
        TABLE["mass"] / (area * lengths.sum()),
        youngs_modulus=now["axial_N"] / area,
        position=np.vstack([nodes.T, np.zeros(len(nodes))]),
    )
    for k, rigidity in enumerate((now.get("sideways_shear_N", now["shear_N"]), now["shear_N"], now["axial_N"])):
        rod.shear_matrix[k, k, :] = rigidity
    Law(pressure_kPa).apply_forces(rod)
    return rod


def time_step(rod, pressure_kPa):
    """A stable time step in s for PositionVerlet: that of waves of stretch, and of the turning of an element."""
    now = at(pressure_kPa)
    lengths = rod.rest_lengths
    stretch = 2.0 / lengths * np.sqrt(now["axial_N"] * lengths / rod.mass[1:])
    slope = (np.diff(now["moment_N_m"]) / np.diff(now["angle_rad"])).max()
    shear = now["shear_N"]
    if "twist_N_m" in now:
        slope = max(slope, now["twist_N_m"].max(), now["sideways_N_m"].max())
        shear = max(shear, now["sideways_shear_N"])
    inertia = rod.mass_second_moment_of_inertia[0, 0]
    turning = np.sqrt((shear * lengths + 4.0 * slope) / inertia)
    return 0.5 / max(stretch.max(), turning.max())


def first_vibration(pressure_kPa):
    """Its angular frequency in 1/s, as if the arm were straight."""
    return TABLE["loss_factor"] / float(at(pressure_kPa)["damping_time_s"])


class Law(elastica.NoForces):
    """The arm follows its law under a pressure in kPa, a number or a function of the time in s.

    At each step the bending stiffness is the tangent of the law at the present curvature, and the rest curvature that
    with which the moment is the one of the law.
    """

    def __init__(self, pressure_kPa):
        super().__init__()
        self.pressure = pressure_kPa if callable(pressure_kPa) else lambda time: pressure_kPa
        self.present = None

    def apply_forces(self, system, time=0.0):
        """Set bending stiffness, rest curvature and rest stretch."""
        pressure = self.pressure(time)
        if pressure != self.present:
            self.present, self.now = pressure, at(pressure)
            directions = _directions(self.now)
            self.offset = np.diff(directions, prepend=0.0)
            lengths = np.linalg.norm(np.vstack([self.now["base_m"][:1].repeat(2) * [1, 0], _legs(self.now)]), axis=1)
            system.rest_sigma[2, 1:] = lengths[1:] / system.rest_lengths[1:] - 1.0
            self.sideways = _out_of_plane(self.now) if "twist_N_m" in self.now else None
        between = system.rest_voronoi_lengths
        turn = system.kappa[0] * between - self.offset
        moment, slope = _springs(self.now, turn)
        system.bend_matrix[0, 0, :] = slope * between * system.voronoi_dilatation**3
        system.rest_kappa[0, :] = (turn + self.offset - moment / slope) / between
        if self.sideways is not None:
            system.bend_matrix[1:, 1:, :] = self.sideways * between * system.voronoi_dilatation**3


def _out_of_plane(now):
    """(2, 2, m) N m/rad: stiffness against turns about the second and third director, the latter along the elements."""
    directions = _directions(now)
    neutral = now["angle_rad"][TABLE["kind"], TABLE["rest"]]
    middle = 0.5 * (np.append(0.0, directions[:-1]) + neutral + directions)
    cosine, sine = np.cos(now["sideways_axis_rad"] - middle), np.sin(now["sideways_axis_rad"] - middle)
    axes = np.array([[-sine, cosine], [-cosine, -sine]])
    stiffness = np.array([now["twist_N_m"], now["sideways_N_m"]])
    to_end = TABLE["length"] - now["base_m"][0]  # from the node in which the clamped end bends, somewhat beside it
    stiffness[1, 0] *= (to_end / (to_end - now["sideways_centre_m"][0, 0])) ** 2
    return np.einsum("kim,km,kjm->ijm", axes, stiffness, axes)


def curve(rod, pressure_kPa):
    """The material curve of the arm at the rest arc lengths TABLE["s_m"] in m: (m, 2), or (m, 3) if the arm is known to
    turn out of its plane."""
    now = at(pressure_kPa)
    if "twist_N_m" in now:
        along = rod.tangents[:, 1:]
        across = np.cross(rod.director_collection[0, :, 1:], along, axis=0)
        across /= np.linalg.norm(across, axis=0)
        cosine, sine = np.cos(_directions(now)), np.sin(_directions(now))
        x, y = now["points_m"].T
        in_plane = (x * cosine + y * sine) * along + (y * cosine - x * sine) * across
        return (rod.position_collection[:, 1:-1] + in_plane).T
    nodes = rod.position_collection[:2, 1:]
    legs = np.diff(nodes, axis=1)
    return nodes[:, :-1].T + _turned(now["points_m"], np.arctan2(legs[1], legs[0]) - _directions(now))


class _Simulator(elastica.BaseSystemCollection, elastica.Constraints, elastica.Forcing, elastica.Damping):
    """One clamped arm with a force on its end."""


def simulate(pressure_kPa, force=(0.0, 0.0), seconds=None, damping=None, tell=None):
    """The rod at the end of a simulation under a pressure in kPa and a dead force (x, y) or (x, y, z) on its end in N.

    pressure_kPa: a number, or a function of the time in s, with `seconds`. It starts from the equilibrium at the
    beginning. seconds: simulated time; None: until the arm rests. damping: rate in 1/s at which velocities decay; None:
    twice the first vibration, with which the arm settles soonest; that of the rubber is TABLE["loss_factor"] times the
    first vibration. tell: is called with the time in s and the rod, every 200 steps.
    """
    if callable(pressure_kPa) and seconds is None:
        raise ValueError("with a pressure that changes over time, give the seconds to simulate")
    first = pressure_kPa(0.0) if callable(pressure_kPa) else pressure_kPa
    last = pressure_kPa(seconds) if callable(pressure_kPa) else pressure_kPa
    rod, simulator, frequency = build(first, force), _Simulator(), first_vibration(first)
    if seconds is None and not any(force):
        return rod  # it began in its equilibrium, from which nothing moves it
    step = min(time_step(rod, first), time_step(rod, last))
    simulator.append(rod)
    simulator.add_forcing_to(rod).using(Law, pressure_kPa)
    simulator.constrain(rod).using(
        elastica.FixedConstraint, constrained_position_idx=(0, 1), constrained_director_idx=(0,)
    )
    if len(force) > 2 and "twist_N_m" not in TABLE:
        raise ValueError("nothing is known of this arm out of its plane; write it from a law with law_in_space: true")
    end = np.array([*force, 0.0])[:3]
    simulator.add_forcing_to(rod).using(elastica.EndpointForces, np.zeros(3), end, ramp_up_time=1e-12)
    rate = 2.0 * frequency if damping is None else damping
    simulator.dampen(rod).using(elastica.AnalyticalLinearDamper, uniform_damping_constant=rate, time_step=step)
    simulator.finalize()
    stepper, time, count = elastica.PositionVerlet(), np.float64(0.0), 0
    while seconds is None or time < seconds:
        time, count = stepper.step(simulator, time, step), count + 1
        if count % 200 == 0:
            speed = float(np.linalg.norm(rod.velocity_collection, axis=0).max())
            if tell is not None:
                tell(float(time), rod)
            if not np.isfinite(speed):
                raise ValueError("the simulation became unstable")
            slow = REST * TABLE["length"] * frequency * min(1.0, time * frequency)  # it began without any speed
            if seconds is None and speed < slow:
                break
    return rod


def plot(curves, file):
    """Draw material curves by their labels into a file, from the clamp at the origin on."""
    import matplotlib.pyplot as plt

    plt.switch_backend("Agg")
    figure, axes = plt.subplots()
    for label, points in curves.items():
        axes.plot(*(1e3 * np.vstack([[0.0, 0.0], points[:, :2]]).T), label=label)
    axes.set(xlabel="x, mm", ylabel="y, mm", aspect="equal")
    axes.legend()
    figure.savefig(file, dpi=150)


def main():
    """Simulate the arm and print where its end comes to rest."""
    options = argparse.ArgumentParser(description="A pneumatic arm in PyElastica.")
    options.add_argument("--pressure", type=float, nargs="+", default=TABLE["known_kPa"][-1:], help="kPa")
    options.add_argument("--force", type=float, nargs="+", default=(0.0, 0.0), metavar="F", help="N, along x, y, z")
    options.add_argument("--seconds", type=float, help="simulated time (default: until the arm rests)")
    options.add_argument("--plot", metavar="FILE", help="draw the curves into this file")
    given = options.parse_args()

    def tell(time, rod):
        speed = 1e3 * np.linalg.norm(rod.velocity_collection, axis=0).max()
        sys.stderr.write(f"\r{pressure:g} kPa: {time:.2f} s simulated, fastest node {speed:.2g} mm/s    ")

    curves = {}
    for pressure in given.pressure:
        rod = simulate(pressure, given.force, given.seconds, tell=tell)
        sys.stderr.write("\n")
        points = curves[f"{pressure:g} kPa"] = curve(rod, pressure)
        end = zip("xyz", 1e3 * points[-1], strict=False)
        print(f"{pressure:g} kPa: end at {', '.join(f'{axis} = {value:.2f} mm' for axis, value in end)}")
    if given.plot:
        plot(curves, given.plot)
        print(f"picture: {given.plot}")


if __name__ == "__main__":
    main()
