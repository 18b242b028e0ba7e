"""DICOM reports read by highdicom, by pydicom alone and by DCMTK."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import highdicom as hd
import numpy as np
import pydicom
from pydicom.sr.codedict import codes

from cases import CORNERS, WRITTEN, Exported, endplate_deg, tilt_deg

PIXEL_TOLERANCE, ANGLE_TOLERANCE = 2e-4, 1e-9
OURS = "99SPINELINE"
# Regions of our analysis by the codes of their curves.
CURVES = {"curve-tl-l": "thoracolumbar_lumbar", "curve-mt": "main_thoracic", "curve-pt": "proximal_thoracic"}
# Code values that pydicom's tables of PS3.16 know.
KNOWN = {
    name: {getattr(scheme, keyword).value for keyword in scheme.dir()}
    for name, scheme in (("SCT", codes.SCT), ("DCM", codes.DCM))
}


def compare(exported: Exported) -> int:
    """Number of reports that agree with the case."""
    readings = {}
    for film in exported.case["films"]:
        for reading in film["readings"]:
            readings[film["posture"], reading["observer"], str(reading["repeat"])] = (film, reading)
    for path in exported.reports:
        report = hd.sr.srread(path)
        key = key_of(report)
        film, reading = readings.pop(key)
        check_document(report, film, reading)
        check_groups(report.content, film, reading, curves_of(exported.analysis))
        check_codes(pydicom.dcmread(path))
        dumped(path)
    assert not readings, f"no report of {sorted(readings)}"
    return len(exported.reports)


def key_of(report: hd.sr.ComprehensiveSR) -> tuple[str, str, str]:
    """Posture, observer and repeat from the first group and the observer context."""
    people = report.content.get_observer_contexts(observer_type=codes.DCM.Person)
    devices = report.content.get_observer_contexts(observer_type=codes.DCM.Device)
    assert len(people) == len(devices) == 1
    assert devices[0].observer_identifying_attributes.name == "Spineline"
    groups = report.content.get_image_measurement_groups()
    sessions = {value(group, "C67447", "NCIt") for group in groups}
    postures = {coded(group, "posture", OURS)[0] for group in groups}
    assert len(sessions) == len(postures) == 1, (sessions, postures)
    return postures.pop(), str(people[0].observer_identifying_attributes.name).removesuffix("^"), sessions.pop()


def check_document(report: hd.sr.ComprehensiveSR, film: dict, reading: dict) -> None:
    """Patient, study and evidence match the radiograph."""
    assert report.PatientName == "Phantom^Müller" and report.PatientID == "PH-1"
    assert report.StudyInstanceUID == "2.25.11" and report.Modality == "SR"
    assert report.ContentDate + report.ContentTime == WRITTEN
    assert report.ContentTemplateSequence[0].TemplateIdentifier == "1500"
    (study,) = report.CurrentRequestedProcedureEvidenceSequence
    (series,) = study.ReferencedSeriesSequence
    (instance,) = series.ReferencedSOPSequence
    assert study.StudyInstanceUID == report.StudyInstanceUID
    assert instance.ReferencedSOPClassUID == "1.2.840.10008.5.1.4.1.1.1.1"
    pixels = pydicom.uid.UID(instance.ReferencedSOPInstanceUID)
    assert pixels.is_valid and report.SOPInstanceUID.is_valid and report.SOPInstanceUID.startswith("2.25.")
    for item in walk(report):
        if item.get("ValueType") == "IMAGE":
            assert item.ReferencedSOPSequence[0].ReferencedSOPInstanceUID == pixels


def check_groups(content: hd.sr.MeasurementReport, film: dict, reading: dict, curves: dict) -> None:
    """Every vertebra, curve and the iliac line."""
    image, left, identifiers = film["image"], dict(reading["vertebrae"]), set()
    marked = dict(left)
    tilts = {level: tilt_deg(image, vertebra) for level, vertebra in left.items()}
    for group in content.get_image_measurement_groups():
        assert group.tracking_identifier and group.tracking_uid not in identifiers
        identifiers.add(group.tracking_uid)
        sites = [site.value.meaning.removesuffix(" vertebra") for site in group.finding_sites]
        finding = group.finding_type.value
        if finding == "vertebra":
            (level,) = sites
            vertebra = left.pop(level)
            assert group.finding_sites[0].value == getattr(codes.cid7603, f"{level}Vertebra")
            corners = np.array([vertebra[corner] for corner in CORNERS])
            by_name = {number.name.value: number for number in group.get_measurements()}
            for name in ("tilt", "location-column", "location-row"):
                assert abs(coordinates(by_name[name]) - 0.5 - corners).max() < PIXEL_TOLERANCE
            close(by_name["tilt"].value, tilts[level], ANGLE_TOLERANCE)
            assert by_name["tilt"].unit == codes.UCUM.Degree
            column, row = crossing(corners)
            close(by_name["location-column"].value - 0.5, column, 1e-6)
            close(by_name["location-row"].value - 0.5, row, 1e-6)
        elif finding == "iliac-line":
            crests = film["iliac_crests_px"]
            (number,) = group.get_measurements()
            places = np.array([crests["left"], crests["right"]])
            assert abs(coordinates(number) - 0.5 - places).max() < PIXEL_TOLERANCE
        else:
            superior, inferior = sites
            assert curves.pop(CURVES[finding]) == (inferior, superior)
            (number,) = group.get_measurements()
            assert number.name == codes.SCT.CobbAngle
            # Cobb angle: from the inferior endplate of the lower end vertebra to the superior one of the upper.
            upper = endplate_deg(image, marked[superior], "superior")
            turn = upper - endplate_deg(image, marked[inferior], "inferior")
            close(number.value, abs(turn), ANGLE_TOLERANCE)
            # A spine that turns to the right going up is convex to the left.
            assert coded(group, "convexity", OURS)[1] == ("Left" if turn > 0.0 else "Right")
    assert not left and not curves, (left, curves)


def curves_of(analysis: dict) -> dict[str, tuple[str, str]]:
    """Lower and upper end vertebra per region, from Spineline's analysis."""
    curves = analysis["clinical"]["curves"]
    return {name: tuple(curve["ends"]) for name, curve in curves.items()}


