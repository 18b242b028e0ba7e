"""Models under loads, and replicates."""

from __future__ import annotations

import copy
import json
import pickle
import subprocess
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

import spineline as sl
from spineline import _native


def test_a_simulation_is_the_same_as_in_the_program(
    program: Path, analysis: sl.Analysis, tmp_path: Path
) -> None:
    model = analysis.model("inflection")
    path = model.save(tmp_path / "model.json")
    subprocess.run(
        [program, "simulate", path, "--push", "left", "--force", "20", "--level", "T9"]
        + ["--json", tmp_path / "out.json"],
        check=True,
        capture_output=True,
    )
    expected = json.loads((tmp_path / "out.json").read_text())
    found = model.simulate(sl.Force("T9", "left", 20.0))
    ours = json.loads(found.to_json())
    del expected["provenance"]
    assert ours == expected
    assert found.is_usable and found.status == expected["status"]
    # The file has ten significant digits.
    result = expected["equilibria"][0]
    assert found.cobb_deg == pytest.approx(result["cobb_deg"], rel=1e-9)
    assert found.ferguson_deg == pytest.approx(result["ferguson_deg"], rel=1e-9)
    assert found.lateral_tilt_deg == pytest.approx(result["lateral_tilt_right_deg"], rel=1e-9)
    shape = np.array([result["midpoints_mm"][level] for level in found.levels])
    np.testing.assert_allclose(found.midpoints_mm, shape, rtol=1e-9)
    assert [code for code, _ in found.warnings] == [w["code"] for w in expected["warnings"]]


def test_pads_push_by_force_or_by_spring(analysis: sl.Analysis) -> None:
    model = analysis.model()
    by_force = model.simulate(sl.Pad("T9", towards="left", force=10))
    assert by_force.cobb_deg == model.simulate(sl.Force("T9", "left", 10)).cobb_deg
    spring = model.simulate(sl.Pad("T9", towards="left", force_per_mm=1.0, advance_mm=5.0))
    assert spring.is_usable and "springs_stick" in dict(spring.warnings)
    moved = spring.midpoints_mm - model.midpoints_mm
    assert moved[model.levels.index("T9"), 1] > 0.0, "to the patient's left"
    with pytest.raises(sl.InputError, match="neither a force nor a spring"):
        model.simulate(sl.Pad("T9", towards="left"))
    with pytest.raises(sl.InputError, match=r"unknown direction `lef`\n.*one of left, right"):
        model.simulate(sl.Force("T9", "lef", 1.0))  # type: ignore[arg-type]
    assert model.simulate(sl.Rod("T12", "T6"), sl.Gravity(10.0)).is_usable


def test_an_amplitude_is_reached_on_its_side(analysis: sl.Analysis) -> None:
    found = analysis.model().simulate(
        sl.Force("T2", "left", 100.0), amplitude_deg=10.0, towards="left"
    )
    assert found.lateral_tilt_deg == pytest.approx(-10.0, abs=1e-6)
    with pytest.raises(sl.InputError, match="belong together"):
        analysis.model().simulate(sl.Force("T2", "left", 1.0), amplitude_deg=10.0)


def test_an_unknown_side_or_an_impossible_amplitude_is_refused(analysis: sl.Analysis) -> None:
    model, force = analysis.model(), sl.Force("T2", "left", 100.0)
    for side in ("Left", "up", "", 1):
        with pytest.raises(sl.InputError, match=f"`towards` is {side!r}") as caught:
            model.simulate(force, amplitude_deg=10.0, towards=side)  # type: ignore[arg-type]
        assert "left" in caught.value.help and "right" in caught.value.help
    for amplitude, limit in ((-5.0, 0.0), (90.5, 90.0)):
        with pytest.raises(sl.InputError, match="from 0 to 90") as caught:
            model.simulate(force, amplitude_deg=amplitude, towards="left")
        assert (caught.value.value, caught.value.limit) == (amplitude, limit)
    for wrong in (float("nan"), float("inf"), "10"):
        with pytest.raises(sl.InputError, match="`amplitude_deg` is .*\n.*finite number"):
            model.simulate(force, amplitude_deg=wrong, towards="left")  # type: ignore[arg-type]


