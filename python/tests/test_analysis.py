"""Analyses: the same numbers and bytes as the program gives, safe arrays, copies, errors."""

from __future__ import annotations

import copy
import json
import pickle
import re
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import spineline as sl
from spineline import _native


def without_run(text: str) -> str:
    """The file of an analysis without command, time and hash, which differ between runs."""
    data = json.loads(text)
    for key in ("command", "date_utc", "content_sha256"):
        del data["provenance"][key]
    return json.dumps(data, ensure_ascii=False, indent=2)


def scenarios() -> list[str]:
    """Every loading scenario of phantoms, from the error for an unknown one."""
    with pytest.raises(sl.InputError) as caught:
        sl.phantom("none")
    return caught.value.help.removeprefix("give one of ").split(", ")


@pytest.mark.parametrize(
    ("scenario", "subject"),
    [(scenario, 1) for scenario in scenarios()]
    + [(scenario, subject) for scenario in ("rod", "bend", "pull") for subject in (4, 10, 18)],
)
def test_files_and_tables_have_the_bytes_of_the_program(
    program: Path, tmp_path: Path, scenario: str, subject: int
) -> None:
    def run(*words: object) -> int:
        command = [str(word) for word in (program, *words)]
        return subprocess.run(command, capture_output=True).returncode

    assert run("phantom", "--scenario", scenario, "--subject", subject, "--out", tmp_path) == 0
    case_file = tmp_path / f"phantom-{scenario}-{subject:02}.json"
    written, tables = tmp_path / "program.json", tmp_path / "tables"
    ending = run("analyze", case_file, "--json", written, "--tables", tables)
    case = sl.read_case(case_file)
    assert case == sl.phantom(scenario, subject=subject)
    assert case.to_json() == case_file.read_text()
    found = sl.analyze(case)
    assert ending == (0 if found.is_usable else 4)
    ours, theirs = found.save(tmp_path / "python.json").read_text(), written.read_text()
    line = re.compile(r'^    "(command|date_utc|content_sha256)": (\[[^\]]*\]|"[^"]*"),?\n', re.MULTILINE)
    assert line.sub("", ours) == line.sub("", theirs)
    assert without_run(ours) == without_run(theirs)
    assert set(found.tables) == {path.stem for path in tables.glob("*.csv")} - {"dictionary"}
    for name, table in found.tables.items():
        assert table.to_csv() == (tables / f"{name}.csv").read_text(), name


def test_errors_of_the_program_have_the_same_text_in_the_package(
    program: Path, tmp_path: Path
) -> None:
    # Each bend under the name of the other one.
    told = json.loads(sl.phantom("pull", subject=2).to_json())
    other = {"left_bending": "right_bending", "right_bending": "left_bending"}
    for film in told["films"]:
        film["posture"] = other.get(film["posture"], film["posture"])
    case = sl.Case.from_json(json.dumps(told))
    file = case.save(tmp_path / "case.json")
    ending = subprocess.run([program, "analyze", file], capture_output=True, text=True)
    with pytest.raises(sl.InputError) as caught:
        sl.analyze(case)
    assert ending.returncode == 3
    assert str(caught.value).split() == ending.stderr.removeprefix(f"error: {file}: ").split()


def test_the_path_of_a_case_is_enough(case: sl.Case, analysis: sl.Analysis, tmp_path: Path) -> None:
    path = case.save(tmp_path / "c.json")
    assert sl.analyze(path).tables["clinical"].to_csv() == analysis.tables["clinical"].to_csv()
    with pytest.raises(sl.InputError, match=r"d\.json"):
        sl.analyze(str(tmp_path / "d.json"))


def test_held_out_films_are_apart_from_fitted_ones(analysis: sl.Analysis) -> None:
    fitted, held_out = analysis.fitted, analysis.held_out
    assert set(fitted.films) == {"left_bending", "right_bending"}
    assert not set(fitted.films) & set(held_out.films)
    model = analysis.data["models"]["inflection_line"]["postures"]
    for errors in (fitted, held_out):
        for film in dict.fromkeys(errors.films):
            own = [film == other for other in errors.films]
            expected = model[film]["location_error_mm"]
            assert errors.location_error_mm[own].mean() == pytest.approx(expected["mean"])
            assert model[film]["fitted"] is errors.is_fitted
    assert len(held_out.of("iliac")) and held_out.of("iliac").line == "iliac_line"


