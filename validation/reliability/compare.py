"""Compares `spineline reliability` with pingouin and scipy.

Usage: python compare.py --program path/to/spineline --out folder
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import warnings
from collections import Counter
from itertools import combinations
from pathlib import Path

import numpy as np
import pandas as pd
import pingouin
from scipy import stats

from tables import tables

TOLERANCE = 1e-9
Z = stats.norm.ppf(0.975)
ICC = {"icc_2_1": "ICC(A,1)", "icc_3_1": "ICC(C,1)", "icc_2_k": "ICC(A,k)"}


class Comparison:
    """Counts the comparisons, and keeps the differences."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()
        self.worst: dict[str, float] = {}
        self.faults: list[str] = []

    def same(self, table: str, what: str, ours: object, theirs: object) -> None:
        """Numbers, or arrays of them, agree."""
        if ours is None:
            self.wrong(table, what, "undefined without a reason")
            return
        ours, theirs = np.asarray(ours, float), np.asarray(theirs, float)
        apart = float(np.max(np.abs(ours - theirs) / np.maximum(1.0, np.abs(theirs))))
        self.counts[what] += 1
        self.worst[what] = max(self.worst.get(what, 0.0), apart)
        if not apart <= TOLERANCE:
            self.wrong(table, what, f"{ours} against {theirs}")

    def undefined(self, table: str, what: str, reason: str | None, holds: bool) -> None:
        """The program says that the number is undefined, and the reason is true."""
        self.counts[f"{what} undefined"] += 1
        if not holds:
            self.wrong(table, what, f"undefined ({reason}), which is not true")

    def wrong(self, table: str, what: str, why: str) -> None:
        """One difference."""
        self.faults.append(f"{table}, {what}: {why}")


def main() -> int:
    """0 if everything agrees, else 1."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, required=True, help="the spineline program")
    parser.add_argument("--out", type=Path, required=True, help="folder for tables and results")
    options = parser.parse_args()
    # pingouin rounds its output by default.
    for key in [key for key in pingouin.options if key.startswith("round")]:
        pingouin.options[key] = None
    made = tables()
    found = assessed(options.program, options.out, made)
    comparison = Comparison()
    for name, table in made.items():
        compare(comparison, name, table[~np.isnan(table).any(axis=1)], found[name], len(table))
    for what in sorted(comparison.counts):
        worst = comparison.worst.get(what)
        end = "" if worst is None else f", at most {worst:.1e} apart (allowed {TOLERANCE:g})"
        print(f"{what:32} {comparison.counts[what]:4}{end}")
    for fault in comparison.faults:
        print(fault, file=sys.stderr)
    return 1 if comparison.faults else 0


def assessed(program: Path, out: Path, made: dict[str, np.ndarray]) -> dict[str, dict]:
    """The program's results between the observers of every table."""
    out.mkdir(parents=True, exist_ok=True)
    rows = [
        (name, "mm", f"s{i:03}", chr(ord("A") + j), 1, repr(float(value)))
        for name, table in made.items()
        for (i, j), value in np.ndenumerate(table)
        if not np.isnan(value)
    ]
    columns = ["quantity", "unit", "subject", "observer", "repeat", "value"]
    readings, result = out / "readings.csv", out / "reliability.json"
    pd.DataFrame(rows, columns=columns).to_csv(readings, index=False)
    command = [program, "reliability", readings, "--json", result]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    quantities = json.loads(result.read_text(encoding="utf-8"))["quantities"]
    return {quantity["quantity"]: quantity["designs"][0] for quantity in quantities}


def compare(c: Comparison, name: str, table: np.ndarray, found: dict, subjects: int) -> None:
    """One table."""
    n, k = table.shape
    if (found["subjects"], found["dropped"]) != (n, subjects - n):
        c.wrong(name, "subjects", f"{found['subjects']} and {found['dropped']} dropped")
    ours = {statistic["statistic"]: statistic for statistic in found["statistics"]}
    squares = mean_squares(table)
    compare_icc(c, name, table, ours, squares)
    compare_sem(c, name, ours, squares, n, k)
    compare_pearson(c, name, table, ours["pearson"])
    compare_limits(c, name, table, found["bland_altman"])