def test_the_shape_of_a_search_without_a_result_raises(analysis: sl.Analysis) -> None:
    model, huge = analysis.model(), sl.Force("T2", "caudal", 1e6)
    found = model.simulate(huge)
    assert not found.is_usable
    for read in ("cobb_deg", "ferguson_deg", "midpoints_mm", "lateral_tilt_deg"):
        with pytest.raises(sl.NotAResultError, match="allow_unusable") as caught:
            getattr(found, read)
        assert caught.value.status == found.status
    allowed = model.simulate(huge, allow_unusable=True)
    assert allowed.midpoints_mm.shape == (len(model.levels), 3) and allowed.cobb_deg


def test_copies_and_pickles_of_simulations_are_equal(analysis: sl.Analysis) -> None:
    model, pad = analysis.model(), sl.Pad("T9", towards="left", force=10)
    found = model.simulate(pad)
    for again in (copy.copy(found), copy.deepcopy(found), pickle.loads(pickle.dumps(found))):
        assert again == found and again.cobb_deg == found.cobb_deg and again.levels == found.levels
    with pytest.raises(TypeError, match="unhashable"):
        hash(found)
    others = (
        model.simulate(sl.Pad("T9", towards="left", force=11)),
        model.simulate(pad, support="free"),
        model.simulate(pad, amplitude_deg=5.0, towards="left"),
        analysis.model("iliac").simulate(pad),
    )
    assert found == model.simulate(pad) and all(other != found for other in others)
    assert pickle.loads(pickle.dumps(others[2])) == others[2]
    huge = model.simulate(sl.Force("T2", "caudal", 1e6), allow_unusable=True)
    assert pickle.loads(pickle.dumps(huge)).cobb_deg == huge.cobb_deg


def test_a_pickled_simulation_of_another_version_is_refused(analysis: sl.Analysis) -> None:
    found = analysis.model().simulate(sl.Pad("T9", towards="left", force=10))
    repeat, (model, asked, allow_unusable, text) = found.__reduce__()
    data = json.loads(text)
    assert repeat(model, asked, allow_unusable, json.dumps(data | {"generator": "spineline 9"})) == found
    with pytest.raises(sl.InputError, match="another result"):
        repeat(model, asked, allow_unusable, json.dumps(data | {"status": "odd"}))


def test_exports_are_read_by_parsers(analysis: sl.Analysis, tmp_path: Path) -> None:
    model = analysis.model()
    for write, root in (
        (model.to_mujoco, "mujoco"),
        (model.to_opensim, "OpenSimDocument"),
        (model.to_urdf, "robot"),
    ):
        assert ET.parse(write(tmp_path / f"{root}.xml")).getroot().tag == root
    films = model.to_opensim_films(tmp_path / "films.sto").read_text()
    assert "left_bending" in films.partition("endheader")[0]
    loads = ET.parse(model.to_opensim_loads(tmp_path / "films.loads.xml"))
    assert [element.text for element in loads.iter("datafile")] == ["films.sto"]


def test_replicates_are_the_same_as_in_the_program(
    program: Path, case: sl.Case, analysis: sl.Analysis, tmp_path: Path
) -> None:
    path = case.save(tmp_path / "case.json")
    subprocess.run(
        [program, "analyze", path, "--replicates", "60", "--seed", "3"]
        + ["--json", tmp_path / "program.json"],
        check=True,
        capture_output=True,
    )
    expected = json.loads((tmp_path / "program.json").read_text())
    mc = sl.replicates(analysis, n=60, noise="measured", seed=3)
    assert json.loads(mc.to_json())["uncertainty"] == expected["uncertainty"]
    assert mc == sl.replicates(analysis, n=60, seed=3, threads=1)
    assert mc != sl.replicates(analysis, n=60, seed=4)
    low, high = mc.interval("multiplier.main_thoracic")
    assert low < high
    log_low, log_high = mc.interval("log_multiplier.main_thoracic")
    assert np.allclose(np.log([low, high]), [log_low, log_high])
    value = mc["multiplier.main_thoracic"].value
    model = analysis.data["models"]["inflection_line"]
    assert value == pytest.approx(model["multipliers"]["main_thoracic"])
    assert len(set(mc)) == len(mc) and len(mc.table) > 100
    again = pickle.loads(pickle.dumps(mc))
    assert again == mc and again.interval("multiplier.main_thoracic") == (low, high)
    with pytest.raises(sl.InputError, match="did you mean `multiplier.main_thoracic`"):
        mc.interval("multiplier.main_thoracc")
    # Any noise makes an absolute error larger: it has a mean, but no interval.
    errors = [name for name in mc if name.startswith("mean_location_error")]
    assert errors and all(mc[name].quantiles is None for name in errors)
    with pytest.raises(sl.InputError, match="any noise makes this number larger"):
        mc.interval(max(errors, key=lambda name: mc[name].count))


