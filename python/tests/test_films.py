"""Films from every kind of landmarks, cases from films, and landmarks for other programs."""

from __future__ import annotations

import hashlib
import io
import json
import logging
import pickle
import subprocess
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import spineline as sl

CORNERS = ("superior_left", "superior_right", "inferior_left", "inferior_right")
AXES = ("column", "row")


@pytest.fixture(scope="module")
def film(case: sl.Case) -> sl.Film:
    return case.film("traction")


def with_facts(landmarks: Any, film: sl.Film, **options: Any) -> sl.Film:
    """The film of these landmarks with the picture and scale of another film."""
    facts = {"film": film.name, "mm_per_px": film.mm_per_px, "plane": film.plane, "size_px": film.size_px}
    return sl.Film(landmarks, **{**facts, **options})


def lateral_table(**changed: object) -> dict[str, Any]:
    """Landmarks of a straight lateral film with the front on the right of the picture."""
    levels = ["L4", "L3", "L2", "L1", *(f"T{n}" for n in range(12, 1, -1))]
    top = [1700.0 - 100.0 * place for place in range(len(levels))]
    columns: dict[str, Any] = {"vertebra": levels}
    for corner, column, below in (
        ("superior_anterior", 550.0, 0.0),
        ("superior_posterior", 450.0, 0.0),
        ("inferior_anterior", 550.0, 70.0),
        ("inferior_posterior", 450.0, 70.0),
    ):
        columns[f"{corner}_column_px"] = [column] * len(levels)
        columns[f"{corner}_row_px"] = [row + below for row in top]
    return {**columns, **changed}


def test_a_case_is_the_same_when_it_is_put_together_from_its_films(case: sl.Case) -> None:
    again = sl.Case.from_films([case.film(name) for name in case.films], case_id=case.id)
    ours, theirs = (json.loads(one.to_json()) for one in (again, case))
    theirs.pop("subject")
    assert ours == theirs and again.synthetic


def test_a_film_has_its_scale_side_and_size(case: sl.Case) -> None:
    film = case.film("left-bending")
    image = json.loads(case.to_json())["films"][1]["image"]
    assert (film.name, film.synthetic, film.patient_anterior, film.picture) == ("left_bending", True, None, None)
    assert film.size_px == (image["columns"], image["rows"]) and film.plane == image["spacing_plane"]
    assert film.mm_per_px == (image["column_spacing_mm"], image["row_spacing_mm"])
    assert film.patient_left == image["patient_left"].replace("_", "-")
    again = pickle.loads(pickle.dumps(film))
    assert again == film and again != case.film("erect") and "SYNTHETIC" in repr(film)
    assert sl.Film.from_json(film.to_json()) == film
    with pytest.raises(sl.InputError, match="the case has 5 films"):
        sl.Film.from_json(case.to_json())


def test_films_of_a_case_may_differ_in_scale_plane_and_side(case: sl.Case) -> None:
    erect = with_facts(case.film("erect").landmarks, case.film("erect"))
    mirrored = case.film("traction")
    width = mirrored.size_px[0] if mirrored.size_px else 0
    columns = {name: mirrored.landmarks[name] for name in mirrored.landmarks.columns}
    columns |= {name: width - 1 - columns[name] for name in columns if name.endswith("_column_px")}
    columns.pop("axis_clockwise_deg")
    other = with_facts(columns, mirrored, patient_left="image-right", plane="detector", mm_per_px=(0.12, 0.1))
    found = sl.Case.from_films([erect, other], case_id="P07")
    assert [found.film(name).plane for name in found.films] == ["patient", "detector"]
    assert (found.film("traction").mm_per_px, found.film("traction").patient_left) == ((0.12, 0.1), "image-right")


