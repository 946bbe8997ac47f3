"""The page of the material laws: each as the line of a configuration, with its constants."""

import inspect

from fem.materials import LAWS
from fem.materials.material import Material

HEADER = """# Material laws

Each law as it is written in a configuration, with constants fitted to the tensile tests of the example
(`configs/elastosil_m4601_yeoh.csv`) or, for svk, those of the paper, for ogden those of its author for Treloar's
vulcanised rubber. How a law is chosen, and up to which stretch each
may be used, is explained in [materials](../materials.md).
"""

#: the line of a configuration by law: constants of docs/materials.md, and those of the paper for svk
LINES = {
    "svk": "{law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}",
    "hencky": "{law: hencky, E: 0.77 MPa, nu: 0.495, density: 1130 kg/m^3}",
    "neo_hooke": "{law: neo_hooke, mu: 0.253 MPa, kappa: 25.2 MPa, density: 1130 kg/m^3}",
    "mooney_rivlin": "{law: mooney_rivlin, c10: 0.12 MPa, c01: 0.02 MPa, kappa: 27.9 MPa, density: 1130 kg/m^3}",
    "ogden": "{law: ogden, mu: [0.63 MPa, 0.0012 MPa, -0.01 MPa], alpha: [1.3, 5, -2], kappa: 42 MPa, "
    "density: 1130 kg/m^3}",
    "yeoh": "{law: yeoh, c10: 0.11 MPa, c20: 0.02 MPa, c30: 0 MPa, kappa: 21.9 MPa, density: 1130 kg/m^3}",
}


def laws_page() -> str:
    """The page as Markdown."""
    return "\n".join([HEADER, *(_section(name, law) for name, law in LAWS.items())])


def _section(name: str, law: type[Material]) -> str:
    return "\n".join(
        [f"## {name}", "", inspect.cleandoc(law.__doc__ or ""), "", "```yaml", f"material: {LINES[name]}", "```", ""]
    )
