"""Reads films of phantoms with pydicom and compares them with the program's statements.

Usage: python compare.py --program path/to/spineline --out folder
"""

from __future__ import annotations

import argparse
import csv
import hashlib
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pydicom
from pydicom.uid import DigitalXRayImageStorageForPresentation

# Subject, encoding, factor on the size of pixels: not square pixels, bone stored dark, seen from the front, the first two
# together, a marker R. One subject has the resolution of real films; the others have a quarter of their pixels, to save time.
FILMS = ((3, "mixed", 2), (4, "rle", 2), (5, "plain", 1), (12, "jpeg-ls", 2), (7, "mixed", 2))

# Attributes of type 1 and 2 that the DX modules require (PS3.3 A.26); only type 2 may be empty.
FILLED = (
    "SOPClassUID SOPInstanceUID StudyInstanceUID SeriesInstanceUID Modality PresentationIntentType ImageType "
    "PatientOrientation SamplesPerPixel PhotometricInterpretation Rows Columns BitsAllocated BitsStored HighBit "
    "PixelRepresentation PixelIntensityRelationship PixelIntensityRelationshipSign RescaleIntercept RescaleSlope "
    "RescaleType PresentationLUTShape LossyImageCompression BurnedInAnnotation ImagerPixelSpacing ImageLaterality "
    "AnatomicRegionSequence WindowCenter WindowWidth"
).split()
PRESENT = (
    "PatientName PatientID PatientBirthDate PatientSex StudyDate StudyTime ReferringPhysicianName StudyID "
    "AccessionNumber SeriesNumber InstanceNumber Manufacturer DetectorType AcquisitionContextSequence"
).split()


def main() -> int:
    """0 if every film is as stated, else 1."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, required=True, help="the spineline program")
    parser.add_argument("--out", type=Path, required=True, help="folder for films and results")
    options = parser.parse_args()
    pydicom.config.settings.reading_validation_mode = pydicom.config.RAISE
    rows, uids = [], set()
    for subject, encoding, pixel_size in FILMS:
        folder = options.out / f"{subject:02}"
        make(options.program, folder, subject, encoding, pixel_size)
        truth = json.loads(next(folder.glob("*.truth.json")).read_text())
        case = json.loads((folder / f"{truth['case_id']}.json").read_text())
        for film in case["films"]:
            stated = truth["films"][film["posture"]]
            data = pydicom.dcmread(folder / film["image"]["file"])
            faults = list(differences(data, stated, film, truth["case_id"]))
            if data.SOPInstanceUID in uids:
                faults.append("another film has its UID")
            uids.add(data.SOPInstanceUID)
            rows.append((stated["file"], data.file_meta.TransferSyntaxUID.name, "; ".join(faults) or "as stated"))
    for row in rows:
        print(f"{row[0]:32} {row[1]:28} {row[2]}")
    with (options.out / "results.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(("file", "transfer_syntax", "verdict"))
        table.writerows(rows)
    bad = sum(row[2] != "as stated" for row in rows)
    print(f"films: {len(rows)} read, {bad} not as stated")
    return 1 if bad or not rows else 0


def make(program: Path, folder: Path, subject: int, encoding: str, pixel_size: int) -> None:
    """Films of one subject."""
    films = ["--films", "--film-encoding", encoding, "--pixel-size", pixel_size]
    command = [program, "phantom", "--subject", subject, *films, "--out", folder]
    subprocess.run([str(word) for word in command], check=True, stdout=subprocess.DEVNULL)


def differences(data: pydicom.Dataset, stated: dict, film: dict, case_id: str) -> Iterator[str]:
    """Differences of the file from the statements."""
    for name in FILLED:
        if name not in data or data[name].is_empty:
            yield f"{name} is empty"
    for name in PRESENT:
        if name not in data:
            yield f"{name} is missing"
    image = film["image"]
    magnified = [1.1 * image[name] for name in ("row_spacing_mm", "column_spacing_mm")]
    found = {
        "class": (data.SOPClassUID, DigitalXRayImageStorageForPresentation),
        "syntax": (data.file_meta.TransferSyntaxUID, stated["transfer_syntax"]),
        "instance in the header": (data.file_meta.MediaStorageSOPInstanceUID, data.SOPInstanceUID),
        "size": ((data.Columns, data.Rows), (image["columns"], image["rows"])),
        "spacing, row first": (list(data.PixelSpacing), [image["row_spacing_mm"], image["column_spacing_mm"]]),
        "detector's spacing": (np.allclose(data.ImagerPixelSpacing, magnified, rtol=1e-9), True),
        "calibration": (data.PixelSpacingCalibrationType, "GEOMETRY"),
        "orientation": (list(data.PatientOrientation), ["R" if image["patient_left"] == "image_left" else "L", "F"]),
        "polarity": (data.PhotometricInterpretation, stated["photometric_interpretation"]),
        "shape": (data.PresentationLUTShape, "INVERSE" if data.PhotometricInterpretation == "MONOCHROME1" else "IDENTITY"),
        "position": (
            data.PatientOrientationCodeSequence[0].CodeMeaning,
            "erect" if film["posture"] == "erect" else "recumbent",
        ),
        "patient": (data.PatientID, case_id),
        "synthetic": (all("SYNTHETIC" in text for text in (data.SeriesDescription, data.ImageComments)), True),
        "bits": ((data.BitsAllocated, data.BitsStored, data.HighBit), (16, 12, 11)),
    }
    for what, (one, other) in found.items():
        if one != other:
            yield f"{what}: {one} instead of {other}"
    pixels = data.pixel_array
    if hashlib.sha256(pixels.astype("<u2").tobytes()).hexdigest() != stated["pixels_sha256"]:
        yield "other pixels"
    yield from bones(data, pixels, stated)


def bones(data: pydicom.Dataset, pixels: np.ndarray, stated: dict) -> Iterator[str]:
    """Vertebrae are brighter than the discs between them, and the lead marker is on its side."""
    bright = pixels.astype(float)
    if data.PhotometricInterpretation == "MONOCHROME1":
        bright = 4095 - bright
    bodies = stated["vertebrae_px"]
    names = ["L5", "L4", "L3", "L2", "L1", *(f"T{number}" for number in range(12, 0, -1))]
    middle = {name: np.mean([bodies[name][corner] for corner in bodies[name]], axis=0) for name in names}
    for low, high in zip(names, names[1:], strict=False):
        bone = (around(bright, middle[low]) + around(bright, middle[high])) / 2
        if around(bright, (middle[low] + middle[high]) / 2) >= bone:
            yield f"the disc above {low} is as bright as the bodies beside it"
    columns = np.nonzero(bright.max(axis=1) == 4095)[0]
    on_left = (stated["lead_marker"] == "left") == (stated["patient_left"] == "image_left")
    upper = bright[columns[columns < data.Rows / 2]] == 4095
    where = np.nonzero(upper.any(axis=0))[0].mean() / data.Columns
    if (where < 0.5) != on_left:
        yield "the lead marker is on the other side"


def around(bright: np.ndarray, place: np.ndarray) -> float:
    """Mean of a square of about 1 mm."""
    column, row = (int(round(value)) for value in place)
    return float(bright[max(row - 5, 0) : row + 6, max(column - 5, 0) : column + 6].mean())


if __name__ == "__main__":
    sys.exit(main())