@pytest.mark.parametrize(
    "given",
    [
        lambda table: table,
        lambda table: table.to_pandas(),
        lambda table: table.to_pandas().astype({"repeat": "float64"}),
        lambda table: table.to_polars(),
        lambda table: table.to_polars().lazy(),
        lambda table: table.to_pyarrow(),
        lambda table: table.to_pyarrow().to_reader(),
        lambda table: {name: table[name] for name in table.columns},
        lambda table: table.to_csv(),
        lambda table: table.to_csv().encode(),
        lambda table: io.StringIO(table.to_csv()),
    ],
)
def test_every_kind_of_table_gives_the_same_film(given: Callable[[sl.Table], Any], film: sl.Film) -> None:
    for module in ("pandas", "polars", "pyarrow"):
        pytest.importorskip(module)
    found = with_facts(given(film.landmarks), film)
    assert found.landmarks.to_csv() == film.landmarks.to_csv()


def test_an_array_gives_the_same_film_and_nan_is_not_placed(case: sl.Case, caplog: pytest.LogCaptureFixture) -> None:
    exact = sl.phantom("rod", subject=1, noise=0.0).film("erect")
    table = exact.landmarks
    levels = [level for level in table["vertebra"] if level != "iliac_crests"]
    rows = [place for place, level in enumerate(table["vertebra"]) if level != "iliac_crests"]
    points = np.array([[[table[f"{corner}_{axis}_px"][row] for axis in AXES] for corner in CORNERS] for row in rows])
    assert points.shape == (len(levels), 4, 2)
    found = with_facts(points, exact, levels=levels)
    for corner in CORNERS:
        for axis in AXES:
            name = f"{corner}_{axis}_px"
            assert list(found.landmarks[name]) == list(table[name][rows])
    points[3] = np.nan
    with caplog.at_level(logging.WARNING, "spineline"):
        missing = with_facts(points, exact, levels=levels)
    assert list(missing.landmarks["vertebra"]) == levels[:3] + levels[4:] and levels[3] in caplog.text
    points[5, 0, 0] = np.nan
    with pytest.raises(sl.InputError, match=f"{levels[5]}: landmarks missing: superior_left"):
        with_facts(points, exact, levels=levels)
    with pytest.raises(sl.InputError, match=r"shape \(15, 4, 2\) and 14 `levels`"):
        with_facts(points, exact, levels=levels[1:])
    with pytest.raises(sl.InputError, match="no `levels`"):
        with_facts(points, exact)


def test_a_masked_point_of_an_array_was_not_placed() -> None:
    exact = sl.phantom("rod", subject=1, noise=0.0).film("erect")
    table = exact.landmarks
    rows = [place for place, level in enumerate(table["vertebra"]) if level != "iliac_crests"]
    levels = [table["vertebra"][row] for row in rows]
    points = np.array([table[f"{corner}_{axis}_px"][rows] for corner in CORNERS for axis in AXES]).T.reshape(-1, 4, 2)
    place, mask = levels.index("T9"), np.zeros(points.shape, dtype=bool)
    mask[place] = True
    masked = np.ma.array(points, mask=mask)
    for given in (masked, list(masked), masked.astype(object)):
        found = with_facts(given, exact, levels=levels)
        assert found == with_facts(np.where(mask, np.nan, points), exact, levels=levels)
        assert "T9" not in found.landmarks["vertebra"] and "T10" in found.landmarks["vertebra"]
    mask[place, 1:] = False
    with pytest.raises(sl.InputError, match="T9: landmarks missing: superior_left"):
        with_facts(np.ma.array(points, mask=mask), exact, levels=levels)


def test_an_infinite_coordinate_is_refused_with_its_place(film: sl.Film) -> None:
    columns = {name: list(film.landmarks[name]) for name in film.landmarks.columns}
    columns["superior_left_row_px"][columns["vertebra"].index("T9")] = float("inf")
    with pytest.raises(sl.InputError, match="`superior_left_row_px`: `inf` is not a number between"):
        with_facts(columns, film)