def check_codes(document: pydicom.Dataset) -> None:
    """Every code of a public scheme is in pydicom's tables with the same meaning."""
    for item in walk(document):
        for keyword in ("ConceptNameCodeSequence", "ConceptCodeSequence"):
            for code in item.get(keyword, []):
                assert len(code.CodeValue) <= 16 and len(code.CodeMeaning) <= 64, code
                known = KNOWN.get(code.CodingSchemeDesignator)
                if known is None:
                    assert code.CodingSchemeDesignator in (OURS, "NCIt", "RFC5646"), code
                else:
                    assert code.CodeValue in known, code


def dumped(path: Path) -> None:
    """DCMTK reads the report, with its check of the content's relationships."""
    program = shutil.which("dsrdump")
    if program is None:
        return
    done = subprocess.run([program, path], capture_output=True, text=True, encoding="utf-8", check=False)
    errors = [line for line in done.stderr.splitlines() if line.startswith(("E:", "F:"))]
    assert done.returncode == 0 and not errors, (path, done.stderr)
    assert "Imaging Measurement Report" in done.stdout


def walk(item: pydicom.Dataset):
    """An item and all below it."""
    yield item
    for child in item.get("ContentSequence", []):
        yield from walk(child)


def coordinates(number: object) -> np.ndarray:
    """Columns and rows of the points from which a number is derived."""
    (places,) = [item for item in number.ContentSequence if item.ValueType == "SCOORD"] if hasattr(number, "ContentSequence") else [
        item for item in number[0].ContentSequence if item.ValueType == "SCOORD"
    ]
    assert places.GraphicType == "MULTIPOINT"
    return np.array(places.GraphicData, dtype=float).reshape(-1, 2)


def items(group: object) -> list[pydicom.Dataset]:
    """The content of a measurement group."""
    return list(group[0].ContentSequence)


def named(group: object, code: str, scheme: str) -> pydicom.Dataset:
    """The only item with a name."""
    (found,) = [
        item
        for item in items(group)
        if (item.ConceptNameCodeSequence[0].CodeValue, item.ConceptNameCodeSequence[0].CodingSchemeDesignator)
        == (code, scheme)
    ]
    return found


def value(group: object, code: str, scheme: str) -> str:
    """Text of an item."""
    return named(group, code, scheme).TextValue


def coded(group: object, code: str, scheme: str) -> tuple[str, str]:
    """Code and meaning of an item."""
    concept = named(group, code, scheme).ConceptCodeSequence[0]
    return concept.CodeValue, concept.CodeMeaning


def crossing(corners: np.ndarray) -> np.ndarray:
    """The intersection of the diagonals."""
    sl, sr, il, ir = corners
    along, _ = np.linalg.solve(np.column_stack([ir - sl, sr - il]), sr - sl)
    return sl + along * (ir - sl)


def close(found: float, wanted: float, tolerance: float) -> None:
    """Two numbers agree."""
    assert abs(found - wanted) <= tolerance, (found, wanted)
