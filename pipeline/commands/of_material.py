"""The command that fits material laws to tensile tests: material."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.ending import errors_as_sentences, print_lines, print_sentences
from pipeline.errors import RunFailed


def material(
    tests: Annotated[list[Path], typer.Argument(metavar="TENSILE.csv...", help="Nominal stress over nominal strain.")],
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Result folder.")] = Path("results/material"),
    nu: Annotated[float, typer.Option(metavar="NU", help="Poisson ratio; it gives rubber its kappa.")] = 0.495,
    up_to: Annotated[str | None, typer.Option(metavar="STRAIN", help="Leave out larger strains: '50 %'.")] = None,
    within: Annotated[str, typer.Option(metavar="ERROR", help="Relative error within which a law holds.")] = "10 %",
    break_strain: Annotated[str, typer.Option("--break", metavar="STRAIN", help="E_L below, E_H above.")] = "150 %",
    density: Annotated[str | None, typer.Option(metavar="RHO", help="For the configuration: '1070 kg/m^3'.")] = None,
) -> None:
    """Tensile tests: constants of every law, the stretches it holds for, E_L and E_H."""
    with errors_as_sentences():
        from pipeline.material.fits import ALL, WIDEST, FitOptions
        from pipeline.material.sentences import caveats, configuration_line, moduli_sentences, none_usable
        from pipeline.material.study import fit_material
        from pipeline.terminal import law_table

        fits = fit_material(tests, FitOptions.read(nu, density, break_strain, up_to, within), out)
        print_sentences(*(f"Note: {note}" for note in fits.notes))
        print_lines(*moduli_sentences(fits))
        for name in (ALL, WIDEST):
            print_lines("", law_table(fits, name))
        if fits.usable:
            print_lines(f"\nfor a configuration, fitted to {WIDEST}:")
            print_lines(*(configuration_line(fit, density) for fit in fits.usable.values()))
        print_lines("", *caveats(fits))
        print_lines(f"written: {out / 'material.html'}, material.json, material_curves.csv")
        if not fits.usable:
            raise RunFailed(none_usable(fits))