def test_a_film_from_the_table_of_a_synthetic_case_is_synthetic(case: sl.Case) -> None:
    film = sl.Film(case.film("erect").landmarks, mm_per_px=0.1)
    assert film.synthetic and sl.Case.from_films([film]).synthetic
    assert sl.Case.from_landmarks(case.landmarks, mm_per_px=0.1).synthetic
    data = json.loads(case.to_json()) | {"synthetic": False}
    real = sl.Case.from_json(json.dumps(data)).film("erect")
    assert not sl.Film(real.landmarks, mm_per_px=0.1).synthetic


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("mm_per_px", "x"),
        ("mm_per_px", (0.1, 0.1, 0.1)),
        ("plane", 3),
        ("patient_left", 1),
        ("patient_anterior", 1),
        ("simultaneous", "yes"),
        ("size_px", (1.5, 2)),
        ("size_px", (-1, 5)),
        ("picture", 3),
        ("inverted", 2),
        ("columns", ["level"]),
        ("ignore", "remark"),
        ("levels", 3),
    ],
)
def test_an_option_of_another_type_is_refused_by_its_name(film: sl.Film, name: str, value: object) -> None:
    with pytest.raises(sl.InputError, match=f"`{name}` is ") as caught:
        with_facts(film.landmarks, film, **{name: value})
    assert caught.value.help and "FilmOptions" not in str(caught.value)


def test_options_take_numbers_of_numpy(film: sl.Film) -> None:
    size = np.array(film.size_px)
    assert with_facts(film.landmarks, film, mm_per_px=np.array(film.mm_per_px), size_px=size) == with_facts(film.landmarks, film)


def test_an_array_without_real_numbers_is_refused(film: sl.Film) -> None:
    points = np.zeros((1, 4, 2))
    for wrong in (points + 1j, points > 0.0, points.astype("datetime64[s]")):
        with pytest.raises(sl.InputError, match=f"type {wrong.dtype.name.split('[')[0]}.* not numbers"):
            with_facts(wrong, film, levels=["L4"])
    for other in (film.landmarks.to_csv(), {"vertebra": ["L4"]}):
        with pytest.raises(sl.InputError, match="`levels` are for arrays alone"):
            with_facts(other, film, levels=["L4"])


def test_columns_of_other_names_and_remarks_are_read(film: sl.Film, tmp_path: Path) -> None:
    columns = {name: film.landmarks[name] for name in film.landmarks.columns}
    columns["Level"] = columns.pop("vertebra")
    columns["Comment"] = ["blurred"] * len(columns["Level"])
    own = {"columns": {"Level": "vertebra"}, "ignore": ["Comment"]}
    assert with_facts(columns, film, **own).landmarks.to_csv() == film.landmarks.to_csv()
    with pytest.raises(sl.InputError, match="unknown column `Comment`"):
        with_facts(columns, film, columns={"Level": "vertebra"})
    with pytest.raises(sl.InputError, match="`rater` is missing"):
        with_facts(columns, film, columns={"Level": "vertebra", "rater": "observer"}, ignore=["Comment"])
    [points] = sl.Case.from_films([film]).to_slicer(tmp_path)
    with pytest.raises(sl.InputError, match="`columns` is not for a file without columns"):
        with_facts(points, film, columns={"Level": "vertebra"})