def test_the_curve_is_a_read_only_array(analysis: sl.Analysis) -> None:
    points = analysis.curve("erect").points_mm
    assert points.dtype == np.float64 and points.ndim == 2 and points.shape[1] == 2
    assert points[0] == pytest.approx([0.0, 0.0], abs=5.0)
    for array in (points, analysis.held_out.location_error_mm, analysis.model().midpoints_mm):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
    for array in (points, analysis.model().midpoints_mm):
        with pytest.raises(ValueError, match="WRITEABLE"):
            array.flags.writeable = True
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert steps.std() < 1e-6 * steps.mean()


def test_the_options_have_types_in_their_order() -> None:
    assert list(sl.MethodOptions.__annotations__) == _native.option_names()


def test_the_papers_method_is_an_option_that_others_replace(case: sl.Case) -> None:
    paper = sl.analyze(case, method="paper")
    assert paper.data["provenance"]["options"]["fit"] == "ferguson"
    assert sl.analyze(case, support="free", method="paper") == paper
    frontal = sl.analyze(case, support="frontal", method="paper")
    options = paper.data["provenance"]["options"] | {"support": "frontal"}
    assert frontal.data["provenance"]["options"] == options


def test_copies_and_pickles_are_equal(case: sl.Case, analysis: sl.Analysis) -> None:
    for one in (case, analysis, analysis.model()):
        for again in (copy.copy(one), copy.deepcopy(one), pickle.loads(pickle.dumps(one))):
            assert again == one
        with pytest.raises(TypeError, match="unhashable"):
            hash(one)
    other = sl.analyze(case, order_rule="paper")
    assert other != analysis and pickle.loads(pickle.dumps(other)) == other
    assert sl.phantom("rod", subject=2) != case


def test_an_analysis_of_another_version_is_refused(analysis: sl.Analysis) -> None:
    data = json.loads(analysis.to_json())
    data["chain"]["segments"] += 1
    text = json.dumps(data, ensure_ascii=False, indent=2) + "\n"
    with pytest.raises(sl.InputError, match="finds other results"):
        sl.Analysis.from_json(text)


def test_the_programs_own_analysis_is_read(
    program: Path, analysis: sl.Analysis, tmp_path: Path
) -> None:
    path = analysis.case.save(tmp_path / "case.json")
    out = tmp_path / "out.json"
    subprocess.run(
        [program, "analyze", path, "--json", out, "--replicates", "3", "--identifiability"],
        check=True,
        capture_output=True,
    )
    data = json.loads(out.read_text())
    code = "identifier_repeated"
    warning = {"code": code, "step": "measure", "posture": None, "level": None, "message": "odd"}
    data["warnings"].append(warning)
    # Replicates are not repeated, so their warning goes with them.
    interrupted = {**warning, "code": "replicates_interrupted", "step": "evaluate"}
    written = {**data, "warnings": [*data["warnings"], interrupted]}
    text = json.dumps(written, ensure_ascii=False, indent=2) + "\n"
    found = sl.Analysis.from_json(text)
    assert found.warnings[-1].code == code and found.data["warnings"] == data["warnings"]
    del data["uncertainty"]
    assert {**found.data, "provenance": None} == {**data, "provenance": None}


def test_an_unknown_option_gets_the_nearest_and_a_value_all_valid_ones(case: sl.Case) -> None:
    with pytest.raises(sl.InputError, match="did you mean `support`"):
        sl.analyze(case, suport="frontal")  # type: ignore[call-arg]
    with pytest.raises(sl.InputError, match="expected one of"):
        sl.analyze(case, support="frontl")  # type: ignore[typeddict-item]
    assert isinstance(sl.InputError("x"), ValueError)


