"""Laws fitted to tensile tests: weighted, with constants that stay sane, and stable wherever an arm may need them.

A tensile test tells little about two directions at once, in which an inflated wall is pulled. So constants are sought
that keep the stress rising in uniaxial, planar and equibiaxial tension and in compression, and constants that tensile
tests determine badly are held near those of neo-Hooke's law unless the points say otherwise.
"""

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from typing import final

import numpy as np
from scipy.optimize import LinearConstraint, least_squares, minimize

from fem.materials import LAWS, LinearLaw, Material, MaterialError, NeoHooke, Ogden
from fem.materials.rubber import first_invariant
from geometry.arrays import Array, Mask
from pipeline.answers.material.loading import TensileTest, scatter

#: stretch of the second axis in the tests in which laws are judged; the third side is free, the body incompressible
STATES: dict[str, Callable[[Array], Array]] = {
    "uniaxial": lambda s: s**-0.5,
    "planar": np.ones_like,
    "equibiaxial": lambda s: s,
}
#: distance of the bins of points in ln(stretch)
BIN = 0.02
#: error of a stress beside its scatter, over the stress and over the largest one: so that small strains count
RELATIVE_ERROR, LEAST_ERROR = 0.02, 0.002
#: stretches per unit of ln(stretch) at which the stress has to rise, and its least slope over that at rest
PER_LOG, LEAST_SLOPE = 30, 0.005
#: by constant: its standard deviation over half the modulus of neo-Hooke's law, and the power of the largest I1 - 3
#: of the tests by which it is divided; whether it may be negative
SPREADS: dict[str, tuple[float, int, bool]] = {"c01": (0.3, 0, False), "c20": (1.0, 1, True), "c30": (1.0, 2, True)}
#: part of the stress below which a constant is none
NOTHING = 1e-4
#: exponents of Ogden's law: mean and standard deviation, bounds, and those of the first and of another term at which
#: the search begins
EXPONENT, EXPONENTS, STARTS, SECOND = (2.0, 2.0), (-3.0, 8.0), (0.7, 1.5, 3.0, 5.0), (-2.0, 0.7)


@dataclass(frozen=True)
class Points:
    """The points of all tests in bins of stretch, with the error of each."""

    stretch: Array  #: (n,) ascending
    stress: Array  #: (n,) MPa, mean of the tests
    error: Array  #: (n,) MPa, standard error of the mean from scatter alone
    spread: float  #: standard deviation between tests over the stress; NaN for one test
    state: Array  #: (n,) name of `STATES`

    @staticmethod
    def of(tests: tuple[TensileTest, ...]) -> "Points":
        """The mean over tests of the means of each test in each bin, apart for each state."""
        bins: dict[tuple[int, str], list[tuple[float, float, float]]] = {}
        for test in tests:
            noise = scatter(test.stretch, test.stress)
            number = np.round(np.log(test.stretch) / BIN).astype(int)
            for k in np.unique(number):
                inside = number == k
                mean = float(test.stretch[inside].mean()), float(test.stress[inside].mean())
                bins.setdefault((int(k), test.state), []).append((*mean, noise / np.sqrt(inside.sum())))
        count = Counter(test.state for test in tests)  # where a test ends the mean would jump
        bins = {key: of for key, of in bins.items() if 2 * len(of) > count[key[1]]} or bins
        rows = np.array([(*np.mean(of, axis=0)[:2], np.sqrt(np.mean(np.square(of), axis=0)[2] / len(of)))
                         for of in bins.values()])  # fmt: skip
        whole = [np.array(of)[:, 1] for key, of in bins.items() if len(of) == count[key[1]] > 1]
        apart = [np.std(stresses, ddof=1) / abs(np.mean(stresses)) for stresses in whole if np.mean(stresses)]
        order = np.argsort(rows[:, 0], kind="stable")
        stretch, stress, error = rows[order].T
        spread = float(np.median(apart)) if apart else np.nan
        return Points(stretch, stress, error, spread, np.array([state for _, state in bins])[order])

    def within(self, low: float, high: float) -> "Points":
        """The points at stretches between two others."""
        inside = (self.stretch >= low * (1 - 1e-9)) & (self.stretch <= high * (1 + 1e-9))
        stretch, stress, error, state = (of[inside] for of in (self.stretch, self.stress, self.error, self.state))
        return Points(stretch, stress, error, self.spread, state)

    def by_state(self, of: Callable[[Array, Array | None], Array]) -> Array:
        """(n, ...) a function of the stretches along and across, which are None for bars with free sides."""
        found = {
            state: of(self.stretch, None if state == "uniaxial" else STATES[state](self.stretch))
            for state in dict.fromkeys(self.state.tolist())
        }
        return np.array([found[state][k] for k, state in enumerate(self.state.tolist())])

    @property
    def weight(self) -> Array:
        """(n,) one over the error that a fit may have, 1/MPa."""
        size = np.abs(self.stress)
        return np.asarray(1 / np.sqrt(self.error**2 + (RELATIVE_ERROR * size) ** 2 + (LEAST_ERROR * size.max()) ** 2))

    @property
    def modulus(self) -> float:
        """Shear modulus of the neo-Hookean law that fits best, MPa."""
        pull, weight = self.by_state(lambda s, across: NeoHooke.uniaxial_terms(s, across)["mu"]), self.weight
        return float(np.sum(weight**2 * pull * self.stress) / np.sum((weight * pull) ** 2))