def test_files_come_from_paths_archives_and_other_file_systems(case: sl.Case, tmp_path: Path) -> None:
    fsspec = pytest.importorskip("fsspec")
    [csv] = case.to_csv(tmp_path)
    archive = tmp_path / "cases.zip"
    with zipfile.ZipFile(archive, "w") as writer:
        writer.write(csv, "P07/landmarks.csv")
        writer.writestr("P07/case.json", case.to_json())
    memory = fsspec.filesystem("memory")
    memory.pipe({"/P07/landmarks.csv": csv.read_bytes(), "/P07/opened.csv": csv.read_bytes(), "/P07/case.json": case.to_json().encode()})
    expected = sl.Film(csv, film="erect")
    assert sl.Film(str(csv), film="erect") == expected
    with zipfile.ZipFile(archive) as opened:
        for file in (
            zipfile.Path(archive, "P07/landmarks.csv"),
            opened.open("P07/landmarks.csv"),
            fsspec.open("memory://P07/landmarks.csv"),
            fsspec.open("memory://P07/landmarks.csv", "rt"),
            memory.open("/P07/opened.csv"),
        ):
            assert sl.Film(file, film="erect") == expected
    expected_inputs = [{"name": "case.json", "sha256": hashlib.sha256(case.to_json().encode()).hexdigest()}]
    for file in (zipfile.Path(archive, "P07/case.json"), fsspec.open("memory://P07/case.json")):
        found = sl.analyze(file)
        assert found.case == case and found.data["provenance"]["inputs"] == expected_inputs
    for wrong in (sl.analyze, sl.read_case, sl.Film):
        with pytest.raises(TypeError, match="a path or a file is needed, not int"):
            wrong(5)
    with pytest.raises(sl.InputError, match="missing.csv") as caught:
        sl.Film(tmp_path / "missing.csv", film="erect")
    assert caught.value.file == str(tmp_path / "missing.csv")


def test_a_lateral_film_is_part_of_a_case(case: sl.Case) -> None:
    options: sl.FilmOptions = {"film": "lateral", "mm_per_px": 0.4, "patient_anterior": "image-right", "simultaneous": True}
    film = sl.Film(lateral_table(), **options)
    assert (film.name, film.mm_per_px, film.patient_left, film.patient_anterior) == (
        "lateral",
        (0.4, 0.4),
        None,
        "image-right",
    )
    found = sl.Case.from_films([case.film("erect"), film], case_id="P07")
    assert found.films == ["erect"] and found.film("lateral").landmarks.to_csv() == film.landmarks.to_csv()
    assert found.film("lateral").size_px == film.size_px == (551, 1771)
    assert json.loads(found.to_json())["lateral"]["simultaneous"] is True
    assert sl.analyze(found).is_usable is sl.analyze(sl.Case.from_films([case.film("erect")])).is_usable
    array = np.array([film.landmarks[name] for name in film.landmarks.columns if name.endswith("_px")]).T.reshape(-1, 4, 2)
    assert sl.Film(array, levels=list(film.landmarks["vertebra"]), **options) == film
    with pytest.raises(sl.InputError, match="needs `patient_anterior`"):
        sl.Film(lateral_table(), film="lateral")
    with pytest.raises(sl.InputError, match="`patient_left` is not for the lateral film"):
        sl.Film(lateral_table(), **options, patient_left="image-left")
    with pytest.raises(sl.InputError, match="`plane` is not for the lateral film"):
        sl.Film(lateral_table(), **options, plane="patient")
    with pytest.raises(sl.InputError):
        sl.Film(lateral_table(superior_anterior_row_px=[2000.0] * 15), **options)
    with pytest.raises(sl.InputError, match="two films are lateral"):
        sl.Case.from_films([film, film])


def test_a_picture_is_kept_by_name_and_content(film: sl.Film, tmp_path: Path) -> None:
    path = tmp_path / "Doe" / "traction.png"
    path.parent.mkdir()
    path.write_bytes(b"a picture")
    found = with_facts(film.landmarks, film, picture=path, inverted=True)
    image = json.loads(sl.Case.from_films([found]).to_json())["films"][0]["image"]
    assert (image["file"], image["inverted"]) == (found.picture, True) == ("traction.png", True)
    assert image["sha256"] == hashlib.sha256(b"a picture").hexdigest() and "Doe" not in found.to_json()
    with pytest.raises(sl.InputError, match="`picture` needs `size_px`"):
        sl.Film(film.landmarks, film="traction", picture=path)
    with pytest.raises(sl.InputError, match="missing.png"):
        with_facts(film.landmarks, film, picture=tmp_path / "missing.png")


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({}, "of 5 films: erect, left_bending"),
        ({"film": 3}, "`film` is 3"),
        ({"film": "errect"}, "did you mean `erect`"),
        ({"film": "erect", "mm_per_pxx": 1}, "did you mean `mm_per_px`"),
        ({"film": "erect", "mm_per_px": -0.1}, "erect film: column spacing is -0.1 mm"),
        ({"film": "erect", "mm_per_px": float("nan")}, "erect film: column spacing"),
        ({"film": "erect", "mm_per_px": 0.1, "plane": "film"}, "`plane` is `film`"),
        ({"film": "erect", "size_px": (10, 10)}, "outside"),
        ({"film": "erect", "patient_left": "left"}, "`patient_left` is `left`"),
        ({"film": "erect", "patient_anterior": "image-left"}, "`patient_anterior` is not for a frontal film"),
        ({"film": "erect", "plane": "detector"}, "`plane` needs `mm_per_px`"),
        ({"film": "erect", "mm_per_px": 0.1, "inverted": True}, "`inverted` is not for a film without `picture`"),
    ],
)
def test_wrong_facts_of_a_film_are_named(options: dict[str, Any], text: str, case: sl.Case) -> None:
    with pytest.raises(sl.InputError, match=text):
        sl.Film(case.landmarks, **options)


