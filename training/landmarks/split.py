"""Splits the AASCE training films by patient: 70 % training, 10 % validation, 20 % test.

The rule needs a file name only, so that every model of this data can be trained on the same split.
"""

import hashlib
import re

SAME = {153: 78, 239: 238, 141: 77, 157: 79, 85: 12, 250: 249, 71: 35, 237: 34, 276: 228}
"""Numbers that show the same film, or probably the same patient, as another number: found by correlating films that were
aligned by their landmarks (0.78 to 0.98; 99.9 % of other pairs are below 0.71)."""

WITH_CORONAL = {1, 5, 16, 48}
"""Patients whose films recur among those called `coronal`, which have no patient number."""


def patient_of(file_name):
    """`sunhl-1th-02-Jan-2017-162 A AP.jpg` is of patient 162. Films called `...-coronal7.jpg` count as one patient, 0.

    Some numbers recur under another date. They are kept together, although they may be two persons.
    """
    if "coronal" in file_name:
        return 0
    number = int(re.search(r"-(\d+) *[A-Z]? *(?:AP|PA)", file_name).group(1))
    return 0 if number in WITH_CORONAL else SAME.get(number, number)


def part_of(file_name):
    """`train`, `validation` or `test`. All films of one patient are in the same part."""
    patient = patient_of(file_name)
    digest = hashlib.sha256(f"spineline landmarks {patient}".encode()).digest()
    share = int.from_bytes(digest[:4], "big") / 2**32
    if patient == 0:
        return "train"
    return "test" if share < 0.2 else "validation" if share < 0.3 else "train"
