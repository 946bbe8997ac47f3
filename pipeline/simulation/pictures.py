"""All pictures and fields of a run."""

from typing import Any

import numpy as np

from geometry import Body, Mesh
from geometry.arrays import Array
from pipeline.drawing.pictures import (
    Colour,
    draw_body,
    draw_deformed,
    window_for_pictures,
    write_fields,
    write_series,
)
from pipeline.pressure import name_of_state
from pipeline.simulation.outcome import Outcomes
from pipeline.simulation.surfaces import at_nodes, save_surfaces
from pipeline.store.formats import SURFACES
from pipeline.store.state_key import PICTURE_SOURCES, result_key
from pipeline.store.store import Store

#: what the pictures were drawn with
_DRAWN = "pictures/drawn.json"


def draw_all(body: Body, outcomes: Outcomes, store: Store) -> None:
    """The body, also cut open at z = 0; each state as a picture and as a file for ParaView, a series per experiment.

    Nothing is drawn where the pictures of an earlier run show the same states, drawn by the same sources.
    """
    titles = [name_of_state(outcome.name, record.pressure_kPa) for outcome in outcomes for record in outcome.records]
    drawn = {"key": result_key(store.key, PICTURE_SOURCES), "states": titles}
    needed = ["mesh.vtu", "pictures/body.png", *(f"pictures/{title}.png" for title in titles)]
    needed += [*(f"fields/{title}.vtu" for title in titles), *([SURFACES] if titles else [])]
    if store.read_json(_DRAWN) == drawn and all((store.directory / name).is_file() for name in needed):
        return
    with window_for_pictures() as window:
        _draw(body, outcomes, store, window)
    save_surfaces(body, outcomes, store)
    store.save_json(_DRAWN, drawn)


def region_field(mesh: Mesh) -> dict[str, Array]:
    """The number of the region of each tetrahedron (m,), 0 where it has none; empty for a mesh without regions."""
    if not mesh.regions:
        return {}
    number = np.zeros(len(mesh.tets))
    for count, tets in enumerate(mesh.regions.values(), start=1):
        number[tets] = count
    return {"region": number}


def _draw(body: Body, outcomes: Outcomes, store: Store, window: Any) -> None:
    mesh, regions = body.mesh, region_field(body.mesh)
    write_fields(store.path("mesh.vtu"), mesh.points, mesh.tets, regions)
    colours = regions.get("region")
    at_rest = {"regions": colours, "window": window}
    draw_body(store.path("pictures/body.png"), mesh.points, mesh.tets, mirrored=body.half, **at_rest)
    if body.half:
        draw_body(store.path("pictures/body_open.png"), mesh.points, mesh.tets, cut_open=True, **at_rest)
    stretches = {
        outcome.name: at_nodes([record.fields["stretch"] for record in outcome.records], outcome.nodes)
        for outcome in outcomes
        if outcome.records
    }
    limits = (1.0, max((float(values.max()) for values in stretches.values()), default=1.1))
    for outcome in outcomes:
        series = []
        for number, record in enumerate(outcome.records):
            title = name_of_state(outcome.name, record.pressure_kPa)
            colour = Colour(stretches[outcome.name][number], "largest principal stretch", limits)
            draw_deformed(
                store.path(f"pictures/{title}.png"),
                outcome.points,
                outcome.nodes,
                record.displacement,
                colour,
                mirrored=body.half,
                window=window,
            )
            fields = {"displacement": record.displacement, **record.fields}
            write_fields(store.path(f"fields/{title}.vtu"), outcome.points, outcome.nodes, fields)
            series.append((record.pressure_kPa, f"fields/{title}.vtu"))
        write_series(store.path(f"{outcome.name}.pvd"), series)
