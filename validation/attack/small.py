"""Small samples of one film at a tenth of its size: a case, the picture, and landmarks in several formats."""

from __future__ import annotations

import json
import struct
import zlib
from pathlib import Path
from typing import Any

SCALE = 0.1
CORNERS = ("superior_left", "superior_right", "inferior_left", "inferior_right")


def small_case(case: dict[str, Any]) -> dict[str, Any]:
    """The erect film of a case and its first reading, with pixels ten times as large."""
    film = next(film for film in case["films"] if film["posture"] == "erect")
    image, reading = film["image"], film["readings"][0]
    for key in ("columns", "rows"):
        image[key] = round(image[key] * SCALE)
    for key in ("column_spacing_mm", "row_spacing_mm"):
        image[key] /= SCALE
    for landmark in reading["vertebrae"].values():
        for corner in CORNERS:
            landmark[corner] = [round(px * SCALE, 3) for px in landmark[corner]]
    film.pop("iliac_crests_px", None)
    film["readings"] = [reading]
    return case | {"case_id": "small", "films": [film]}


def png(columns: int, rows: int) -> bytes:
    """A grey picture of this size."""

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    pixels = b"".join(b"\0" + bytes((row + column) % 256 for column in range(columns)) for row in range(rows))
    head = struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)
    parts = chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(pixels)) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + parts


def write_small(case: Path, folder: Path) -> None:
    """A small version of a case, and its picture, in a folder."""
    folder.mkdir()
    small = small_case(json.loads(case.read_text()))
    (folder / "case.json").write_text(json.dumps(small))
    image = small["films"][0]["image"]
    (folder / "erect.png").write_bytes(png(image["columns"], image["rows"]))
