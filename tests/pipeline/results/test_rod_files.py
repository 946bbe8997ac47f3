"""The rod of a parameters.json or law.json from the command line: shapes, exports, files that were edited by hand."""

import json
import re
import runpy
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pipeline.results.files import read_run
from pipeline.results.laws import law_record
from pipeline.values.formats import FORMAT
from rod import FiveParameters, Rod
from tests.commands import done, refused
from tests.rod.arm_law.test_arm_law import law_of, straight_law

LENGTH = 112.0


#: what both files of parameters have
FIVE: dict[str, Any] = {
    "mass_g": 16.5,
    "solid_volume_mm3": 14600.0,
    "material": {"law": "svk", "E": 1.2, "nu": 0.495, "density_tonne_mm3": 1.13e-9},
    "pressures_kPa": [17.0, 37.0],
    "alpha1_N_mm2": [60.0, 55.0],
    "alpha2_N_mm2": [300.0, 440.0],
    "m01_N_mm": [0.1, 0.2],
    "m02_N_mm": [-0.2, -0.4],
    "d_mm": [10.0, 10.0],
}


@pytest.fixture
def results(tmp_path: Path) -> Path:
    return parameters_in(tmp_path)


def parameters_in(folder: Path) -> Path:
    """The folder, with parameters.json."""
    s = np.linspace(0.0, LENGTH, 57)
    curvatures = [np.full(57, -0.012).tolist(), np.full(57, -0.023).tolist()]
    rest = {"s_mm": s.tolist(), "theta0_rad": [0.0, 0.02], "kappa_0_per_mm": curvatures}
    content = {"format": FORMAT, "length_mm": LENGTH, **FIVE, "kappa_0": rest}
    (folder / "parameters.json").write_text(json.dumps(content))
    return folder


def test_rod_between_two_pressures_has_the_means_of_the_numbers_and_a_rest_curvature_through_zero(
    results: Path,
) -> None:
    rod = read_run(results / "parameters.json").parameters.rods().at(27.0)
    law = FiveParameters(alpha1=57.5, alpha2=370.0, m01=0.15, m02=-0.3, d=10.0)
    ours = rod.solve(force=(0.0, 0.05))
    kappa_0, theta0 = (np.polyval(np.polyfit([0, 17, 37], [0, *v], 2), 27) for v in ([-0.012, -0.023], [0.0, 0.02]))
    reference = Rod(LENGTH, float(kappa_0), law, theta0=float(theta0)).solve(force=(0.0, 0.05))
    assert ours.x[-1] == pytest.approx(reference.x[-1], abs=1e-5)  # mm, of the elements
    assert ours.y[-1] == pytest.approx(reference.y[-1], abs=1e-5)  # mm, of the elements


def test_pressures_written_with_six_digits_are_those_of_the_file(results: Path) -> None:
    file = results / "parameters.json"
    content = json.loads(file.read_text()) | {"pressures_kPa": [2.75790291727, 5.51580583453]}  # 0.4 and 0.8 psi
    names = ("alpha1_N_mm2", "alpha2_N_mm2", "m01_N_mm", "m02_N_mm", "d_mm")
    file.write_text(json.dumps(content | {f"{name}_std": [0.1, 0.2] for name in names}))
    law = results / "law" / "law.json"
    law.parent.mkdir()
    law.write_text(json.dumps(law_record(law_of(straight_law(0.0), straight_law(2.75790291727, -0.02)))))
    for path, printed, exact in ((file, "2.7579", 2.75790291727), (file, "5.51581", 5.51580583453), (law, "2.7579", 0)):
        out = done("rod", str(path), "--pressure", f"{printed} kPa")
        assert "polated" not in out
        assert (exact == 0) or done("rod", str(path), "--pressure", f"{exact} kPa") == out
    done("export", str(results), "--to", "json", "--pressure", "5.51581 kPa")
    table = json.loads((results / "rod_5.51581kPa.json").read_text())
    assert (table["pressures_kPa"], table["origin"], table["d_mm_std"]) == ([5.51580583453], "identified", [0.2])
    done("export", str(law.parent), "--to", "json", "--pressure", "2.7579 kPa")
    assert json.loads((law.parent / "law_2.7579kPa.json").read_text())["pressures_kPa"] == [2.75790291727]
    refused("rod", str(file), "--pressure", "5.5159 kPa")
    refused("rod", str(law), "--pressure", "2.75795 kPa")


