"""The material of a configuration: its law and constants, and whether its stiffness fits the pressures."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any

import fem.materials
from fem.materials import LAWS, Constant
from pipeline.config.kinds import (
    Density,
    LossFactor,
    Number,
    PoissonRatio,
    PositiveNumber,
    PositiveStress,
    PositiveTime,
    Stress,
    Stretches,
    in_unit,
    list_of,
    number,
    one_or_more,
)
from pipeline.config.rubbers import BESIDE, INSTEAD, OF_MODULUS_AT_ONCE, RUBBERS, form_of, ogden_terms
from pipeline.config.section import (
    Error,
    Field,
    Kind,
    ReadContext,
    Section,
    chosen,
    conflict,
    raise_all,
    section,
    section_of,
    wrong,
)
from pipeline.config.units import FREQUENCY
from pipeline.values.json_values import Json, JsonObject
from pipeline.values.pressure import in_MPa

#: how the constants of a law are written
CONSTANTS: dict[Constant, Any] = {
    Constant.STRESS: Stress,
    Constant.POSITIVE_STRESS: PositiveStress,
    Constant.POSITIVE: PositiveNumber,
    Constant.POISSON_RATIO: PoissonRatio,
    Constant.STRESSES: Annotated[
        tuple[Stress, ...], one_or_more(list_of("a list, one for each term", "[0.4 MPa]", "MPa"))
    ],
    Constant.EXPONENTS: Annotated[
        tuple[Number, ...], one_or_more(list_of("a list, one for each term; not 0", "[2]", "1"))
    ],
}
#: the constant of a rubber law for which Poisson's ratio may be given
BULK = "kappa"
#: of a material where none is given: that of silicone rubbers is 0.05 to 0.2
LOSS_FACTOR = 0.1
#: Poisson's ratio of a rubber law for which neither it nor the bulk modulus is given, as of the paper's silicone
RUBBER_POISSON_RATIO = 0.495
#: the largest pressure over the initial Young's modulus with which a body is solved
LARGEST_PRESSURE = 3.0


_Frequency = Annotated[float, Kind("above 0", FREQUENCY.example, "Hz", in_unit(FREQUENCY), lambda hertz: hertz > 0.0)]


@section(frozen=True)
class Branch(Section):
    """A part of the stress that a held strain loses, exp(-t / tau) of it left after the time t."""

    g: PositiveNumber = Field(description="over the stress that stays")
    tau_s: PositiveTime = Field(description="time in which it falls to 37 %")


@section(frozen=True)
class LossBand(Section):
    """A loss factor that is the same at all frequencies from one to another."""

    value: LossFactor = Field(description="lost over stored energy, over a radian")
    from_Hz: _Frequency = Field(description="lowest frequency")
    to_Hz: _Frequency = Field(description="highest frequency")


@dataclass(frozen=True)
class Material:
    """The law of the solid and its constants."""

    law: str  #: as in the YAML: svk
    constants: Mapping[str, float | tuple[float, ...]]  #: stresses in MPa
    density_tonne_mm3: float | None  #: None where it is not given; only gravity and the mass of the arm need it
    holds_between: tuple[float, float] | None = None  #: stretches between which the law describes the solid, if known
    loss_factor: float = LOSS_FACTOR  #: lost over stored energy of a vibration, over a radian
    name: str = ""  #: of the rubber, where it was given instead of its constants
    loss_between_Hz: tuple[float, float] | None = None  #: frequencies of the loss factor, if they are given
    relaxation: tuple[Branch, ...] = ()  #: of the moduli over those at long times, which the constants give

    def built(self) -> fem.materials.Material:
        """The law with its constants. Raises `fem.materials.MaterialError` where it cannot have them together."""
        return LAWS[self.law](**self.constants)

    @property
    def told(self) -> str:
        """Its modulus at rest, and how much of its stress a held stretch keeps."""
        kept = 100 / (1 + sum(branch.g for branch in self.relaxation))
        keeps = f"; a held stretch keeps {kept:.3g} % of its stress" if self.relaxation else ""
        return f"Young's modulus {self.built().young_modulus:.3g} MPa at rest{keeps}"

    @property
    def kinds(self) -> Mapping[str, Constant]:
        """The kind of each constant."""
        return LAWS[self.law].constants()

    def record(self) -> JsonObject:
        """The law, its constants, the density and between which stretches it holds, ready for JSON."""
        constants = {name: list(v) if isinstance(v, tuple) else v for name, v in self.constants.items()}
        known: dict[str, Json] = {} if self.holds_between is None else {"holds_between": list(self.holds_between)}
        if self.loss_factor != LOSS_FACTOR:
            known["loss_factor"] = self.loss_factor
        if self.loss_between_Hz is not None:
            known |= {"loss_factor": self.loss_factor, "loss_between_Hz": list(self.loss_between_Hz)}
        if self.relaxation:
            known["relaxation_g"] = [branch.g for branch in self.relaxation]
            known["relaxation_tau_s"] = [branch.tau_s for branch in self.relaxation]
        if self.name:
            known["name"] = self.name
        return {"law": self.law, **constants, "density_tonne_mm3": self.density_tonne_mm3, **known}


@cache
def material_section(law: type[fem.materials.Material]) -> type[Section]:
    """The keys of a material that obeys a law; instead of its bulk modulus kappa nu may be given."""
    meanings = law.meanings()
    keys = {name: (CONSTANTS[kind], Field(description=meanings[name])) for name, kind in law.constants().items()}
    if BULK in keys:
        keys[BULK] = (PositiveStress | None, Field(default=None, examples=["20 MPa"], description=meanings[BULK]))
        ratio = f"Poisson's ratio, which can be given instead of `{BULK}`; {RUBBER_POISSON_RATIO:g} without both"
        keys["nu"] = (PoissonRatio | None, Field(default=None, description=ratio))
    keys["density"] = (Density | None, Field(default=None, description=_DENSITY))
    keys["holds_between"] = (Stretches | None, Field(default=None, description=_HOLDS))
    keys["loss_factor"] = (Annotated[float | LossBand, _LOSS_KIND], Field(default=LOSS_FACTOR, description=_LOSS))
    keys["relaxation"] = (Annotated[tuple[Branch, ...], _BRANCHES], Field(default=(), description=_RELAXATION))
    constants = {name: list(other.constants()) for name, other in LAWS.items()}
    hints = next((keys for name, keys in INSTEAD.items() if LAWS[name] is law), {})
    return section_of("Material", {"law": (str, Field()), **keys}, others=constants, hints=hints)


_DENSITY = "mass per volume; for gravity, the mass of the arm and M/(m g l), which are left out without it"
_HOLDS = (
    "smallest and largest stretch for which the law describes the solid, as `pneurod material` writes them; beyond "
    "them a run says so"
)

_LOSS = (
    "lost over stored energy of a vibrating solid, over a radian: the damping of [exported arms]"
    f"(how_to/robots.md#damping) and of [an arm in time](how_to/in_time.md); {LOSS_FACTOR:g} without it"
)
_RELAXATION = "what a held strain loses of its stress, over that which stays; for [an arm in time](how_to/in_time.md)"
_BRANCHES = one_or_more(list_of("branches `{g, tau}`", "[{g: 0.08, tau: 0.9 s}]"))


def _loss_factor(value: Any, beside: ReadContext) -> float | LossBand:
    """A number, or a section with the frequencies between which it holds."""
    if not isinstance(value, Mapping):
        return number(value)
    band = beside.read(LossBand, value)
    if not band.from_Hz < band.to_Hz:
        raise_all([wrong(f"is not above from, {band.from_Hz:g} Hz", ("to",))])
    return band


_LOSS_KIND = Kind(
    "above 0, at most 2, or `{value, from, to}`",
    "{value: 0.12, from: 1 Hz, to: 10 Hz}",
    "1",
    test=lambda loss: 0.0 < getattr(loss, "value", loss) <= 2.0,
    complete=_loss_factor,
)


def read_material(value: Any, beside: ReadContext) -> Material:
    """The material that a section describes, with all constants: kappa from nu where nu is given."""
    value, name = _by_name(value)
    law = chosen(value, "law", tuple(LAWS))
    form, value = form_of(value)
    keys = beside.read(material_section(LAWS[law]), ogden_terms(value, form) if law == "ogden" else value)
    constants = {name: getattr(keys, name) for name in LAWS[law].constants()}
    if BULK in constants:
        nu, kappa = keys.nu, constants.pop(BULK)  # type: ignore[attr-defined]
        if nu is not None and kappa is not None:
            raise_all([wrong("give nu or kappa, not both", ("nu",))])
        if kappa is None:
            kappa = LAWS[law].from_uniaxial(constants, RUBBER_POISSON_RATIO if nu is None else nu).kappa  # type: ignore[attr-defined]
        constants[BULK] = kappa
    loss, band = keys.loss_factor, None  # type: ignore[attr-defined]
    if isinstance(loss, LossBand):
        band, loss = (loss.from_Hz, loss.to_Hz), loss.value
    branches = _at_long_times(keys.relaxation) if form in OF_MODULUS_AT_ONCE else keys.relaxation  # type: ignore[attr-defined]
    given = keys.density, keys.holds_between, loss, name, band, branches  # type: ignore[attr-defined]
    material = Material(law, constants, *given)
    material.built()  # its error is a ValueError, for constants that do not go together
    return material


def _at_long_times(branches: tuple[Branch, ...]) -> tuple[Branch, ...]:
    """Branches that are parts of the modulus at once, as parts of that at long times."""
    stays = 1.0 - sum(branch.g for branch in branches)
    if stays <= 0.0:
        raise_all(
            [wrong(f"the parts g of the modulus at once add up to {1 - stays:.3g}; allowed: below 1", ("relaxation",))]
        )
    return tuple(Branch(g=branch.g / stays, tau_s=branch.tau_s) for branch in branches)


def _by_name(value: Any) -> tuple[Any, str]:
    """The section with the constants of the rubber that it names, and this name."""
    if not isinstance(value, Mapping) or "name" not in value:
        return value, ""
    name = chosen(value, "name", tuple(RUBBERS))
    beside = {key: entry for key, entry in value.items() if key != "name"}
    raise_all(
        wrong(f"the name gives the law and its constants; leave one of them out; allowed: {', '.join(BESIDE)}", (key,))
        for key in beside
        if key not in BESIDE
    )
    return RUBBERS[name] | beside, name


def stiffness_conflicts(material: Material, pressures_kPa: tuple[float, ...]) -> Iterator[Error]:
    """Refuses pressures that are too high for the material."""
    highest, modulus = pressures_kPa[-1], material.built().young_modulus
    ratio = in_MPa(highest) / modulus
    if ratio > LARGEST_PRESSURE:
        excess = f"{highest:g} kPa is {ratio:.3g} E, with Young's modulus E = {modulus:.4g} MPa at small strain"
        yield conflict(f"{excess}; allowed: at most {LARGEST_PRESSURE:g} E", ("pressures",), ("material",))
