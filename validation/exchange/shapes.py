"""Vertebral bodies in VTK, the library of 3D Slicer and ParaView, against the model file."""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOGeometry import vtkGLTFReader
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

from cases import Exported

TOLERANCE_MM = 1e-9
TOLERANCE_SINGLE_MM = 1e-3
TOLERANCE_DEG = 1e-9
# Rows are the axes of a file's frame in Spineline's: x anterior, y left, z cranial.
LPS = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
GLTF = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
ANGLES = ("lateral_tilt_deg", "pitch_deg", "axial_rotation_deg")


def compare(exported: Exported) -> int:
    """Number of corners that agree."""
    return polydata(exported) + scene(exported)


def polydata(exported: Exported) -> int:
    """The bodies in LPS and mm, with their angles."""
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(exported.bodies["vtp"]))
    reader.Update()
    shape = reader.GetOutput()
    fields = shape.GetFieldData()
    assert fields.GetAbstractArray("SPACE").GetValue(0) == "LPS"
    names = fields.GetAbstractArray("level_names")
    vertebrae = exported.model["vertebrae"]
    levels = [names.GetValue(i) for i in range(names.GetNumberOfValues())]
    assert levels == [vertebra["level"] for vertebra in vertebrae]
    corners = vtk_to_numpy(shape.GetPoints().GetData())
    assert shape.GetNumberOfPolys() == 6 * len(levels)
    own = vtk_to_numpy(shape.GetPointData().GetArray("level"))
    angles = np.column_stack([vtk_to_numpy(shape.GetPointData().GetArray(name)) for name in ANGLES])
    for i, vertebra in enumerate(vertebrae):
        check_box(corners[own == i] @ LPS, vertebra, TOLERANCE_MM)
        assert np.ptp(angles[own == i], axis=0).max() == 0.0
        turned = rotation(angles[own == i][0])
        assert np.abs(turned - axes(vertebra)).max() < np.radians(TOLERANCE_DEG)
    return len(corners)


def scene(exported: Exported) -> int:
    """The boxes in glTF's frame and m."""
    reader = vtkGLTFReader()
    reader.SetFileName(str(exported.bodies["gltf"]))
    reader.ApplyDeformationsToGeometryOn()
    reader.Update()
    found, blocks = [], reader.GetOutput().NewIterator()
    while not blocks.IsDoneWithTraversal():
        found.append(vtk_to_numpy(blocks.GetCurrentDataObject().GetPoints().GetData()))
        blocks.GoToNextItem()
    vertebrae = exported.model["vertebrae"]
    assert len(found) == len(vertebrae)
    for corners, vertebra in zip(found, vertebrae, strict=True):
        check_box(1000.0 * corners.astype(float) @ GLTF, vertebra, TOLERANCE_SINGLE_MM)
    return sum(map(len, found))


def check_box(corners_mm: np.ndarray, vertebra: dict, tolerance_mm: float) -> None:
    """Corners in Spineline's frame are on a box at the midpoint, along the axes of the vertebra."""
    place = (corners_mm - vertebra["midpoint_mm"]) @ axes(vertebra)
    half = np.abs(place).max(axis=0)
    assert np.abs(np.abs(place) - half).max() < tolerance_mm, vertebra["level"]
    assert (half > 4.0).all() and (half < 40.0).all(), half


def axes(vertebra: dict) -> np.ndarray:
    """Columns are anterior, left and cranial of the vertebra."""
    return np.array(vertebra["axes"]).T


def rotation(angles_deg: np.ndarray) -> np.ndarray:
    """About x, then the new y, then the new z."""
    (sx, sy, sz), (cx, cy, cz) = np.sin(np.radians(angles_deg)), np.cos(np.radians(angles_deg))
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return about_x @ about_y @ about_z