def test_a_load_beyond_the_identified_moments_gets_a_warning(results: Path) -> None:
    file = results / "parameters.json"
    content = json.loads(file.read_text())
    file.write_text(json.dumps({**content, "moment_range_N_mm": [[0.2, 3.0], [0.4, 4.0]]}))
    at_low = ("rod", str(file), "--pressure", "17 kPa")
    out = done(*at_low, "--force", "[0 N, 0.1 N]")
    assert "The moment leaves the 0.2 to 3 N mm" in out
    tiny, none = done(*at_low, "--force", "[0 N, 0.001 mN]"), done(*at_low)
    ends = [np.array(re.findall(r"[xy] = (-?[\d.]+) mm", text), float) for text in (tiny, none)]
    jump = np.linalg.norm(ends[0] - ends[1])
    assert jump > 0.5
    stated = float(tiny.split("the tip jumps by ")[1].split(" mm")[0])
    assert stated == pytest.approx(jump, rel=0.03)
    assert "the law is extrapolated there" in out
    assert "The moment leaves" not in done("rod", str(file), "--pressure", "27 kPa")


def test_files_that_interpolate_over_the_pressure_follow_the_cubics_of_the_rod(results: Path) -> None:
    springs = {}
    for pressure in ("17 kPa", "24.5 kPa", "37 kPa", "17_to_37kPa"):
        options = ("--pressure", pressure) if " " in pressure else ()
        done("export", str(results), "--to", "pyelastica", *options)
        program = runpy.run_path(str(results / f"rod_pyelastica_{pressure.replace(' ', '')}.py"))
        now = program["at"](float(pressure.split()[0]) if " " in pressure else 24.5)
        springs[pressure] = now["angle_rad"][program["TABLE"]["kind"], 0]
    line = 0.625 * springs["17 kPa"] + 0.375 * springs["37 kPa"]  # 24.5 kPa lies between two pressures of the file
    off = [np.abs(neutral - springs["24.5 kPa"]).max() for neutral in (springs["17_to_37kPa"], line)]
    assert off[0] < 0.1 * off[1]


def test_an_arm_with_a_weight_does_not_become_straight_without_pressure(results: Path) -> None:
    file = results / "parameters.json"
    content = json.loads(file.read_text())
    content["kappa_0"]["kappa_0_per_mm"] = [np.full(57, -0.012).tolist()] * 2
    content["kappa_0"]["theta0_rad"] = [0.0, 0.0]
    file.write_text(json.dumps(content | {"straight_without_pressure": False}))
    ends = {re.findall(r"x = .* mm", done("rod", str(file), "--pressure", f"{p} kPa"))[0] for p in (17, 27, 37)}
    assert len(ends) == 1
    sentence = "do not apply that once more in the other program"
    assert f"{sentence}." in done("export", str(results), "--to", "json")
    assert f"{sentence}, nor a pressure below those of the file" in done("export", str(results), "--to", "mujoco")


def test_a_rod_carries_the_weight_of_its_arm(results: Path) -> None:
    """At rest it has the curvature that was measured under the weight; lifting it takes the weight off the clamp."""
    file = results / "parameters.json"
    command = ("rod", str(file), "--pressure", "37 kPa", "--force", "[0 N, 0.02 N]")
    light = done(*command)
    content = json.loads(file.read_text())
    file.write_text(json.dumps(content | {"weight_N_per_mm": [0.0, -0.001], "weight_height_mm": 5.0}))
    rods = read_run(file).parameters.rods()
    rod, length = rods.at(37.0), content["length_mm"]
    rest = np.array(content["kappa_0"]["kappa_0_per_mm"][content["pressures_kPa"].index(37.0)])
    alone = rod.solve()
    at_rest = np.interp(content["kappa_0"]["s_mm"], alone.s, alone.kappa)
    assert np.abs(at_rest - rest).max() < 0.02 * np.abs(rest).max()
    out = done(*command)
    assert f"[0, {-0.001 * length:.5g}] N, which the rod carries besides" in out
    assert "carries" not in light
    assert out.splitlines()[1] != light.splitlines()[1]  # the end
    csv = done("export", str(results), "--to", "csv")
    assert "The exported rod keeps the moments that its weight has without load" in csv


