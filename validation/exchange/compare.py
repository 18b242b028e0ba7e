"""Reads exported landmarks, tables, typeset reports and shapes with other programs, and compares them with case, analysis and model.

Usage: python compare.py --program path/to/spineline --out folder
"""

from __future__ import annotations

import argparse
import shutil
import sys
from pathlib import Path

import dataframes
import lists
import reports
import shapes
import tables
import typeset
from cases import Spineline


def main() -> int:
    """0 if everything agrees; else an assertion fails."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, required=True, help="the spineline program")
    parser.add_argument("--out", type=Path, required=True, help="folder for cases and exports")
    options = parser.parse_args()
    shutil.rmtree(options.out, ignore_errors=True)
    for exported in Spineline(options.program, options.out).cases():
        counts = (
            f"{reports.compare(exported)} reports",
            f"{lists.compare(exported)} points",
            f"{tables.compare(exported)} rows",
            f"{dataframes.compare(exported)} values",
            f"{typeset.compare(exported)} pages",
            f"{shapes.compare(exported)} corners",
        )
        print(f"{exported.name}: {', '.join(counts)} agree")
    if shutil.which("dsrdump") is None:
        print("dsrdump is missing: DCMTK did not read the reports")
    return 0


if __name__ == "__main__":
    sys.exit(main())
