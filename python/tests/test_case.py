"""Cases: files, tables of landmarks, checks, errors that name their place."""

from __future__ import annotations

import json
import pickle
import subprocess
from pathlib import Path

import numpy as np
import pytest

import spineline as sl

CORNERS = ("superior_left", "superior_right", "inferior_left", "inferior_right")
RING = ("superior_left", "superior_right", "inferior_right", "inferior_left")


def landmarks(case: sl.Case, posture: str) -> dict[str, list[object]]:
    """The landmarks of a film as columns."""
    table = case.film(posture).landmarks
    return {name: list(table[name]) for name in table.columns}


def test_a_table_of_landmarks_gives_the_curve_of_the_case(case: sl.Case) -> None:
    made = sl.Case.from_landmarks(
        landmarks(case, "erect"), film="erect", mm_per_px=case.film("erect").mm_per_px, synthetic=True
    )
    assert made.films == ["erect"] and made.synthetic
    found = sl.analyze(made).curve("erect").locations_mm
    expected = sl.analyze(sl.Case.from_films([case.film("erect")])).curve("erect").locations_mm
    assert abs(found - expected).max() < 1e-9


def test_a_missing_corner_is_named(case: sl.Case) -> None:
    columns = landmarks(case, "erect")
    place = columns["vertebra"].index("T9")
    columns["superior_left_row_px"][place] = ""
    with pytest.raises(sl.InputError, match="T9: landmarks missing: superior_left") as caught:
        sl.Case.from_landmarks(columns, film="erect", mm_per_px=0.14)
    assert str(caught.value).startswith(f"row {place + 1} of the table, T9:")
    assert (caught.value.film, caught.value.level) == ("erect", "T9")
    columns["superior_left_row_px"][place] = 2e6  # type: ignore[call-overload]
    with pytest.raises(sl.InputError, match="is not a number between") as caught:
        sl.Case.from_landmarks(columns, film="erect", mm_per_px=0.14)
    assert (caught.value.film, caught.value.level, caught.value.value, caught.value.limit) == ("erect", "T9", 2e6, 1e6)
    with pytest.raises(sl.InputError, match="did you mean `erect`"):
        sl.Case.from_landmarks(landmarks(case, "erect"), film="errect", mm_per_px=0.14)
    with pytest.raises(sl.InputError, match="`case_id` is `Doe, Jane`"):
        sl.Case.from_landmarks(landmarks(case, "erect"), film="erect", mm_per_px=0.14, case_id="Doe, Jane")


def test_a_mirrored_film_is_refused_with_its_place(case: sl.Case) -> None:
    with pytest.raises(sl.InputError) as caught:
        sl.Case.from_landmarks(
            landmarks(case, "erect"), film="erect", mm_per_px=0.14, patient_left="image-right"
        )
    assert caught.value.film == "erect" and "mirrored" in str(caught.value)


def test_an_error_has_film_level_value_limit_and_help(case: sl.Case) -> None:
    data = json.loads(case.to_json())
    film = next(f for f in data["films"] if f["posture"] == "traction")
    for reading in film["readings"]:
        reading["vertebrae"]["T5"], reading["vertebrae"]["T9"] = (
            reading["vertebrae"]["T9"],
            reading["vertebrae"]["T5"],
        )
    broken = sl.Case.from_json(json.dumps(data))
    with pytest.raises(sl.InputError) as caught:
        sl.analyze(broken)
    error = caught.value
    assert error.film == "traction" and error.level is not None
    assert error.value is not None and error.limit is not None and error.value < error.limit
    assert error.help and error.help in str(error)
    again = pickle.loads(pickle.dumps(error))
    assert (again.film, again.level, str(again)) == (error.film, error.level, str(error))
    check = broken.check()
    assert not check.ok and check[0].severity == "error" and check[0].film == "traction"
    assert "Error" in check._repr_html_()
    assert "<td>traction</td><td>1</td>" in broken._repr_html_()
    without = sl.Case.from_films([case.film("traction")])
    assert "<td>no film</td><td>1</td>" in without._repr_html_(), "the erect film is missing"
    with pytest.raises(sl.InputError, match="not UTF-8: byte 3"):
        sl.Case.from_json(b"{}\xff")