def test_a_known_force_of_a_missing_film_is_refused(case: sl.Case) -> None:
    data = json.loads(case.to_json())
    data["films"] = [film for film in data["films"] if film["posture"] != "traction"]
    without = sl.Case.from_json(json.dumps(data))
    with pytest.raises(sl.InputError, match="which this case does not have"):
        sl.analyze(without, gauge="known-force:traction=120")
    assert sl.analyze(case, gauge="known-force:traction=120").model().absolute


def test_options_take_the_values_of_python(case: sl.Case) -> None:
    a = sl.analyze(
        case,
        order_rule=7,
        min_curve=6.5,
        inflections=("L1/T12", "T6"),
        given_line={"left_bending": (20.0, 150.0, -5.0)},
    )
    options = a.data["provenance"]["options"]
    assert "given_line" in a.lines and "7" in json.dumps(options)


def test_unknown_names_are_errors(analysis: sl.Analysis) -> None:
    with pytest.raises(sl.InputError, match="the analysis has no `errect` film"):
        analysis.curve("errect")
    with pytest.raises(sl.InputError, match="did you mean `vertebrae`"):
        analysis.tables["vertebra"]
    with pytest.raises(sl.InputError, match="given_line"):
        analysis.model("given")
    assert "vertebra" not in analysis.tables


def test_the_model_has_the_line_that_predicts_best(case: sl.Case) -> None:
    analysis = sl.analyze(case)
    predicted = analysis.data["comparison"]["lines"]
    errors = {line: of["errors"]["left_out_bend"]["location_mm"] for line, of in predicted.items()}
    assert errors[analysis.model().line] == min(
        errors[line] for line in ("inflection_line", "iliac_line")
    )
    # All curves are below the minimum: without inflections, another line is taken.
    without = sl.analyze(case, min_curve=80.0)
    assert "inflection_line" not in without.lines
    assert without.model().line in without.lines
    with pytest.raises(sl.InputError, match="inflection_line"):
        without.model("inflection")


def test_a_notebook_shows_banner_verdict_and_figure(analysis: sl.Analysis) -> None:
    html = analysis._repr_html_()
    assert "Synthetic data" in html and "<svg" in html and analysis.verdict[0][:20] in html
    assert "<script" not in html and "http-equiv" not in html
    assert "SYNTHETIC" in repr(analysis)
    assert analysis.summary().startswith("Patient: phantom-rod-01 · SYNTHETIC")


def test_reports_and_figures_are_written(analysis: sl.Analysis, tmp_path: Path) -> None:
    page = analysis.report(tmp_path / "p.html").read_text()
    assert page.startswith("<!DOCTYPE html>") and "phantom-rod-01" in page
    for name in ("overview", "rotations", "left_bending"):
        assert analysis.figure(name).startswith("<svg") or "<svg" in analysis.figure(name)
    with pytest.raises(FileNotFoundError):
        analysis.save(tmp_path / "missing" / "a.json")
    assert [path.name for path in tmp_path.iterdir()] == ["p.html"]


def test_a_file_is_replaced_only_with_overwrite(analysis: sl.Analysis, tmp_path: Path) -> None:
    model, path = analysis.model(), tmp_path / "kept"
    path.write_text("mine")
    for write in (analysis.case.save, analysis.save, analysis.report, model.save, model.to_mujoco):
        with pytest.raises(FileExistsError, match="overwrite=True"):
            write(path)
        assert path.read_text() == "mine"
        assert write(path, overwrite=True).read_text() != "mine"
        path.write_text("mine")
    assert list(tmp_path.iterdir()) == [path]


def test_every_rule_for_the_order_is_named_and_taken(case: sl.Case) -> None:
    for rule in ("leave-one-out", "two-inflections", "paper", 6):
        assert sl.analyze(case, order_rule=rule).data["provenance"]["options"]["order_rule"] == str(rule)


def test_an_analysis_is_usable_where_a_model_was_fitted(case: sl.Case, analysis: sl.Analysis) -> None:
    alone = sl.analyze(sl.Case.from_films([case.film("erect")]))
    assert alone.lines == [] and not alone.is_usable and len(alone.curve("erect").points_mm) > 0
    assert analysis.lines and analysis.is_usable