def test_numbers_that_were_not_identified_are_called_so(results: Path) -> None:
    file = str(results / "parameters.json")
    content = json.loads(Path(file).read_text())
    names = ("alpha1_N_mm2", "alpha2_N_mm2", "m01_N_mm", "m02_N_mm", "d_mm")
    Path(file).write_text(json.dumps(content | {f"{name}_std": [0.1, 0.2] for name in names}))
    between = "interpolated between those identified at 17 and 37 kPa"
    for options, origin in (
        (("--pressure", "17 kPa"), "identified"),
        (("--pressure", "27 kPa"), between),
    ):
        assert (origin in done("rod", file, *options)) == (origin != "identified")
        out = done("export", str(results), "--to", "json", *options)
        assert (f"are {origin}." in out) == (origin != "identified")
        table = json.loads((results / f"rod_{options[1].split()[0]}kPa.json").read_text())
        assert table["origin"] == origin
        assert ("alpha1_N_mm2_std" in table) == (origin == "identified")
        done("export", str(results), "--to", "mujoco", *options)
        assert f"five parameters, {origin}, at" in (results / f"rod_mujoco_{options[1].split()[0]}kPa.xml").read_text()


def test_an_end_beyond_the_reach_of_a_rod_that_stretches_is_named(tmp_path: Path) -> None:
    file = tmp_path / "law.json"
    file.write_text(json.dumps(law_record(law_of(straight_law(0.0), straight_law(20.0)))))
    error = refused("rod", str(file), "--pressure", "10 kPa", "--end-y", "300 mm")
    assert "--end-y: is 300 mm away from the clamped end, but the arm is 110 mm long" in error


def test_the_command_prints_the_end_and_writes_the_shape(results: Path) -> None:
    file = results / "shape.csv"
    loads = ("--pressure", "17 kPa", "--force", "[0 N, 0.02 N]", "--out", str(file))
    out = done("rod", str(results / "parameters.json"), *loads)
    table = np.loadtxt(file, delimiter=",", skiprows=1)
    assert f"x = {table[-1, 1]:.3f} mm, y = {table[-1, 2]:.3f} mm" in out
    assert table[0, 5] == pytest.approx(table[-1, 1] * 0.02, rel=1e-6)  # M(0) = x(l) F_y for F_x = 0


def test_other_files_are_rejected(tmp_path: Path) -> None:
    file = tmp_path / "parameters.json"
    for text, problem in (
        ("{}", "has no rod; give the folder of a run, its parameters.json or its law.json"),
        ("[{}]", "has no rod"),
        ("{", "line 1 is not JSON"),
        ('{"pressures_kPa": 3}', "must be a list"),
    ):
        file.write_text(text)
        sentence = refused("rod", str(file), "--pressure", "17 kPa")
        assert problem in sentence
        assert not any(word in sentence for word in ("list indices", "char"))


@pytest.mark.parametrize(
    ("run", "reason"),
    [
        (
            {"remarks": [{"code": "density", "text": "other"}, {"code": "too_short", "text": "4.4 pitches"}]},
            "4.4 pitches",
        ),
        ({"failures": [{"code": "not_identified", "text": "at 10 kPa: no moment"}]}, "at 10 kPa: no moment"),
        (None, "the identification needs II and III at the same pressure"),
    ],
)
def test_a_run_without_parameters_is_refused_with_its_reason(
    results: Path, run: dict[str, object] | None, reason: str
) -> None:
    file = results / "parameters.json"
    lists = {key: [] for key, value in json.loads(file.read_text()).items() if isinstance(value, list)}
    file.write_text(json.dumps({**json.loads(file.read_text()), **lists, "kappa_0": {}}))
    if run is not None:
        (results / "run.json").write_text(json.dumps(run))
    for command in (("rod", str(file), "--pressure", "10 kPa"), ("export", str(results), "--to", "csv")):
        assert refused(*command) == f"{results}: holds no parameters of a rod: {reason}"


@pytest.mark.parametrize("target", ["csv", "json", "pyelastica", "mujoco", "somo", "sorosim"])
def test_every_export_is_written_and_replaced_on_request_only(results: Path, tmp_path: Path, target: str) -> None:
    command = ("export", str(results), "--to", target, "--out", str(tmp_path / "files"))
    files = [Path(line[9:]) for line in done(*command).splitlines() if line.startswith("written: ")]
    assert files
    for file in files:
        assert file.parent == tmp_path / "files"
        assert "kPa" in file.name
        assert file.stat().st_size > 100
    assert "--force to replace it" in refused(*command)
    done(*command, "--force")