@dataclass(frozen=True)
class Form(ABC):
    """A law as it is fitted; constants are (k,)."""

    law: str  #: as in a configuration
    name: str  #: in tables
    constants: tuple[str, ...]  #: names

    @abstractmethod
    def fitted(self, points: Points, reach: float) -> Array:
        """The constants that fit best and whose stress rises up to the stretch `reach` in every state."""

    @abstractmethod
    def solved(self, constants: Array, nu: float) -> Material:
        """The law with the Poisson ratio nu. Raises `fem.MaterialError`."""


def predicted(law: Material, points: Points) -> Array:
    """Nominal stress (n,) in MPa at points: of the solver's law for bars, else of the incompressible body."""

    def of(stretch: Array, across: Array | None) -> Array:
        return law.uniaxial(stretch).nominal if across is None else law.incompressible(stretch, across)

    return points.by_state(of)


def stretches(low: float, high: float) -> Array:
    """(n,) from `low` below 1 to `high`, with 1."""
    down, up = (np.linspace(0, np.log(end), int(PER_LOG * abs(np.log(end))) + 2) for end in (low, high))
    return np.exp(np.unique(np.concatenate([down, up])))


def is_stable(law: Material, state: str, stretch: Array) -> Mask:
    """(n,) whether more strain needs more stress at stretches (n,) in one of `STATES`.

    The nominal stress rises, and so does the energy whatever the next strain: its second derivative by the logarithms
    of two stretches is positive definite (R. Hill, J. Mech. Phys. Solids 16 (1968) 229).
    """
    step, across = 1e-4, STATES[state](stretch)

    def at(first: float, second: float) -> tuple[Array, Array]:
        a, b = stretch * np.exp(first), across * np.exp(second)
        return a * law.incompressible(a, b), b * law.incompressible(b, a)

    (xx, yx), (xy, yy) = (
        tuple((up - down) / (2 * step) for up, down in zip(at(*by), at(*(-np.array(by))), strict=True))
        for by in ((step, 0.0), (0.0, step))
    )
    more = stretch * (1 + step)
    slope = law.incompressible(more, STATES[state](more)) - law.incompressible(stretch, across)
    return np.asarray((slope > 0) & (xx + yy > 0) & (xx * yy - xy * yx > 0))