def test_wrong_tables_and_films_are_named(case: sl.Case) -> None:
    with pytest.raises(sl.InputError, match="`vertebra` 2, `observer` 1"):
        sl.Film({"vertebra": ["L4", "L3"], "observer": ["A"]}, film="erect")
    with pytest.raises(sl.InputError, match=r"`mm_per_px` is '0\.1'"):
        sl.Film(case.landmarks, film="erect", mm_per_px="0.1")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="made from films, not Case"):
        sl.Case.from_films([case])  # type: ignore[list-item]
    with pytest.raises(sl.InputError, match="two films are erect"):
        sl.Case.from_films([case.film("erect")] * 2)
    with pytest.raises(sl.InputError, match="the case has no lateral film"):
        case.film("lateral")
    erect = case.film("erect")
    same = sl.Film(erect.landmarks.to_csv().replace("erect", "neutral"), mm_per_px=erect.mm_per_px)
    with pytest.raises(sl.InputError, match="neutral"):
        sl.Case.from_films([erect, same])


def test_locations_in_mm_state_their_plane() -> None:
    levels = ["L4", "L3", "L2", "L1", *(f"T{n}" for n in range(12, 1, -1))]
    table = {
        "vertebra": levels,
        "location_left_mm": [0.0] * 15,
        "location_cranial_mm": [25.0 * place for place in range(15)],
        "tilt_right_deg": [0.0] * 15,
    }
    film = sl.Film(table, film="erect", plane="patient")
    assert (film.plane, film.size_px, film.mm_per_px) == ("patient", None, None)
    assert sl.Film(table, film="erect").plane == "unknown"
    assert list(film.landmarks["location_cranial_mm"]) == table["location_cranial_mm"]
    with pytest.raises(sl.InputError, match="`mm_per_px` is not for a film of locations"):
        sl.Film(table, film="erect", mm_per_px=0.1)
    with pytest.raises(sl.InputError, match="`patient_left` is not for a film of locations"):
        sl.Film(table, film="erect", patient_left="image-left")


def test_the_landmarks_of_a_case_are_a_table(case: sl.Case) -> None:
    pytest.importorskip("pandas")
    table = case.landmarks
    reading = json.loads(case.to_json())["films"][0]["readings"][0]
    [row] = [
        row
        for row in table
        if (row["posture"], row["vertebra"]) == ("erect", "T9")
        and (row["observer"], row["repeat"]) == (reading["observer"], reading["repeat"])
    ]
    for corner in CORNERS:
        assert [row[f"{corner}_{axis}_px"] for axis in AXES] == reading["vertebrae"]["T9"][corner]
    assert table.units["superior_left_column_px"] == "px" and table.units["axis_clockwise_deg"] == "deg"
    assert pickle.loads(pickle.dumps(table)).to_csv() == table.to_csv()
    frame = table.to_pandas()
    assert (frame.vertebra < "T10").any() and frame.vertebra.min() in ("iliac_crests", "L4")
    assert frame.posture.nunique() == len(case.films)


