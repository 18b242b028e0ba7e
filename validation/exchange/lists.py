"""Point lists against Slicer's schema of markups, and against the case."""

from __future__ import annotations

import json

import jsonschema

from cases import CORNERS, Exported

TOLERANCE_PX = 1e-9

# Requirements of Slicer's schema of markups, version 1.0.3, for a point list.
POINT = {
    "type": "object",
    "properties": {
        "id": {"type": "string"},
        "label": {"type": "string"},
        "description": {"type": "string"},
        "associatedNodeID": {"type": "string"},
        "position": {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3},
        "orientation": {"type": "array", "items": {"type": "number"}, "minItems": 9, "maxItems": 9},
        "selected": {"type": "boolean"},
        "locked": {"type": "boolean"},
        "visibility": {"type": "boolean"},
        "positionStatus": {"enum": ["undefined", "preview", "defined"]},
    },
}
SCHEMA = {
    "type": "object",
    "required": ["@schema", "markups"],
    "properties": {
        "@schema": {"type": "string", "pattern": r"markups-schema-v1\.[0-9.]+json#$"},
        "markups": {
            "type": "array",
            "items": {
                "type": "object",
                "required": ["type"],
                "properties": {
                    "type": {"const": "Fiducial"},
                    "name": {"type": "string"},
                    "coordinateSystem": {"enum": ["LPS", "RAS"]},
                    "coordinateUnits": {"enum": ["mm", "um"]},
                    "locked": {"type": "boolean"},
                    "fixedNumberOfControlPoints": {"type": "boolean"},
                    "labelFormat": {"type": "string"},
                    "controlPoints": {"type": "array", "items": POINT},
                },
            },
        },
    },
}


def compare(exported: Exported) -> int:
    """Number of points that agree with the case."""
    films = {film["posture"]: film for film in exported.case["films"]}
    assert len(exported.lists) == len(films)
    points = 0
    for path in exported.lists:
        film = films[path.name.removesuffix(".mrk.json")]
        image, lists = film["image"], json.loads(path.read_text(encoding="utf-8"))
        jsonschema.validate(lists, SCHEMA)
        assert len(lists["markups"]) == len(film["readings"])
        for place, (markup, reading) in enumerate(zip(lists["markups"], film["readings"], strict=True)):
            assert markup["coordinateSystem"] == "LPS"
            wanted = {
                f"{level}_{corner}": vertebra[corner]
                for level, vertebra in reading["vertebrae"].items()
                for corner in CORNERS
            }
            if place == 0:
                crests = film.get("iliac_crests_px", {})
                wanted |= {f"iliac_crest_{side}": crest for side, crest in crests.items()}
            found = {point["label"]: point["position"] for point in markup["controlPoints"]}
            assert found.keys() == wanted.keys()
            for label, (x, y, z) in found.items():
                column, row = wanted[label]
                assert abs(x / image["column_spacing_mm"] - column) < TOLERANCE_PX, label
                assert abs(y / image["row_spacing_mm"] - row) < TOLERANCE_PX and z == 0.0, label
            points += len(found)
    return points
