"""Cases with radiographs: phantoms on either side of the picture, with pixels that are not square."""

from __future__ import annotations

import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.uid import DigitalXRayImageStorageForPresentation, ExplicitVRLittleEndian

CORNERS = ("superior_left", "superior_right", "inferior_left", "inferior_right")
WRITTEN = "20260131101500"


@dataclass(frozen=True)
class Exported:
    """A case, its film's posture keys, and its exports."""

    name: str
    case: dict
    reports: list[Path]
    lists: list[Path]
    table: Path
    tables: Path
    analysis: dict
    typeset: Path
    model: dict
    bodies: dict[str, Path]


class Spineline:
    """The program."""

    def __init__(self, program: Path, out: Path) -> None:
        self.program, self.out = program, out

    def run(self, *arguments: object) -> None:
        """One call that must succeed."""
        subprocess.run([self.program, *map(str, arguments)], check=True, capture_output=True)

    def cases(self) -> list[Exported]:
        """Two phantoms, each on both sides of the picture."""
        found = []
        for scenario, subject in (("rod", 3), ("pull", 8)):
            folder = self.out / f"{scenario}-{subject}"
            self.run("phantom", "--scenario", scenario, "--subject", subject, "--out", folder / "phantom")
            path = folder / "phantom" / f"phantom-{scenario}-{subject:02}.json"
            case = json.loads(path.read_text(encoding="utf-8"))
            for side in ("image_left", "image_right"):
                found.append(self.exported(hung(case, side), folder / side))
        return found

    def exported(self, case: dict, folder: Path) -> Exported:
        """Every format of a case with radiographs."""
        folder.mkdir(parents=True, exist_ok=True)
        for film in case["films"]:
            film["image"]["file"] = f"{film['posture']}.dcm"
            radiograph(film, folder / film["image"]["file"])
        path = folder / "case.json"
        path.write_text(json.dumps(case), encoding="utf-8")
        self.run("analyze", path, "--json", folder / "analysis.json", "--tables", folder / "tables")
        self.run("analyze", path, "--model", folder / "model.json")
        self.run("export", path, "--to", "dicom-sr", "--written", WRITTEN, "--out", folder / "reports")
        self.run("export", path, "--to", "slicer", "--out", folder / "lists")
        self.run("export", path, "--to", "csv", "--out", folder / "landmarks.csv")
        bodies = {form: folder / f"bodies.{form}" for form in ("vtp", "gltf")}
        for form, written in bodies.items():
            self.run("export", folder / "model.json", "--to", form, "--out", written)
        self.run("report", path, "--to", "pdf", "--out", folder / "report.pdf")
        return Exported(
            name=f"{case['case_id']} {folder.name}",
            case=case,
            reports=sorted((folder / "reports").glob("*.dcm")),
            lists=sorted((folder / "lists").glob("*.mrk.json")),
            table=folder / "landmarks.csv",
            tables=folder / "tables",
            analysis=json.loads((folder / "analysis.json").read_text(encoding="utf-8")),
            typeset=folder / "report.pdf",
            model=json.loads((folder / "model.json").read_text(encoding="utf-8")),
            bodies=bodies,
        )


def hung(case: dict, side: str) -> dict:
    """The same case with the patient's left on `side` of the films, and rows twice as far apart."""
    case = json.loads(json.dumps(case))
    for film in case["films"]:
        image = film["image"]
        mirrored = image["patient_left"] != side
        image["patient_left"] = side
        image["row_spacing_mm"] *= 2.0

        def moved(place: list[float]) -> list[float]:
            column = image["columns"] - 1 - place[0] if mirrored else place[0]
            return [column, 0.5 * place[1]]

        for reading in film["readings"]:
            for vertebra in reading["vertebrae"].values():
                for corner in CORNERS:
                    vertebra[corner] = moved(vertebra[corner])
                if mirrored and "axis_deg" in vertebra:
                    vertebra["axis_deg"] *= -1.0
        for crest, place in film.get("iliac_crests_px", {}).items():
            film["iliac_crests_px"][crest] = moved(place)
    return case


def radiograph(film: dict, path: Path) -> None:
    """A black DX picture of the film's size."""
    image = film["image"]
    rank = sorted(("erect", "left_bending", "right_bending", "neutral", "traction")).index(film["posture"])
    picture = Dataset()
    picture.file_meta = FileMetaDataset()
    picture.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
    picture.SOPClassUID = DigitalXRayImageStorageForPresentation
    picture.SOPInstanceUID = f"2.25.{1000 + rank}"
    picture.StudyInstanceUID, picture.SeriesInstanceUID = "2.25.11", f"2.25.{20 + rank}"
    picture.PatientName, picture.PatientID = "Phantom^Müller", "PH-1"
    picture.PatientBirthDate, picture.PatientSex = "", "F"
    picture.SpecificCharacterSet = "ISO_IR 100"
    picture.StudyDate, picture.StudyTime = "20260130", "080000"
    picture.StudyID, picture.AccessionNumber = "S1", ""
    picture.Modality = "DX"
    picture.Rows, picture.Columns = image["rows"], image["columns"]
    picture.SamplesPerPixel, picture.PhotometricInterpretation = 1, "MONOCHROME2"
    picture.BitsAllocated, picture.BitsStored, picture.HighBit = 8, 8, 7
    picture.PixelRepresentation = 0
    size = image["rows"] * image["columns"]
    picture.PixelData = bytes(size + size % 2)
    picture["PixelData"].VR = "OB"
    picture.save_as(path, enforce_file_format=True)


def frontal(image: dict, place: list[float]) -> np.ndarray:
    """A place in mm: to the patient's left, and cranial."""
    sign = 1.0 if image["patient_left"] == "image_right" else -1.0
    return np.array([sign * image["column_spacing_mm"] * place[0], -image["row_spacing_mm"] * place[1]])


def tilt_deg(image: dict, vertebra: dict) -> float:
    """Lateral tilt of the body by its endplates, positive to the patient's right, or of the axis that was turned by hand."""
    if "axis_deg" in vertebra:
        return vertebra["axis_deg"] * (-1.0 if image["patient_left"] == "image_right" else 1.0)
    sl, sr, il, ir = (frontal(image, vertebra[corner]) for corner in CORNERS)
    return normal_tilt_deg(sl + il - sr - ir)


def endplate_deg(image: dict, vertebra: dict, endplate: str) -> float:
    """Lateral tilt of the normal of the `superior` or the `inferior` endplate, positive to the patient's right."""
    left, right = (frontal(image, vertebra[f"{endplate}_{side}"]) for side in ("left", "right"))
    return normal_tilt_deg(left - right)


def normal_tilt_deg(to_left: np.ndarray) -> float:
    """Lateral tilt of the normal of a line to the patient's left."""
    left, cranial = to_left
    return float(np.degrees(np.arctan2(cranial, left)))