def test_an_input_is_never_replaced(tmp_path: Path) -> None:
    path = sl.phantom("rod", subject=1).save(tmp_path / "case.json")
    before = path.read_bytes()
    found = sl.analyze(path)
    model = found.model()
    loaded = model.simulate(sl.Pad("T9", towards="left", force=10))
    writers = [found.save, found.report, found.case.save, model.save, model.to_mujoco, loaded.save]
    for write in (*writers, sl.replicates(found, n=2).save):
        with pytest.raises(sl.InputError, match="is an input of this result, which would be destroyed") as caught:
            write(path, overwrite=True)
        assert caught.value.file == str(path) and path.read_bytes() == before
    with pytest.raises(sl.InputError, match="would be destroyed"):
        sl.Case.from_films([found.case.film("erect")]).save(path, overwrite=True)


def test_the_case_of_an_analysis_does_not_have_the_file_of_an_option_as_its_own(
    case: sl.Case, analysis: sl.Analysis, tmp_path: Path
) -> None:
    table = tmp_path / "own.json"
    table.write_text(json.dumps(analysis.data["provenance"]["options"]["stiffness"]))
    path = case.save(tmp_path / "case.json")
    for given, own in ((case, []), (path, ["case.json"])):
        found = sl.analyze(given, stiffness=table)
        assert [one["name"] for one in found.data["provenance"]["inputs"]] == [*own, "own.json"]
        for one in (found.case, pickle.loads(pickle.dumps(found.case)), pickle.loads(pickle.dumps(found)).case):
            assert [file["name"] for file in sl.analyze(one).data["provenance"]["inputs"]] == own
        parsed = sl.Analysis.from_json(found.to_json()).case
        assert sl.analyze(parsed).data["provenance"]["inputs"] == []
        for file in (table, path)[: 1 + len(own)]:
            with pytest.raises(sl.InputError, match="would be destroyed"):
                parsed.save(file, overwrite=True)


def test_landmarks_and_pictures_of_a_case_are_never_replaced(tmp_path: Path) -> None:
    films = sl.phantom("rod", subject=1)
    [table] = films.to_csv(tmp_path, film="erect")
    picture = tmp_path / "erect.png"
    picture.write_bytes(b"a picture")
    erect = films.film("erect")
    film = sl.Film(table, film="erect", mm_per_px=erect.mm_per_px, picture=picture, size_px=erect.size_px)
    case = sl.Case.from_films([film, *map(films.film, films.films[1:])])
    before, found = table.read_bytes(), sl.analyze(case)
    made = [case, film, found, found.model()]
    for write in [one.save for one in (*made, *pickle.loads(pickle.dumps(made)))]:
        for path in (table, picture):
            with pytest.raises(sl.InputError, match="would be destroyed"):
                write(path, overwrite=True)
    with pytest.raises(sl.InputError, match="would be destroyed"):
        case.to_csv(tmp_path, overwrite=True)
    assert table.read_bytes() == before and picture.read_bytes() == b"a picture"



def test_threads_give_the_same(case: sl.Case, analysis: sl.Analysis) -> None:
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda _: sl.analyze(case), range(8)))
    assert all(one == analysis for one in found)


def test_the_recorded_call_has_no_folders_and_no_types_of_python(case: sl.Case, analysis: sl.Analysis, tmp_path: Path) -> None:
    folder = tmp_path / "Doe^Jane"
    folder.mkdir()
    table = folder / "own.json"
    table.write_text(json.dumps(analysis.data["provenance"]["options"]["stiffness"]))
    line = np.array([0.0, 200.0, 3.5])
    for given in (table, str(table)):
        found = sl.analyze(case, stiffness=given, given_line={"left_bending": line}, min_curve=np.float64(6.0))  # type: ignore[typeddict-item]
        assert found.data["provenance"]["command"] == [
            "spineline.analyze",
            "stiffness=own.json",
            "given_line=left_bending=0.0,200.0,3.5",
            "min_curve=6.0",
        ]
        assert found.data["provenance"]["inputs"][-1]["name"] == "own.json"
        assert "Doe^Jane" not in found.to_json()
