"""Spineline in 3D Slicer: corners of vertebrae in, curve, lines of action, model and verdict out.

Its window was not run inside of Slicer yet: see README.md beside this folder.
"""

import tempfile
from pathlib import Path

import ctk
import qt
import slicer
import vtk
from slicer.ScriptedLoadableModule import (
    ScriptedLoadableModule,
    ScriptedLoadableModuleLogic,
    ScriptedLoadableModuleTest,
    ScriptedLoadableModuleWidget,
)

COLOURS = {
    "curve": (0.0, 0.0, 0.0),
    "inflections": (0.90, 0.62, 0.0),
    "inflection_line": (0.0, 0.45, 0.70),
    "iliac_line": (0.84, 0.37, 0.0),
    "estimated_line": (0.0, 0.62, 0.45),
}


class SpinelineAnalysis(ScriptedLoadableModule):
    """What Slicer shows of the module in its menus."""

    def __init__(self, parent):
        super().__init__(parent)
        parent.title = "Spineline"
        parent.categories = ["Orthopedics"]
        parent.contributors = ["The Spineline developers"]
        parent.helpText = (
            "Turns corners of vertebrae on frontal films of a scoliotic spine into a personalised multibody model. "
            "Name points T12_superior_left, by the patient's side. Research software, not a medical device."
        )


class SpinelineAnalysisWidget(ScriptedLoadableModuleWidget):
    """The panel: a point list and a volume per film, a button, the verdict."""

    def setup(self):
        """Builds the panel."""
        super().setup()
        if not provide_package():
            self.layout.addWidget(qt.QLabel("The Python package `spineline` is needed: install its wheel, then reload the module."))
            return
        from SpinelineAnalysisLib.logic import POSTURES

        self.logic = SpinelineAnalysisLogic()
        self.films = {}
        for posture in POSTURES:
            box = ctk.ctkCollapsibleButton()
            box.text = f"{posture.replace('_', ' ')} film"
            box.collapsed = posture != "erect"
            form = qt.QFormLayout(box)
            points, volume, side = selector("vtkMRMLMarkupsFiducialNode"), selector("vtkMRMLScalarVolumeNode"), qt.QComboBox()
            side.addItems(["image-right", "image-left"])
            form.addRow("Corners", points)
            form.addRow("Film", volume)
            form.addRow("The patient's left is on the", side)
            self.layout.addWidget(box)
            self.films[posture] = (points, volume, side)
        self.plane = qt.QComboBox()
        self.plane.addItems(["unknown", "patient", "detector"])
        form = qt.QFormLayout()
        form.addRow("The spacing holds in the plane of the", self.plane)
        self.synthetic = qt.QCheckBox()
        form.addRow("The films are synthetic", self.synthetic)
        self.layout.addLayout(form)
        button = qt.QPushButton("Analyse")
        button.clicked.connect(self.analyse)
        self.layout.addWidget(button)
        self.verdict = qt.QTextBrowser()
        self.layout.addWidget(self.verdict)
        self.layout.addStretch(1)

    def analyse(self):
        """Runs the analysis and shows what it says."""
        import spineline as sl

        chosen = [
            (posture, points.currentNode(), volume.currentNode(), side.currentText)
            for posture, (points, volume, side) in self.films.items()
            if points.currentNode() and volume.currentNode()
        ]
        try:
            analysis = self.logic.run(chosen, self.plane.currentText, synthetic=self.synthetic.checked)
        except (sl.InputError, sl.NotAResultError) as error:
            self.verdict.setPlainText(str(error))
            return
        notices = [f"{one.severity}: {one.film or 'all films'}: {one.text}" for one in analysis.warnings]
        self.verdict.setPlainText("\n\n".join([*analysis.verdict, *notices]))
        self.logic.show_report(analysis)


