"""What the report says about the mesh: what was chosen and why, and how long its edges are."""

from pipeline.plausibility.body import VOLUME_DIFFERS as NAMED_IN_A_NOTE
from pipeline.report.formatting import number, percent
from pipeline.report.results import Results

#: volume of the mesh over that of the drawing, minus 1, from which the difference is told
VOLUME_DIFFERS = 1e-3
#: names of the choices in a sentence, with the unit of their values
_CHOICES = {"formulation": "elements", "grading": "grading", "size": "size", "averaging": "curvatures are means over"}


def mesh_sentences(results: Results) -> list[str]:
    """Elements, size and edges of the mesh, and the reasons for what the program chose; empty in older files."""
    mesh = results.run.get("mesh")
    if not mesh:
        return []
    of_program = f"{_graded(mesh['grading'])}; mesh.size is {number(mesh['size_mm'])} mm, the"
    sentences = [
        f"Mesh: {mesh['elements']} {mesh['formulation']} elements, "
        f"{'those of the file; the' if from_file(results) else of_program} edges are {mesh['mean_edge_mm']:.2g} mm "
        f"long on average and {mesh['longest_edge_mm']:.2g} mm at most."
    ]
    values = {"formulation": mesh["formulation"], "grading": mesh["grading"], "size": f"{number(mesh['size_mm'])} mm"}
    values["averaging"] = f"{number(mesh.get('averaging_mm', 0.0))} mm"  # older files do not have it
    sentences += [
        f"Chosen by the program: {name} {values[key]}, because {mesh['chosen'][key]}."
        for key, name in _CHOICES.items()
        if key in mesh["chosen"]
    ]
    differs = mesh["volume_over_drawing"] - 1.0
    if VOLUME_DIFFERS < abs(differs) < NAMED_IN_A_NOTE:
        sentences.append(f"The volume of the mesh differs from that of the drawing by {percent(differs)}.")
    return sentences


def from_file(results: Results) -> bool:
    """Whether the mesh was read from a file, so that it has no size that a configuration could change."""
    return bool((results.run.get("mesh") or {}).get("from_file"))


def _graded(grading: str) -> str:
    return "of one size" if grading == "off" else f"smaller at the {grading}"