def mean_squares(table: np.ndarray) -> tuple[float, float, float]:
    """Mean squares of subjects, raters and rest, by plain sums."""
    n, k = table.shape
    means, offsets = table.mean(axis=1), table.mean(axis=0)
    rest = table - means[:, None] - offsets + table.mean()
    freedom = (n - 1) * (k - 1)
    return k * means.var(ddof=1), n * offsets.var(ddof=1), (rest**2).sum() / freedom


def shrout_fleiss(squares: tuple, n: int, k: int) -> dict[str, tuple[float, np.ndarray]]:
    """The three forms with their intervals as Shrout and Fleiss print them, with scipy's quantiles of F."""
    rows, columns, error = squares
    freedom = (n - 1) * (k - 1)
    quantile = lambda a, b: stats.f.ppf(0.975, a, b)  # noqa: E731
    agreement = (rows - error) / (rows + (k - 1) * error + k * (columns - error) / n)
    f, fj = np.float64(rows) / error, np.float64(columns) / error
    bracket = n * (1 + (k - 1) * agreement) - k * agreement
    v = freedom * (k * agreement * fj + bracket) ** 2
    v /= (n - 1) * k**2 * agreement**2 * fj**2 + bracket**2
    less, more = quantile(n - 1, v), quantile(v, n - 1)
    within = k * columns + (k * n - k - n) * error
    single = np.array([
        n * (rows - less * error) / (less * within + n * rows),
        n * (more * rows - error) / (within + n * more * rows),
    ])
    low, high = f / quantile(n - 1, freedom), f * quantile(freedom, n - 1)
    return {
        "icc_2_1": (agreement, single),
        "icc_3_1": ((f - 1) / (f + k - 1), np.array([(low - 1) / (low + k - 1), (high - 1) / (high + k - 1)])),
        "icc_2_k": ((rows - error) / (rows + (columns - error) / n), k * single / (1 + (k - 1) * single)),
    }


def long(table: np.ndarray) -> pd.DataFrame:
    """One row per reading, minus the mean: pingouin's least squares lose digits of large numbers."""
    cells = [(f"s{i:03}", f"r{j}", value) for (i, j), value in np.ndenumerate(table - table.mean())]
    return pd.DataFrame(cells, columns=["subject", "rater", "value"])


def compare_icc(c: Comparison, name: str, table: np.ndarray, ours: dict, squares: tuple) -> None:
    """The three forms and their intervals."""
    rows, columns, error = squares
    n, k = table.shape
    scale = 1e-9 * (rows + columns + k * error)
    if error <= 1e-20 and name in ("perfect", "ties"):
        for key in ICC:
            one = {"perfect": (1.0, [1.0, 1.0]), "ties": (None, None)}[name]
            what = (ours[key]["value"], ours[key]["interval_95"])
            c.counts["without any error"] += 1
            if what != one:
                c.wrong(name, key, f"{what} should be {one}")
        return
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        formulas = shrout_fleiss(squares, n, k)
        package = None
        # pingouin refuses fewer than five readings. One reading per cell leaves no residual, and it warns.
        if table.size >= 5:
            package = pingouin.intraclass_corr(long(table), "subject", "rater", "value").set_index("Type")
    totals = {
        "icc_2_1": rows + (k - 1) * error + k * (columns - error) / n,
        "icc_3_1": rows + (k - 1) * error,
        "icc_2_k": rows + (columns - error) / n,
    }
    single = formulas["icc_2_1"][1]
    for key, form in ICC.items():
        found = ours[key]
        if found["value"] is None:
            reason = found["undefined"]["code"]
            c.undefined(name, key, reason, reason == "variance_not_positive" and totals[key] <= scale)
            continue
        c.same(name, key, found["value"], formulas[key][0])
        if package is not None:
            c.same(name, f"{key} in pingouin", found["value"], package.loc[form, "ICC"])
        if found["interval_95"] is None:
            turns_over = key == "icc_2_k" and 1.0 + (k - 1) * min(single) <= 1e-9
            # Quantiles of F beyond 1e299: almost zero degrees of freedom, and scipy's bounds exclude the estimate.
            no_freedom = not single[0] <= formulas["icc_2_1"][0] <= single[1]
            c.undefined(name, f"{key} interval", "no_interval", turns_over or no_freedom)
        else:
            c.same(name, f"{key} interval", found["interval_95"], formulas[key][1])
            if package is not None:
                c.same(name, f"{key} interval in pingouin", found["interval_95"], package.loc[form, "CI95"])


