"""The typeset report, read by qpdf, and its attachment compared with the analysis of the same case."""

from __future__ import annotations

import json

import pikepdf
from cases import Exported

ATTACHMENT = "spineline-analysis.json"


def compare(exported: Exported) -> int:
    """Number of pages that qpdf accepts."""
    with pikepdf.open(exported.typeset) as report:
        problems = report.check_pdf_syntax()
        assert not problems, problems
        with report.open_metadata() as metadata:
            assert metadata.pdfa_status == "3B", metadata.pdfa_status
            assert exported.case["case_id"] in metadata["dc:title"], metadata["dc:title"]
        assert list(report.attachments) == [ATTACHMENT], list(report.attachments)
        attached = json.loads(report.attachments[ATTACHMENT].get_file().read_bytes())
        # It has the command and its time.
        assert attached.pop("provenance")["films"] == "synthetic"
        assert attached == {key: value for key, value in exported.analysis.items() if key != "provenance"}
        return len(report.pages)