@final
@dataclass(frozen=True)
class LinearForm(Form):
    """A law whose stress is linear in its constants."""

    kind: type[LinearLaw]

    def fitted(self, points: Points, reach: float) -> Array:
        half, invariant = points.modulus / 2, float(points.by_state(first_invariant).max())
        if half <= 0:
            raise MaterialError(f"{self.kind.title}: the stress falls")
        rows = points.by_state(self._terms) * half * points.weight[:, None]
        spreads = [SPREADS.get(name, (np.inf, 0, True)) for name in self.constants]
        prior = np.diag([invariant**power / spread for spread, power, _ in spreads])
        matrix = np.vstack([rows, prior])
        target = np.concatenate([points.weight * points.stress, np.zeros(len(prior))])
        best = np.linalg.lstsq(matrix, target)[0]
        slopes = self._slopes(reach)
        least = np.where([free for _, _, free in spreads], -np.inf, 0.0)
        if (slopes @ best < 1).any() or (best < least).any():
            start = np.zeros(len(best))
            start[0] = 1.0
            rows = np.vstack([slopes, np.eye(len(best))[np.isfinite(least)]])
            bounds = np.concatenate([np.ones(len(slopes)), least[np.isfinite(least)]])
            gram, right = matrix.T @ matrix / (target @ target), matrix.T @ target / (target @ target)
            best = minimize(
                lambda x: x @ gram @ x / 2 - right @ x, start, jac=lambda x: gram @ x - right, method="SLSQP",
                constraints=[LinearConstraint(rows, bounds, np.inf)], options={"maxiter": 300, "ftol": 1e-14},
            ).x  # fmt: skip
        if len(best) > 1 and np.abs(best[1:] * (invariant ** np.arange(1, len(best)))).max() < NOTHING:
            raise MaterialError(f"the tests do not determine {', '.join(self.constants[1:])}: it is neo-Hooke's law")
        return np.asarray(best * half)

    def _terms(self, stretch: Array, across: Array | None) -> Array:
        return np.column_stack(list(self.kind.uniaxial_terms(stretch, across).values()))

    def _slopes(self, reach: float) -> Array:
        """(m, k) slopes of the stress by the constants up to a stretch, over the least one that is allowed."""
        rows = []
        for state, across in STATES.items():
            s = stretches(reach**-2 if state == "uniaxial" else 1.0, reach)
            rows.append(np.diff(self._terms(s, across(s)), axis=0) / np.diff(s)[:, None])
        at_rest = 6.0  # of neo-Hooke's law with c10 = 1
        return np.vstack(rows) / (LEAST_SLOPE * at_rest)

    def solved(self, constants: Array, nu: float) -> Material:
        return self.kind.from_uniaxial(dict(zip(self.constants, constants.tolist(), strict=True)), nu)


@final
@dataclass(frozen=True)
class OgdenForm(Form):
    """Ogden's law with terms mu alpha > 0, which make it stable at every strain."""

    def fitted(self, points: Points, reach: float) -> Array:
        modulus, terms, weight = points.modulus, len(self.constants) // 2, points.weight
        s, third = (
            points.stretch[:, None],
            points.by_state(lambda s, other: s**-0.5 if other is None else 1 / (s * other))[:, None],
        )
        if modulus <= 0:
            raise MaterialError("Ogden: the stress falls")

        def residuals(x: Array) -> Array:  # shares of the modulus, and exponents
            share, alpha = x[:terms], x[terms:]
            stress = (s**alpha - third**alpha) / s @ (2 * modulus * share / alpha)
            return np.concatenate([weight * (stress - points.stress), (alpha - EXPONENT[0]) / EXPONENT[1]])

        starts = product(STARTS, *[SECOND] * (terms - 1))
        share, alpha = min(
            (
                least_squares(
                    residuals, [*np.full(terms, 1 / terms), *start], bounds=_bounds(np.array(start)), max_nfev=200
                )
                for start in starts
            ),
            key=lambda found: found.cost,
        ).x.reshape(2, terms)
        if share.min() < NOTHING:
            raise MaterialError(f"the tests do not determine {terms} terms")
        order = np.argsort(-share)
        return np.column_stack([2 * modulus * share / alpha, alpha])[order].ravel()

    def solved(self, constants: Array, nu: float) -> Material:
        mu, alpha = constants.reshape(-1, 2).T
        return Ogden.from_uniaxial({"mu": tuple(mu.tolist()), "alpha": tuple(alpha.tolist())}, nu)


def _bounds(exponents: Array) -> tuple[Array, Array]:
    """Least and largest shares and exponents (2 k,): an exponent keeps its sign."""
    low, high = np.where(exponents < 0, EXPONENTS[0], 0.1), np.where(exponents < 0, -0.1, EXPONENTS[1])
    return np.concatenate([np.zeros(len(low)), low]), np.concatenate([np.full(len(high), 10.0), high])


#: what is fitted to tensile tests, by name
FORMS: dict[str, Form] = {
    **{
        law: LinearForm(law, law, tuple(kind.uniaxial_terms(np.ones(1))), kind)
        for law, kind in LAWS.items()
        if issubclass(kind, LinearLaw)
    },
    "ogden 1": OgdenForm("ogden", "ogden 1", ("mu1", "alpha1")),
    "ogden 2": OgdenForm("ogden", "ogden 2", ("mu1", "alpha1", "mu2", "alpha2")),
}
