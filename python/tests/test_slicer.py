"""The module of 3D Slicer, without Slicer: coordinates of its nodes to a case, and results back to the films."""

from __future__ import annotations

import ast
import json
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

import spineline as sl

MODULE = Path(__file__).resolve().parents[2] / "integrations/slicer/SpinelineAnalysis"
sys.path.insert(0, str(MODULE))

from SpinelineAnalysisLib import logic, package  # noqa: E402

# A turned, distant volume: columns run to the patient's right, rows caudally and a little back.
TURN = np.deg2rad(20)


def ijk_to_ras(column_mm: float, row_mm: float) -> np.ndarray:
    """Columns of the matrix: the steps of a column, a row and a slice."""
    matrix = np.eye(4)
    matrix[:3, 0] = [-column_mm, 0, 0]
    matrix[:3, 1] = [0, -row_mm * np.sin(TURN), -row_mm * np.cos(TURN)]
    matrix[:3, 2] = [0, -np.cos(TURN), np.sin(TURN)]
    matrix[:3, 3] = [170.0, -35.0, 900.0]
    return matrix


def films_of(case: sl.Case) -> list[logic.FilmPoints]:
    """The first readings of the films, as nodes of Slicer have them."""
    found = []
    for film in json.loads(case.to_json())["films"]:
        image, reading = film["image"], film["readings"][0]
        named = [
            (f"{level}_{corner}", place)
            for level, corners in reading["vertebrae"].items()
            for corner, place in corners.items()
        ]
        crests = film["iliac_crests_px"]
        named += [(f"iliac_crest_{side}", crests[side]) for side in ("left", "right")]
        spacing = (image["column_spacing_mm"], image["row_spacing_mm"])
        matrix = ijk_to_ras(*spacing)
        pixels = np.array([place for _, place in named])
        ras = logic.transformed(matrix, np.column_stack([pixels, np.zeros(len(pixels))]))
        found.append(
            logic.FilmPoints(
                posture=film["posture"],
                labels=[label for label, _ in named],
                points_ras=ras,
                ras_to_ijk=np.linalg.inv(matrix),
                spacing_mm=spacing,
                size_px=(image["columns"], image["rows"]),
                patient_left=image["patient_left"].replace("_", "-"),
            )
        )
    return found


def with_spacing(case: sl.Case, *, columns: float, rows: float) -> sl.Case:
    """The same spine on films whose pixels are not square."""
    data = json.loads(case.to_json())
    for film in data["films"]:
        image = film["image"]
        factors = (image["column_spacing_mm"] / columns, image["row_spacing_mm"] / rows)
        image["column_spacing_mm"], image["row_spacing_mm"] = columns, rows
        image["columns"], image["rows"] = (int(image[name] * f) + 2 for name, f in zip(("columns", "rows"), factors, strict=True))
        places = [place for reading in film["readings"] for v in reading["vertebrae"].values() for place in v.values()]
        for place in [*places, *film["iliac_crests_px"].values()]:
            place[:] = [value * f for value, f in zip(place, factors, strict=True)]
    return sl.Case.from_json(json.dumps(data))


@pytest.fixture(scope="module")
def exact() -> sl.Case:
    return with_spacing(sl.phantom("rod", subject=3, noise=0), columns=0.2, rows=0.15)


def test_points_of_slicer_give_the_original_films(exact: sl.Case) -> None:
    case = logic.case_of(films_of(exact), case_id="slicer", plane="patient")
    assert case.films == exact.films
    for film in case.films:
        ours, theirs = (sl.analyze(one).curve(film).locations_mm for one in (case, exact))
        # A phantom states its true scale, Slicer's films do not: lengths may differ by this factor.
        assert np.allclose(ours[1] / np.linalg.norm(ours[1]), theirs[1] / np.linalg.norm(theirs[1]), atol=1e-9)
    assert np.allclose(sl.analyze(case).curve("erect").locations_mm, sl.analyze(exact).curve("erect").locations_mm, atol=1e-9)