@pytest.mark.parametrize(("target", "count"), [("csv", 1), ("slicer", 5), ("labelme", 30), ("coco", 1)])
def test_landmarks_are_written_as_the_program_writes_them(
    target: str, count: int, case: sl.Case, program: Path, tmp_path: Path
) -> None:
    file = case.save(tmp_path / "case.json")
    write = getattr(case, f"to_{target}")
    paths = write(tmp_path / "ours")
    theirs = tmp_path / "theirs"
    subprocess.run([program, "export", file, "--to", target, "--out", theirs], check=True, capture_output=True)
    assert len(paths) == count
    for path in paths:
        other = theirs if count == 1 else theirs / path.name
        assert path.read_bytes() == other.read_bytes()
    with pytest.raises(FileExistsError):
        write(tmp_path / "ours")
    [erect, *_] = write(tmp_path / "ours", film="erect", overwrite=True)
    found = sl.Film(erect, film="erect", **{key: getattr(case.film("erect"), key) for key in ("mm_per_px", "size_px")})
    ours, expected = (one.landmarks["superior_left_row_px"] for one in (found, case.film("erect")))
    assert len(ours) >= 15 and np.abs(np.subtract.outer(ours, expected)).min(axis=1).max() < 1e-6
    with pytest.raises(sl.InputError, match="for frontal films only"):
        write(tmp_path / "ours", film="lateral")


def test_reports_need_the_dicom_files_of_the_films(case: sl.Case, tmp_path: Path) -> None:
    with pytest.raises(sl.InputError, match="erect film: its DICOM file is missing") as caught:
        case.to_dicom_sr(tmp_path, dicom={})
    assert caught.value.film == "erect"
    with pytest.raises(sl.InputError, match="did you mean `erect`"):
        case.to_dicom_sr(tmp_path, dicom={"errect": b""})
    wrong = tmp_path / "erect.dcm"
    wrong.write_bytes(b"no DICOM file")
    with pytest.raises(sl.InputError, match="erect"):
        case.to_dicom_sr(tmp_path / "reports", film="erect", dicom={"erect": wrong})
    assert not (tmp_path / "reports").exists()


def test_reports_are_as_the_program_writes_them(
    program: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "phantom"
    # A quarter of the usual columns and rows.
    make = ["phantom", "--scenario", "rod", "--subject", "1", "--pixel-size", "4", "--films", "--out", folder]
    subprocess.run([program, *make], check=True, capture_output=True)
    file = folder / "phantom-rod-01.json"
    theirs = ["export", file, "--to", "dicom-sr", "--posture", "erect", "--written", "20260131235959", "--out", tmp_path / "theirs"]
    subprocess.run([program, *theirs], check=True, capture_output=True)
    case = sl.read_case(file)
    dicom = folder / str(case.film("erect").picture)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1769903999")
    paths = case.to_dicom_sr(tmp_path / "ours", film="erect", dicom={"erect": dicom})
    assert [path.name for path in paths] == [f"erect-{number}.dcm" for number in range(1, 7)]
    assert all(path.read_bytes() == (tmp_path / "theirs" / path.name).read_bytes() for path in paths)
    bend = folder / str(case.film("left_bending").picture)
    for other in (bend, bend.read_bytes()):
        with pytest.raises(sl.InputError, match="erect film: .*different SHA-256") as caught:
            case.to_dicom_sr(tmp_path / "other", film="erect", dicom={"erect": other})
        assert caught.value.film == "erect" and not (tmp_path / "other").exists()
    erect = case.film("erect")
    again = sl.Film(paths[0], picture=dicom, size_px=erect.size_px, mm_per_px=erect.mm_per_px)
    assert (again.name, again.picture, len(again.landmarks)) == ("erect", dicom.name, 16)
    [drawn] = case.to_labelme(tmp_path / "labelme", film="erect")[:1]
    assert sl.Film(drawn, film="erect", picture=dicom).size_px == erect.size_px