def test_an_error_has_the_value_and_the_limit_of_its_text(case: sl.Case, tmp_path: Path) -> None:
    def with_age(age_years: float) -> object:
        data = json.loads(case.to_json())
        return sl.analyze(sl.Case.from_json(json.dumps(data | {"subject": {"age_years": age_years}})))

    def with_turned_axis(deg: float) -> object:
        data = json.loads(case.to_json())
        data["films"][0]["readings"][0]["vertebrae"]["T9"]["axis_deg"] = deg
        return sl.Case.from_json(json.dumps(data))

    def with_spring(nm_per_rad: float) -> object:
        table = sl.analyze(case).data["provenance"]["options"]["stiffness"]
        table["joints"][0]["lateral_nm_per_rad"] = nm_per_rad
        (tmp_path / "own.json").write_text(json.dumps(table))
        return sl.analyze(case, stiffness=tmp_path / "own.json")

    def everywhere(value: float) -> list[object]:
        return ["" if level == "iliac_crests" else value for level in erect["vertebra"]]

    erect = landmarks(case, "erect")
    confident = erect | {f"{corner}_confidence": everywhere(1.5) for corner in CORNERS}
    turned = erect | {"axis_clockwise_deg": everywhere(200.0)}
    for made, value, limit in (
        (lambda: sl.Film(erect, film="erect", mm_per_px=-0.1), -0.1, 0.01),
        (lambda: sl.Film(erect, film="erect", mm_per_px=5.5), 5.5, 5.0),
        (lambda: sl.Film(confident, film="erect", mm_per_px=0.14), 1.5, 1.0),
        (lambda: sl.Film(turned, film="erect", mm_per_px=0.14), 200.0, 180.0),
        (lambda: with_age(-1.0), -1.0, 0.0),
        (lambda: with_age(130.0), 130.0, 125.0),
        (lambda: with_turned_axis(-200.0), -200.0, -180.0),
        (lambda: with_spring(-2.0), -2.0, 0.0),
        (lambda: sl.phantom(noise=20.0), 20.0, 10.0),
        (lambda: sl.phantom(subject=0), 0.0, 1.0),
        (lambda: sl.analyze(case, order_rule=99), 99.0, None),
    ):
        with pytest.raises(sl.InputError) as caught:
            made()
        assert (caught.value.value, caught.value.limit) == (value, limit), str(caught.value)


def test_a_check_lists_doubts_as_a_table(case: sl.Case) -> None:
    check = case.check()
    assert check.ok and all(finding.severity != "error" for finding in check)
    assert "Lateral tilt" in repr(check) and "<table>" in check._repr_html_()
    assert "Synthetic data" in check._repr_html_()


def test_vertebrae_of_findings_are_in_the_order_of_the_spine(case: sl.Case) -> None:
    pytest.importorskip("pandas")
    columns = landmarks(case, "erect")
    for level in ("T10", "T2"):
        columns["superior_left_row_px"][columns["vertebra"].index(level)] -= 80.0  # type: ignore[operator]
    frame = sl.Case.from_landmarks(columns, film="erect", mm_per_px=0.1).check().to_pandas()
    assert {"T10", "T2"} <= set(frame.level.dropna()) and frame.level.max() == "T2"


def test_a_misspelt_key_is_named_with_its_file_and_the_nearest_key(tmp_path: Path) -> None:
    path = tmp_path / "case.json"
    path.write_text('{"format": "spineline-case", "version": 1, "case_id": "a", "filmes": []}')
    with pytest.raises(sl.InputError, match="did you mean `films`") as caught:
        sl.read_case(path)
    assert caught.value.file == str(path)
    with pytest.raises(sl.InputError, match="missing.json"):
        sl.read_case(tmp_path / "missing.json")


