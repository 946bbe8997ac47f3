"""The mesh of a run as run.json has it: what was chosen and why, how long its edges are, and its volume."""

from pipeline.simulation.scene import Scene
from pipeline.store.json_values import JsonObject


def mesh_record(scene: Scene) -> JsonObject:
    """The key `mesh` of run.json."""
    mesh, settings, design = scene.body.mesh, scene.config.mesh, scene.config.design
    return {
        "size_mm": settings.element_size_mm,
        "from_file": not design.is_resizable,
        "formulation": settings.formulation,
        "grading": settings.grading,
        "averaging_mm": scene.body.pitch,
        "chosen": dict(settings.chosen) | ({"averaging": reason} if (reason := design.reason_for_pitch) else {}),
        "elements": len(mesh.tets),
        "mean_edge_mm": mesh.quality.mean_edge,
        "longest_edge_mm": mesh.quality.longest_edge,
        "smallest_radius_ratio": mesh.quality.minimum,
        "volume_over_drawing": scene.body.volume / design.solid_volume,
    }
