"""All pictures and fields of a run."""

from collections.abc import Mapping

from geometry import Body
from pipeline.pictures import Colour, draw_body, draw_deformed, write_fields, write_series
from pipeline.simulation.simulate import Outcome
from pipeline.store.store import Store


def draw_all(body: Body, outcomes: Mapping[str, Outcome], store: Store) -> None:
    """The body whole and cut open, each state as a picture and as a file for ParaView, a series per experiment."""
    mesh = body.mesh
    write_fields(store.path("mesh.vtu"), mesh.points, mesh.tets)
    draw_body(store.path("pictures/body.png"), mesh.points, mesh.tets, whole=body.half)
    if body.half:
        draw_body(store.path("pictures/body_open.png"), mesh.points, mesh.tets, cut_open=True)
    stretches = [record.fields["stretch"].max() for outcome in outcomes.values() for record in outcome.records]
    limits = (1.0, max(stretches, default=1.1))
    for name, outcome in outcomes.items():
        series = []
        for record in outcome.records:
            title = f"{name}_{record.pressure_kPa:g}kPa"
            colour = Colour(record.fields["stretch"], "largest principal stretch", limits)
            draw_deformed(
                store.path(f"pictures/{title}.png"),
                outcome.points,
                outcome.nodes,
                record.displacement,
                colour,
                whole=body.half,
            )
            fields = {"displacement": record.displacement, **record.fields}
            write_fields(store.path(f"fields/{title}.vtu"), outcome.points, outcome.nodes, fields)
            series.append((record.pressure_kPa, f"fields/{title}.vtu"))
        write_series(store.path(f"{name}.pvd"), series)