def test_drawn_lines_lie_on_the_vertebrae(exact: sl.Case) -> None:
    films = films_of(exact)
    analysis = sl.analyze(logic.case_of(films, case_id="slicer", plane="patient"))
    for film in films:
        found = logic.drawn(analysis, film)
        points = np.asarray(film.points_ras, float)
        levels = analysis.curve(film.posture).levels
        middles = np.array(
            [points[[label.startswith(f"{level}_") for label in film.labels]].mean(axis=0) for level in levels]
        )
        away = np.linalg.norm(found.curve_ras[None] - middles[:, None], axis=2).min(axis=1)
        # The curve is a fit, and the mean of corners is not exactly the midpoint; a wrong frame would give more.
        assert away.max() < 2.0, film.posture
        assert found.inflections_ras.shape == (2, 3)
        if film.posture != "erect":
            from_, to = found.lines_ras["inflection_line"]
            along = (to - from_) / np.linalg.norm(to - from_)
            off = found.inflections_ras - from_
            off -= np.outer(off @ along, along)
            assert np.linalg.norm(off, axis=1).max() < 1e-6, "the line goes through the inflections"
    model = logic.model_ras(analysis.model("inflection"))
    assert np.all(np.diff(model[:, 2]) > 0), "cranial is superior"
    erect = analysis.curve("erect").locations_mm
    assert np.allclose(model[:, 0], -erect[:, 0], atol=1e-6), "the patient's left is negative R"


def test_a_wrong_side_and_a_missing_corner_are_refused(exact: sl.Case) -> None:
    erect = films_of(exact)[0]
    other = {"image-left": "image-right", "image-right": "image-left"}[erect.patient_left]
    with pytest.raises(sl.InputError):
        logic.case_of([logic.FilmPoints(**{**vars(erect), "patient_left": other})], case_id="slicer")
    keep = [i for i, label in enumerate(erect.labels) if label != "T9_superior_left"]
    labels, points = [erect.labels[i] for i in keep], np.asarray(erect.points_ras)[keep]
    with pytest.raises(sl.InputError, match="T9"):
        logic.case_of([logic.FilmPoints(**{**vars(erect), "labels": labels, "points_ras": points})], case_id="slicer")
    with pytest.raises(sl.InputError, match="no film"):
        logic.case_of([], case_id="slicer")


def test_synthetic_films_are_marked_in_every_result(exact: sl.Case) -> None:
    films = films_of(exact)
    case = logic.case_of(films, case_id="slicer", synthetic=True)
    assert case.synthetic and "SYNTHETIC" in sl.analyze(case).summary()
    assert not logic.case_of(films, case_id="slicer").synthetic


def test_the_panel_never_asks_an_index_for_the_package() -> None:
    calls = [
        node
        for path in MODULE.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("pip_install")
    ]
    assert [ast.unparse(call) for call in calls] == ["slicer.util.pip_install(install_arguments(path))"]
    assert package.install_arguments("a folder/x.whl") == ["--no-index", "a folder/x.whl"]


def test_only_a_wheel_of_spineline_is_installed(tmp_path: Path) -> None:
    def wheel(name: str, *members: str) -> str:
        path = tmp_path / name
        with zipfile.ZipFile(path, "w") as file:
            for member in members:
                file.writestr(member, "")
        return str(path)

    good = wheel("spineline-0.1.0-cp310-abi3-linux_x86_64.whl", "spineline/__init__.py", "spineline/_native.abi3.so")
    assert package.wheel_fault(good) is None
    cut_off = tmp_path / "spineline-0.1.1-cp310-abi3-linux_x86_64.whl"
    cut_off.write_bytes(Path(good).read_bytes()[:40])
    for path, part in (
        (wheel("numpy-2.0-cp310.whl", "numpy/__init__.py"), "not a wheel of Spineline"),
        (wheel("spineline-0.1.0.zip", "spineline/_native.abi3.so"), "not a wheel of Spineline"),
        (wheel("spineline-9.0-py3-none-any.whl", "spineline/__init__.py"), "no native module"),
        (str(cut_off), "cannot be read"),
        (str(tmp_path / "spineline-1.0-missing.whl"), "cannot be read"),
    ):
        fault = package.wheel_fault(path)
        assert fault is not None and part in fault


def test_the_panel_is_valid_for_the_oldest_python_of_the_wheel() -> None:
    for path in MODULE.rglob("*.py"):
        ast.parse(path.read_text(), feature_version=(3, 10))
