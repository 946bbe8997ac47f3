"""All pictures and fields of a run."""

from geometry import Body
from pipeline.pictures import Colour, draw_body, draw_deformed, write_fields, write_series
from pipeline.simulation.outcome import Outcomes
from pipeline.store.store import Store


def draw_all(body: Body, outcomes: Outcomes, store: Store) -> None:
    """The body, also cut open at z = 0; each state as a picture and as a file for ParaView, a series per experiment."""
    mesh = body.mesh
    write_fields(store.path("mesh.vtu"), mesh.points, mesh.tets)
    draw_body(store.path("pictures/body.png"), mesh.points, mesh.tets, mirrored=body.half)
    if body.half:
        draw_body(store.path("pictures/body_open.png"), mesh.points, mesh.tets, cut_open=True)
    stretches = [record.fields["stretch"].max() for record in outcomes.records]
    limits = (1.0, max(stretches, default=1.1))
    for outcome in outcomes:
        series = []
        for record in outcome.records:
            title = f"{outcome.name}_{record.pressure_kPa:g}kPa"
            colour = Colour(record.fields["stretch"], "largest principal stretch", limits)
            draw_deformed(
                store.path(f"pictures/{title}.png"),
                outcome.points,
                outcome.nodes,
                record.displacement,
                colour,
                mirrored=body.half,
            )
            fields = {"displacement": record.displacement, **record.fields}
            write_fields(store.path(f"fields/{title}.vtu"), outcome.points, outcome.nodes, fields)
            series.append((record.pressure_kPa, f"fields/{title}.vtu"))
        write_series(store.path(f"{outcome.name}.pvd"), series)