def test_unknown_phantoms_are_errors() -> None:
    for wrong in ({"scenario": "rood"}, {"subject": 19}, {"subject": -1}, {"seed": -1}, {"noise": "x"}, {"scenario": 3}):
        with pytest.raises(sl.InputError, match=str(next(iter(wrong.values())))):
            sl.phantom(**wrong)  # type: ignore[arg-type]


def test_the_text_of_a_case_is_not_a_path_and_not_repeated_in_the_error(case: sl.Case) -> None:
    for read in (sl.analyze, sl.read_case):
        with pytest.raises(sl.InputError, match="not the text of a file") as caught:
            read(case.to_json())
        assert "Case.from_json" in caught.value.help and len(str(caught.value)) < 200


def test_locations_without_a_picture_have_no_pixels() -> None:
    page = (Path(__file__).resolve().parents[2] / "docs/guide/src/case.md").read_text()
    case = sl.Case.from_json(page.split("```json\n")[1].split("```")[0])
    curve = sl.analyze(case).curve("erect")
    with pytest.raises(sl.InputError, match="no picture"):
        curve.to_pixels(curve.points_mm)


def test_a_film_without_a_scale_has_no_pixels_of_millimetres(case: sl.Case) -> None:
    unscaled = sl.Case.from_landmarks(landmarks(case, "erect"), film="erect", synthetic=True)
    curve = sl.analyze(unscaled).curve("erect")
    for read in (lambda: curve.points_mm, lambda: curve.locations_mm, lambda: curve.to_pixels([[0.0, 0.0]])):
        with pytest.raises(sl.InputError, match="no spacing") as caught:
            read()
        assert caught.value.film == "erect"


def corners_px(readings: list[dict[str, dict[str, dict[str, object]]]]) -> list[object]:
    """All corners of all readings, without axes that were set by hand."""
    return [
        vertebra[corner]
        for reading in readings
        for vertebra in reading["vertebrae"].values()
        for corner in CORNERS
    ]


def test_landmark_files_of_other_programs_are_read(program: Path, tmp_path: Path) -> None:
    case = sl.phantom("rod", subject=1)
    file = case.save(tmp_path / "case.json")
    command = [program, "export", file, "--to", "slicer", "--posture", "erect"]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    image = json.loads(case.to_json())["films"][0]["image"]
    found = sl.Case.from_landmarks(
        text,
        mm_per_px=(image["column_spacing_mm"], image["row_spacing_mm"]),
        patient_left=image["patient_left"].replace("_", "-"),
        case_id="slicer",
    )
    ours, theirs = (json.loads(one.to_json())["films"][0]["readings"] for one in (found, case))
    assert np.allclose(corners_px(ours), corners_px(theirs), atol=1e-6)


def test_bodies_by_quadrilaterals_need_only_the_given_side() -> None:
    # In this subject no endplate is so steep that it looks like a wall of the quadrilateral.
    case = sl.phantom("rod", subject=4)
    film = json.loads(case.to_json())["films"][0]
    image, (reading, *_) = film["image"], film["readings"]
    # labelme counts from the corner of a pixel.
    shapes = [
        {
            "label": level,
            "shape_type": "polygon",
            "points": [[vertebra[corner][0] + 0.5, vertebra[corner][1] + 0.5] for corner in RING],
        }
        for level, vertebra in reading["vertebrae"].items()
    ]
    size = {"imageWidth": image["columns"], "imageHeight": image["rows"]}
    found = sl.Case.from_landmarks(
        json.dumps({"version": "5.0", "imagePath": "a.png", "shapes": shapes, **size}),
        film="erect",
        mm_per_px=(image["column_spacing_mm"], image["row_spacing_mm"]),
        patient_left=image["patient_left"].replace("_", "-"),
        size_px=(image["columns"], image["rows"]),
    )
    ours = json.loads(found.to_json())["films"][0]["readings"]
    assert np.allclose(corners_px(ours), corners_px([reading]), atol=1e-6)