class SpinelineAnalysisLogic(ScriptedLoadableModuleLogic):
    """Nodes of Slicer in and out; all else is in ``SpinelineAnalysisLib.logic``."""

    def run(self, chosen, plane="unknown", *, synthetic=False):
        """Analyses the chosen films and draws on them; gives the analysis."""
        import spineline as sl
        from SpinelineAnalysisLib import logic

        films = [self.film(*one) for one in chosen]
        case = logic.case_of(films, case_id="slicer", plane=plane, synthetic=synthetic)
        analysis = sl.analyze(case)
        for film in films:
            found = logic.drawn(analysis, film)
            self.draw("vtkMRMLMarkupsCurveNode", f"{film.posture} curve", found.curve_ras, "curve")
            self.draw("vtkMRMLMarkupsFiducialNode", f"{film.posture} inflections", found.inflections_ras, "inflections")
            for line, ends in found.lines_ras.items():
                self.draw("vtkMRMLMarkupsLineNode", f"{film.posture} {line.replace('_', ' ')}", ends, line)
        for line in analysis.lines[:1]:
            self.draw("vtkMRMLMarkupsCurveNode", "Spineline model", logic.model_ras(analysis.model(line)), "curve")
        return analysis

    def film(self, posture, points, volume, side):
        """A film as the nodes have it; points that were never placed are passed over."""
        from SpinelineAnalysisLib.logic import FilmPoints

        placed = [
            i for i in range(points.GetNumberOfControlPoints())
            if points.GetNthControlPointPositionStatus(i) == slicer.vtkMRMLMarkupsNode.PositionDefined
        ]
        matrix = vtk.vtkMatrix4x4()
        volume.GetRASToIJKMatrix(matrix)
        spacing, size = volume.GetSpacing(), volume.GetImageData().GetDimensions()
        return FilmPoints(
            posture=posture,
            labels=[points.GetNthControlPointLabel(i) for i in placed],
            points_ras=[list(points.GetNthControlPointPositionWorld(i)) for i in placed],
            ras_to_ijk=[[matrix.GetElement(row, column) for column in range(4)] for row in range(4)],
            spacing_mm=(spacing[0], spacing[1]),
            size_px=(size[0], size[1]),
            patient_left=side,
        )

    def draw(self, kind, name, points_ras, colour):
        """Draws points as a locked Markups node of our own, which replaces the node of an earlier run."""
        for old in slicer.util.getNodesByClass(kind):
            if old.GetName() == name and old.GetAttribute("Spineline") == "1":
                slicer.mrmlScene.RemoveNode(old)
        if len(points_ras) == 0:
            return
        node = slicer.mrmlScene.AddNewNodeByClass(kind, name)
        node.SetAttribute("Spineline", "1")
        node.CreateDefaultDisplayNodes()
        slicer.util.updateMarkupsControlPointsFromArray(node, points_ras)
        node.SetLocked(True)
        display = node.GetDisplayNode()
        display.SetSelectedColor(*COLOURS.get(colour, COLOURS["curve"]))
        display.SetPointLabelsVisibility(False)
        display.SetPropertiesLabelVisibility(False)

    def show_report(self, analysis):
        """Opens the report in a separate window."""
        folder = Path(tempfile.mkdtemp(prefix="spineline-"))
        path = analysis.report(folder / "report.html")
        self.window = slicer.qSlicerWebWidget()
        self.window.setMinimumSize(900, 1000)
        self.window.url = qt.QUrl.fromLocalFile(str(path))
        self.window.show()


class SpinelineAnalysisTest(ScriptedLoadableModuleTest):
    """The self-test inside of Slicer: a synthetic film goes through nodes and back."""

    def runTest(self):
        """Runs it."""
        import json

        import numpy as np
        import spineline as sl

        slicer.mrmlScene.Clear()
        film = json.loads(sl.phantom("rod", noise=0).to_json())["films"][0]
        volume = slicer.util.addVolumeFromArray(np.zeros((1, film["image"]["rows"], film["image"]["columns"]), np.uint8))
        volume.SetSpacing(film["image"]["column_spacing_mm"], film["image"]["row_spacing_mm"], 1.0)
        matrix = vtk.vtkMatrix4x4()
        volume.GetIJKToRASMatrix(matrix)
        points = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLMarkupsFiducialNode", "corners")
        for level, corners in film["readings"][0]["vertebrae"].items():
            for corner, (column, row) in corners.items():
                place = matrix.MultiplyPoint((column, row, 0.0, 1.0))
                points.AddControlPoint(vtk.vtkVector3d(*place[:3]), f"{level}_{corner}")
        side = film["image"]["patient_left"].replace("_", "-")
        analysis = SpinelineAnalysisLogic().run([("erect", points, volume, side)], "patient", synthetic=True)
        self.assertEqual(analysis.films, ["erect"])
        self.assertTrue(analysis.synthetic)
        self.assertGreater(slicer.util.getNode("erect curve").GetNumberOfControlPoints(), 10)
        self.delayDisplay("Test passed")


def selector(kind):
    """A choice of a node of the scene, or of none."""
    box = slicer.qMRMLNodeComboBox()
    box.nodeTypes = [kind]
    box.noneEnabled = True
    box.addEnabled = False
    box.removeEnabled = False
    box.setMRMLScene(slicer.mrmlScene)
    return box


def provide_package():
    """Whether the package is there; asks for its wheel before it installs anything."""
    try:
        import spineline  # noqa: F401
    except ImportError:
        from SpinelineAnalysisLib.package import install_arguments, wheel_fault

        if not slicer.util.confirmOkCancelDisplay("The Python package `spineline` is missing. Choose its wheel and install it now?"):
            return False
        path = qt.QFileDialog.getOpenFileName(slicer.util.mainWindow(), "Wheel of Spineline", "", "Wheels (*.whl)")
        if not path:
            return False
        fault = wheel_fault(path)
        if fault:
            slicer.util.errorDisplay(fault)
            return False
        slicer.util.pip_install(install_arguments(path))
    return True
