"""The sentence of every reason, by its code, as a clause: it begins small and has no full stop."""

from collections.abc import Iterable, Mapping
from typing import Any

from fem.reasons import sentence
from geometry.errors import Reason, position_text
from pipeline.values.record import Reported

#: {at} is the place of the reason; a list is written with commas between its entries
TEMPLATES: Mapping[str, str] = {
    # a configuration
    "unused_key": "{complaint}; left out, because `pneurod {command}` does not use it",
    "strong_pressure": "{pressure_kPa:g} kPa is {ratio:.2g} times what walls of {modulus_MPa:.3g} MPa usually bear; "
    "check the units, or stay below about {bearable_kPa:g} kPa",
    "weak_pressure": "{pressure_kPa:g} kPa hardly bends walls of {modulus_MPa:.3g} MPa; check the units (rubbers have "
    "0.05 to 10 MPa), or give higher pressures",
    "pressure_unused": "no cavity follows the pressure of the run, so its states are all the same; check "
    "effects.pressure",
    "density": "the value of {key}.density is {density_kg_m3:.4g} kg/m^3, and rubbers have about 1000; check its unit "
    "(kg/m^3, g/cm^3)",
    "named_rubber": "the constants of {names} are of one published test, and another batch may be half or twice as "
    "stiff; test yours with pneurod material",
    "turned_gravity": "gravity acts along the arm's own x, from clamp to tip, which is against the x of the file; "
    "check effects.gravity.acceleration",
    "short_edges": "{count} edges of the CAD file are shorter than {limit_mm:.2g} mm ({shortest_mm:.2g} mm near "
    "{near}); remove small features in the CAD program",
    "air_left_out": "the CAD file has solids that fill closed cavities, around {around}; they are taken as air, and "
    "geometry.parts makes them material",
    "one_material": "the file has the regions {names}, and all have one material; `materials` gives them others",
    "large_body": "the body is {length_mm:.4g} mm long, {times:.0f} times mesh.size; is it in another unit? give unit",
    "too_short": "five parameters need an arm of {needed_mm:.4g} mm, and this one has {length_mm:.4g} mm; give more "
    "chambers, a longer arm or a smaller geometry.cell",
    "unequal_cells": "chambers or gaps differ, so five parameters averaged over {averaging_mm:.3g} mm are a rough "
    "model; see their errors in the report",
    "long_cells": "cavities are {between_mm:.3g} mm apart but curvatures averaged over {averaging_mm:.3g} mm, so a "
    "single line is taken at {pressures_kPa:g} kPa; identification.d requests two",
    "few_pressures": "{count} pressures cannot show whether the parameters are linear in the pressure; give three or "
    "more",
    # a meshed body
    "flat_element": "the flattest element has a radius ratio of {radius_ratio:.2g} near {at} (a regular one has 1); "
    "mend the body there or change mesh.size",
    "straightened_edges": "{count} curved edges of the mesh file are taken as straight, as near {at}, where elements "
    "would fold; check their middle nodes",
    "nodes_too_far_apart": "five parameters need nodes at most {allowed_mm:.3g} mm apart along the curve, not "
    "{spacing_mm:.3g} mm; give a smaller mesh.size or a larger geometry.cell",
    "volume_differs": "the volume of the mesh is {percent:+.2g} % off that of the drawing, whose walls are round; give "
    "a mesh.size of about {size_mm:.2g} mm",
    "mirrored_cavity": "the cavity {cavities} does not touch z = 0, so its mirror image is added; set "
    "geometry.symmetric: false if the file is the whole arm",
    "partial_clamp": "the face clamp leaves {free_mm2:.3g} of {plane_mm2:.3g} mm2 in its plane free, near {at}; if "
    "the whole plane is held, add the rest to clamp",
    "part_has_walls": "the solid geometry.parts.{part} ({volume_mm3:.4g} mm3) has {percent:.0f} % of the cavity walls, "
    "`material` {percent_of_material:.0f} %; if that is wrong, choose a point in another solid",
    "not_along_x": "the body is {length_mm:.3g} mm along x and {longest_mm:.3g} mm along {axis}; if {axis} is its "
    "length, give geometry.axes: {axes}",
    # states
    "unstable_states": "the arm falls over {way}: its equilibrium at {pressure_kPa:g} kPa ({experiment}) is unstable "
    "in {directions} direction(s); hold the end, or make it shorter or stiffer",
    "beyond_law": "in {percent:.2g} % of the volume of {part} stretches leave the range of {law}, {holds_from:.2f} to "
    "{holds_to:.2f} (experiment {experiment}, {pressure_kPa:g} kPa); set material.law: {instead}",
    "out_of_plane": "the arm leaves its plane by {distance_mm:.3g} mm and moves by "
    "{deflection_mm:.3g} mm in it ({experiment}, {pressure_kPa:g} kPa); `pneurod cell` gives its law in space",
    "volume_lost": "{share:g} % of the material loses {percent:.0f} % of its volume or more, most at {at} "
    "({experiment}, {pressure_kPa:g} kPa); compare with a smaller mesh.size",
    "volume_lost_unevenly": "{share:g} % of the material loses {percent:.0f} % of its volume or more, most at {at} "
    "({experiment}, {pressure_kPa:g} kPa); compare with mesh.formulation: mixed",
    "hardly_bent": "at {pressure_kPa:g} kPa the arm bends by {bend_deg:.2g}° only; give "
    "higher pressures, thinner walls or another end.y",
    "few_reached": "{count} of {given} pressures have five parameters, too few to show how these change; give more "
    "and lower pressures",
    "rigidity_open": "the rigidity {rigidity} is between {low:.3g} and {high:.3g} N mm² at {pressure_kPa:g} kPa; "
    "higher pressures tell it better",
    "one_rigidity_poor": "R² is {r2:.2f} at {pressure_kPa:g} kPa: parts of this arm differ in rigidity, and α₂ is "
    "their mean",
    "one_line_or_two": "at {pressures_kPa:g} kPa one line (α₂ {single_N_mm2:.3g} N mm²) or two ({two_N_mm2:.3g}) are "
    "nearly as good; added pressures tell which",
    "approximate_contact": "sliding contact changes the end by about {end_mm:.2g} mm and {end_N:.2g} N "
    "({experiment}, {pressure_kPa:g} kPa); compare with a smaller mesh.size",
    "contact_not_compared": "sliding contact in {states} is approximate by an unknown amount; compare with a smaller "
    "mesh.size",
    "path_dependent_contact": "walls fold, and results ({experiment}, {pressure_kPa:g} kPa) change by {percent:.2g} % "
    "with the load steps; add pressures below it",
    "folded_contact_open": "walls fold, and the state found ({experiment}, {pressure_kPa:g} kPa) may depend on the "
    "load steps; add pressures below it",
    "solved_below_limit": "II and III reach no given pressure and were solved at {reached_kPa:g} kPa; give pressures "
    "below {limit_kPa:.3g} kPa",
    "law_beyond_end": "the arm's own law goes to {highest_kPa:.4g} kPa, but experiment {experiment} ends at "
    "{end_kPa:.4g} kPa; use the law below that pressure",
    # one state
    "contact_error": "sliding contact is approximate: exact distances move the end by {end_mm:.2g} mm and change the "
    "force on it by {end_N:.2g} N",
    "contact_error_unknown": "sliding contact is approximate by an unknown amount ({why})",
    "depends_on_load_steps": "walls fold, and the state found depends by {percent:.2g} % on the load steps",
    "may_depend_on_load_steps": "walls fold, and the state found may depend on the load steps",
    # how an experiment ended
    "ends_beyond": "no equilibrium found beyond {reached_kPa:.4g} kPa on the way to {target_kPa:.4g} kPa",
    "ends_with_part": "no equilibrium found beyond {reached_kPa:.4g} kPa with {percent:.3g} % of {on_end} at the end, "
    "on the way to {target_kPa:.4g} kPa with all of it",
    "has_limit": "the limit is at {limit_kPa:.4g} kPa",
    "not_tried": "it was not solved",
    "followed_to": "it was followed up to {reached_kPa:.4g} kPa only",
    "followed_with_part": "it was followed up to {reached_kPa:.4g} kPa and {percent:.3g} % of {on_end} at the end only",
    "end_of_II": "experiment II of the same arm has its {end} at {end_kPa:.4g} kPa",
    "followed_near_end_of_II": "it was followed up to {reached_kPa:.4g} kPa only, {percent:g} % of the {end} of "
    "experiment II of the same arm",
    "weight_not_held": "experiment I is not simulated, because nothing holds the weight of a free body",
    "opening_not_held": "experiment I is not simulated, because the clamp carries the pressure on the opening",
    # what a run did not reach
    "stopped": "experiment {experiment} stopped before {pressure_kPa:g} kPa: {why}",
    "load_stopped": "validation {load} stopped before {pressure_kPa:g} kPa: {why}",
    "load_left_out": "validation {load} at {pressures_kPa:g} kPa was not solved, because experiment II ended at "
    "{end_kPa:.4g} kPa; give lower pressures",
    "not_identified": "no five parameters at {pressure_kPa:g} kPa: {why}",
    "no_arm_law": "the arm's own law was not made: {why}; set law: five to take five parameters",
    "law_incomplete": "the arm's own law is incomplete: {why}",
    # the arm's own law
    "law_not_wanted": "switched off in the config",
    "law_not_possible": "{why}",
    "law_measured": "measured on one cell and both ends from {lowest_kPa:g} to {highest_kPa:g} kPa; nothing is fitted "
    "to the arm as a whole",
    "piece_fails": "{why}",
    "cell_swells": "the chambers of the cell swell",
    "form_not_measured": "the form after the snap was not measured: {why}",
    "cell_softens": "at {pressure_kPa:g} kPa the law of the cell ends at a curvature of {kappa_per_mm:.4g} 1/mm, "
    "where the cell has lost most of its rigidity",
    "unstable_sideways": "out of its plane the {piece} is unstable at {pressure_kPa:g} kPa and a curvature of "
    "{kappa_per_mm:.4g} 1/mm",
    "snaps": "at {limit} kPa its chambers swell at once: it bends from {from_deg:.0f}° to {to_deg:.0f}°, and back at "
    "{return_kPa:.3g} kPa; known to {highest_kPa:.3g} kPa",
    "no_form_beyond": "no form beyond {limit} kPa with this law: a law that stiffens (yeoh, ogden) may have "
    "one{stiffer}",
    "elements_limit": "with p2p0 elements the limit pressure is {soft}, with mixed ones {mixed}: take mixed ones",
    "steep": "from {low_kPa:.3g} to {high_kPa:.3g} kPa 1 kPa changes the angle by {deg_per_kPa:.2g}°: here modulus and "
    "pressure must be known to {percent:.1g} % for 5°",
    "no_law_in_space": "the body is not symmetric about z = 0, so the law has no rigidities out of the plane",
    "cell_falls": "at {pressure_kPa:g} kPa the law of the cell ends at a curvature of {kappa_per_mm:.4g} 1/mm, because "
    "its moment does not grow beyond",
    "law_up_to": "the law goes up to {pressure_kPa:g} kPa, because the whole arm was not solved at a higher pressure; "
    "`pneurod cell` measures it there",
    "law_between": "between two pressures the curvature is interpolated to {percent:.2g} % of the largest one; more "
    "than {added} added pressures are not tried",
    "between_unchecked": "the interpolation at {pressure_kPa:g} kPa could not be checked: {why}",
    "end_without_thread": "at {pressure_kPa:g} kPa the cells hold and an end fails: no thread runs across its plate; "
    "make the plate thicker, or lay effects.strain_limiting_layer on it",
    "ends_short": "the arm is too short to see how far its ends disturb the cells",
    "ends_unknown": "how far the ends of the arm disturb its cells is not known: {why}",
    "ends_differ": "end pieces of {half_cells} and {longer} half cells differ by {percent:.2g} % of the length; longer "
    "ones were not solved: {why}",
    "cell_accuracy": "the law is that of an infinitely fine mesh to {reached_percent:.2g} %, from meshes down to "
    "{size_mm:.3g} mm; {percent:g} % were requested",
    "cell_no_limit": "at {pressure_kPa:g} kPa the law may have no limit, because a mesh of {size_mm:.3g} mm does not "
    "bear it: {why}",
    "cell_accuracy_missed": "the requested accuracy is not reached: {why}",
    "law_interpolated": "end pieces of {half_cells} half cells; the curvature is interpolated to "
    "{along_percent:.2g} % of the largest one along curves and {between_percent:.2g} % between pressures",
    # the error of the mesh
    "coarser_not_meshed": "the mesh {factor:g} times as coarse cannot be made: {why}",
    "on_coarser_mesh": "on the mesh {factor:g} times as coarse: {why}",
    "not_compared_with_mixed": "p2p0 elements could not be compared with mixed ones: {why}",
    # the rods
    "no_rod_is_near": "do not use a rod of this run: {errors}; allowed are {most_shape_percent:g} and "
    "{most_force_percent:g} %",
    "no_rod_bends": "no rod of this run bears its loads: {why}",
    "loads_not_borne": "it does not bear {count} of {loads} loads, such as {load}",
    "weight_not_borne": "at {pressure_kPa:g} kPa it bears {percent:.2g} % of its own weight lying; `--set "
    "effects.gravity=on` measures it with its weight",
    "forces_uncertain": "forces are uncertain by up to {percent:.2g} % at {pressures_kPa:g} kPa because of the mesh; "
    "shapes hold",
    "tolerances": "at {pressure_kPa:g} kPa {process} tolerances move the tip by ±{percent:.2g} % of the length; "
    "measure {parameter} first: ±{tolerance} of it alone give {most_percent:.2g} %",
    "in_time": "it vibrates with {frequency_1_Hz:.2g} Hz at {pressure_kPa:g} kPa (damping ratio "
    "{damping_ratio_1:.2g}), settles in {settles_s:.2g} s and creeps by {creep_after_1_s_mm:.2g} mm after 1 s",
    "calibrated": "calibrated to {numbers} numbers: the tip is within {percent:.2g} % of the length in nine of ten "
    "cases; tolerances alone move it by {before:.2g} %",
    "calibrated_alone": "calibrated to {numbers} numbers: the tip is within {percent:.2g} % of the length in nine of "
    "ten cases",
    "not_calibrated": "do not use this rod: it misses {percent:.0f} % of the measured motion, most in line "
    "{line}: {quantity} is {measured:.4g}, the rod has {fitted:.4g}",
    "unsettled": "do not use this rod: the fit did not end, and {outside} of {numbers} numbers are outside, in line "
    "{line}: {quantity} is {measured:.4g}, fitted {fitted:.4g}",
    "draft": "this is a {draft}; the same command without --draft finds it",
    "mesh_error_unknown": "the error of the mesh is not known; repeat the run with --set mesh.coarser=1.5 to estimate "
    "it",
    "offsets_bend": "under small loads the rod with five parameters is off, because its offsets m₀₁ and m₀₂ bend it "
    "under any load",
}
#: why there are no five parameters
NO_PARAMETERS = ("too_short", "nodes_too_far_apart", "not_identified")


def render(reason: Reason) -> str:
    """The sentence of a reason, without a full stop."""
    if reason.code not in TEMPLATES:
        return sentence((reason,))  # the solver's own
    values = {name: _written(value) for name, value in reason.values.items()}
    place = {} if reason.where is None else {"at": position_text(reason.where)}
    return TEMPLATES[reason.code].format(**values, **place)


def _written(value: Any) -> Any:
    if not isinstance(value, list):
        return value
    return render_all(value) if any(isinstance(entry, Reason) for entry in value) else _Listed(value)


def render_all(reasons: Iterable[Reason]) -> str:
    """The sentences of several reasons in one line."""
    return "; ".join(map(render, reasons))


def report_reason(reason: Reason) -> Reported:
    """A reason with its sentence, as run.json has it."""
    text = render(reason)
    return Reported(reason.code, dict(reason.values), reason.where, f"{text[:1].upper()}{text[1:]}.")


class _Listed(list[Any]):
    """A list whose entries are formatted one by one."""

    def __format__(self, spec: str) -> str:
        return ", ".join(format(entry, spec) for entry in self)
