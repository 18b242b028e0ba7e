"""Runs the self-test of the module on the scene and the markups of Slicer from PyPI's `slicer-core`, which has no window."""

import sys
import unittest
from pathlib import Path
from types import ModuleType

import slicer
import slicer.util


class Test(unittest.TestCase):
    """The part of Slicer's class that a self-test uses."""

    def delayDisplay(self, text):
        print(text)


def provide(name, **contents):
    """Puts a module of Slicer's window in place."""
    sys.modules[name] = module = ModuleType(name)
    vars(module).update(contents)


provide("ctk")
provide("qt")
parts = {f"ScriptedLoadableModule{part}": type(part, (), {}) for part in ("", "Widget", "Logic")}
provide("slicer.ScriptedLoadableModule", ScriptedLoadableModuleTest=Test, **parts)
slicer.mrmlScene = slicer.vtkMRMLScene()
sys.path.insert(0, str(Path(__file__).resolve().parent / "SpinelineAnalysis"))

from SpinelineAnalysis import SpinelineAnalysisTest  # noqa: E402

SpinelineAnalysisTest().runTest()