def test_without_a_mass_there_are_tables_and_no_dynamics(results: Path, tmp_path: Path) -> None:
    file = results / "parameters.json"
    content = json.loads(file.read_text())
    content["mass_g"] = content["material"]["density_tonne_mm3"] = None
    file.write_text(json.dumps(content))
    command = ("export", str(results), "--out", str(tmp_path), "--to")
    done(*command, "json")
    assert json.loads((tmp_path / "rod_17_to_37kPa.json").read_text())["mass_g"] is None
    for target in ("pyelastica", "mujoco", "somo", "sorosim"):
        assert "needs the mass of the arm" in refused(*command, target)
    done("rod", str(file), "--pressure", "17 kPa")


def test_a_folder_and_a_file_in_the_wrong_place_are_named(results: Path) -> None:
    at_low = ("--pressure", "17 kPa")
    assert done("rod", str(results), *at_low) == done("rod", str(results / "parameters.json"), *at_low)
    sentence = refused("rod", str(results), *at_low, "--rod", "law")
    assert "has no law.json, the arm's own law; take rod five" in sentence
    sentence = refused("export", str(results / "parameters.json"), "--to", "csv")
    assert f"is a file; give the folder of the run, {results}" in sentence


def test_options_of_the_five_parameters_and_missing_parts_are_named_for_a_law(results: Path) -> None:
    file = results / "law.json"
    file.write_text(json.dumps(law_record(law_of(straight_law(0.0), straight_law(20.0, -0.01)))))
    command = ("rod", str(file), "--pressure", "10 kPa")
    assert "arm_law: the arm's own law" in done(*command, "--moment", "1.5 Nmm")
    assert "holds no parameters of a rod" in refused(*command, "--rod", "five")
    record = json.loads(file.read_text())
    file.write_text(json.dumps({key: value for key, value in record.items() if key != "curves"}))
    assert "curves: is missing" in refused(*command)


SHORTER = 110.0
NAN = float("nan")


def parameters() -> dict[str, Any]:
    return {
        "format": 6,
        "length_mm": SHORTER,
        **deepcopy(FIVE),
        "alpha1_N_mm2_std": [2.0, None],
        "moment_range_N_mm": [[0.1, 3.0], [0.2, 4.0]],
        "kappa_0": {
            "s_mm": np.linspace(0.0, SHORTER, 12).tolist(),
            "theta0_rad": [0.0, 0.02],
            "cell_s_mm": [0.0, 40.0, 80.0, SHORTER],
            "cell_averaged_per_mm": [[-0.012] * 4, [-0.023] * 4],
            "kappa_0_per_mm": [[-0.012] * 12, [-0.023] * 12],
        },
    }


def law() -> dict[str, Any]:
    return json.loads(json.dumps(law_record(law_of(straight_law(0.0), straight_law(20.0, -0.01)))))


def edited(content: dict[str, Any], change: str) -> dict[str, Any]:
    """The content after a change such as `["length_mm"] = 0`."""
    exec(f"content{change}", {"NAN": float("nan")}, {"content": content})
    return content


def refusal(file: Path, content: dict[str, Any]) -> str:
    """What `pneurod rod` says on standard error about a file with the content."""
    file.write_text(json.dumps(content))
    sentence = refused("rod", str(file), "--pressure", "17 kPa")
    assert sentence.startswith(f"{file}: ")
    return sentence


def test_the_files_themselves_are_read(tmp_path: Path) -> None:
    for name, content in (("parameters.json", parameters()), ("law.json", law())):
        (tmp_path / name).write_text(json.dumps(content))
        done("rod", str(tmp_path / name), "--pressure", "17 kPa")


def test_a_law_may_soften_to_a_negative_rigidity_at_its_end(tmp_path: Path) -> None:
    """As measured ones do where a wall buckles."""
    file = tmp_path / "law.json"
    file.write_text(json.dumps(edited(law(), "['curves'][0]['rigidity_N_mm2'][8] = -20.0")))
    done("rod", str(file), "--pressure", "17 kPa")