def test_a_copy_of_replicates_keeps_its_table(analysis: sl.Analysis) -> None:
    mc = sl.replicates(analysis, n=2)
    for again in (copy.copy(mc), copy.deepcopy(mc)):
        assert again is mc and len(again.table) > 100


def test_few_replicates_have_no_interval(analysis: sl.Analysis) -> None:
    fewest, name = _native.MIN_REPLICATES, "cobb.erect.main_thoracic"
    few = sl.replicates(analysis, n=fewest - 1)
    assert few[name].quantiles is None and few[name].sd is not None
    with pytest.raises(sl.InputError, match=f"{fewest - 1} replicates have it, and an interval needs {fewest}") as caught:
        few.interval(name)
    assert caught.value.help == "give n=1000"
    with pytest.raises(sl.InputError, match="any noise"):
        few.interval(next(name for name in few if name.startswith("mean_location_error")))
    low, high = sl.replicates(analysis, n=fewest).interval(name)
    assert low < high


def test_simulations_and_replicates_show_their_case_as_synthetic(analysis: sl.Analysis) -> None:
    loaded = analysis.model().simulate(sl.Pad("T9", towards="left", force=10))
    mc = sl.replicates(analysis, n=2)
    for one in (loaded, mc):
        assert f"{analysis.id}, SYNTHETIC" in repr(one) and f"{analysis.id} · SYNTHETIC" in one._repr_html_()
    assert repr(pickle.loads(pickle.dumps(mc))) == repr(mc) and mc.table.synthetic


def test_loads_take_numbers_of_numpy(analysis: sl.Analysis) -> None:
    model = analysis.model()
    ours = [sl.Gravity(10.0), sl.Rod("L1", "T5", shift_mm=(0.0, 1.0, 0.0)), sl.Pad("T9", "left", force_per_mm=1.0, advance_mm=5.0)]
    theirs = [
        sl.Gravity(np.float32(10)),  # type: ignore[arg-type]
        sl.Rod("L1", "T5", shift_mm=np.array([0.0, 1.0, 0.0])),  # type: ignore[arg-type]
        sl.Pad("T9", "left", force_per_mm=np.int64(1), advance_mm=np.float32(5)),  # type: ignore[arg-type]
    ]
    for own, other in zip(ours, theirs, strict=True):
        assert model.simulate(own) == model.simulate(other)
        arrays = {name: np.array(value) if name == "shift_mm" else value for name, value in own.as_load().items()}
        assert model.simulate(arrays) == model.simulate(own)
    for wrong, word in (
        (sl.Gravity(float("nan")), "`body_weight` is nan"),
        (sl.Force("T9", "left", "x"), "`force` is 'x'"),  # type: ignore[arg-type]
        (sl.Rod("L1", "T5", turn_deg=(1.0, 2.0)), "`turn_deg` is"),  # type: ignore[arg-type]
        ({"kind": "gravity", "body_weight": float("inf")}, "a load cannot be written"),
        ({"kind": object()}, "a value of the type object"),
    ):
        with pytest.raises(sl.InputError, match=word) as caught:
            model.simulate(wrong)
        assert caught.value.help
    with pytest.raises(TypeError, match="not str"):
        model.simulate("T9")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("given", "limit"),
    [({"seed": -1}, 0.0), ({"seed": 2**64}, 2.0**64), ({"n": -1}, 2.0), ({"n": 2.5}, None), ({"threads": -1}, 0.0)],
)
def test_a_number_of_replicates_out_of_range_is_refused(
    analysis: sl.Analysis, given: dict[str, float], limit: float | None
) -> None:
    [(name, value)] = given.items()
    with pytest.raises(sl.InputError, match=f"`{name}` is {value}") as caught:
        sl.replicates(analysis, **{"n": 2, **given})  # type: ignore[arg-type]
    assert (caught.value.value, caught.value.limit) == (value, limit) and "whole number from" in caught.value.help
    assert sl.replicates(analysis, n=np.int64(2)).n == 2  # type: ignore[arg-type]


def test_unknown_noise_is_refused(analysis: sl.Analysis) -> None:
    for wrong in ({"noise": "loud"}, {"noise": -1.0}, {"n": 1}):
        with pytest.raises(sl.InputError):
            sl.replicates(analysis, **wrong)  # type: ignore[arg-type]