def compare_sem(c: Comparison, name: str, ours: dict, squares: tuple, n: int, k: int) -> None:
    """Both SEMs, with their intervals."""
    _, columns, error = squares
    parts = np.array([columns / n, (n - 1) * error / n])
    freedoms = np.array([k - 1, (k - 1) * (n - 1)])
    agreement = parts.sum()
    with np.errstate(all="ignore"):
        satterthwaite = agreement**2 / (parts**2 / freedoms).sum()
    consistency = (error, freedoms[1])
    # The variance between raters is zero if its estimate is negative.
    with_raters = consistency if columns < error else (agreement, satterthwaite)
    cases = {"agreement": with_raters, "consistency": consistency}
    for kind, (variance, freedom) in cases.items():
        found, changes = ours[f"sem_{kind}"], ours[f"mdc95_{kind}"]
        c.same(name, f"sem_{kind}", found["value"], np.sqrt(variance))
        c.same(name, f"mdc95_{kind}", changes["value"], Z * np.sqrt(2.0 * variance))
        if found["interval_95"] is None:
            c.undefined(name, f"sem_{kind} interval", "zero_variance", variance <= 1e-20)
            continue
        bounds = np.sqrt(variance * freedom / stats.chi2.ppf([0.975, 0.025], freedom))
        c.same(name, f"sem_{kind} interval", found["interval_95"], bounds)


def compare_pearson(c: Comparison, name: str, table: np.ndarray, found: dict) -> None:
    """Mean over the pairs, and the interval of a single pair."""
    if found["value"] is None:
        reason = found["undefined"]["code"]
        holds = {"too_few_subjects": len(table) < 3, "zero_variance": np.ptp(table, axis=0).min() == 0.0}
        c.undefined(name, "pearson", reason, holds.get(reason, False))
        return
    pairs = [stats.pearsonr(a, b) for a, b in combinations(table.T, 2)]
    c.same(name, "pearson", found["value"], np.mean([pair.statistic for pair in pairs]))
    if found["interval_95"] is not None:
        c.same(name, "pearson interval", found["interval_95"], pairs[0].confidence_interval())


def compare_limits(c: Comparison, name: str, table: np.ndarray, found: list[dict]) -> None:
    """Bias and limits of every pair, with their intervals."""
    n = len(table)
    for (a, b), pair in zip(combinations(table.T, 2), found, strict=True):
        bias, sd = np.mean(b - a), np.std(b - a, ddof=1)
        limits = np.array([bias - Z * sd, bias + Z * sd])
        c.same(name, "limits of agreement", [pair["bias"], pair["sd"], *pair["limits"]], [bias, sd, *limits])
        if pair["bias_interval_95"] is None:
            c.undefined(name, "limits' intervals", "zero_variance", sd <= 1e-12)
            continue
        half = stats.t.ppf(0.975, n - 1) * sd / np.sqrt(n)
        c.same(name, "bias interval", pair["bias_interval_95"], [bias - half, bias + half])
        bounds = [[limit - np.sqrt(3.0) * half, limit + np.sqrt(3.0) * half] for limit in limits]
        c.same(name, "limits' intervals", pair["limit_intervals_95"], bounds)


if __name__ == "__main__":
    sys.exit(main())
