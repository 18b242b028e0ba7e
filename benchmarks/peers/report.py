"""Tables from what the engines said: agreement first, then medians over the rounds and ratios to Spineline."""

from statistics import median

TASKS = {
    "equilibrium": "One equilibrium, from the erect spine",
    "equilibrium_near": "One equilibrium, from that at 95 % of the force",
    "amplitude": "The smallest positive force that gives a lateral tilt",
    "personalisation": "Personalisation: three multipliers and two forces from two bends",
}
TASKS_OF = {"pinocchio C++": ("equilibrium", "equilibrium_near")}
WAYS = ("usual", "tuned")
MIDPOINT_MM = 1e-6
MIDPOINT_MM_OF = {"opensim": 1e-3}
FORCE = 1e-6  # relative
MULTIPLIER = 1e-4


def largest(ours, theirs):
    """The largest difference between two nested lists of numbers."""
    if isinstance(ours, list):
        return max(largest(a, b) for a, b in zip(ours, theirs, strict=True))
    return abs(ours - theirs)


def fault(row, engine, reference, truth):
    """Why a row's time does not count, or None."""
    if "failed" in row:
        return f"failed: {row['failed']}"
    if row["task"] == "personalisation":
        off = largest(row["multipliers"], truth)
        return f"multipliers off by {off:.1e}" if not off < MULTIPLIER else None
    if "midpoints_mm" in row:
        off = largest(row["midpoints_mm"], reference["midpoints_mm"])
        return f"disagrees by {off:.1e} mm" if not off < MIDPOINT_MM_OF.get(engine, MIDPOINT_MM) else None
    off = max(abs(theirs / ours - 1.0) for ours, theirs in zip(reference["forces_n"], row["forces_n"], strict=True))
    return f"disagrees by {off:.1e} of the force" if not off < FORCE else None


def reference_of(answers, case, task):
    """Spineline's first row; for both equilibria that is the march's."""
    task = "equilibrium" if task == "equilibrium_near" else task
    rows = (row for a in answers if (a["engine"], a["case"]) == ("spineline", case) for row in a["rows"])
    return next(row for row in rows if row["task"] == task)


def way_of(method):
    """Usual or tuned, where a method says so."""
    return next((way for way in WAYS if method.startswith(way)), "")


def agreement(answers, truth):
    """Per engine and way, the largest disagreements with Spineline's midpoints and with the true multipliers."""
    lines = ["## Agreement", "", "| engine | midpoints, mm | multipliers |", "|---|---|---|"]
    off = {}
    for answer in answers:
        for row in answer["rows"]:
            ours = reference_of(answers, answer["case"], row["task"]) | {"multipliers": truth[answer["case"]]}
            found = off.setdefault((answer["engine"], way_of(row["method"])), {"midpoints_mm": [], "multipliers": []})
            for what in found.keys() & row.keys():
                found[what].append(largest(ours[what], row[what]))
    for (engine, way), found in off.items():
        cells = (f"{max(values):.0e}" if values else "-" for values in found.values())
        lines.append(f"| {engine}{', ' if way else ''}{way} | {' | '.join(cells)} |")
    return lines + [""]


def gather(answers, truth):
    """(task, engine, method) → case → median seconds over the rounds, or a fault."""
    cells = {}
    for answer in answers:
        engine, case = answer["engine"], answer["case"]
        for row in answer["rows"]:
            problem = fault(row, engine, reference_of(answers, case, row["task"]), truth[case])
            key = (row["task"], engine, row["method"])
            cells.setdefault(key, {}).setdefault(case, []).append(problem or row["seconds"])
    return {
        key: {case: next((v for v in values if isinstance(v, str)), None) or median(values) for case, values in by_case.items()}
        for key, by_case in cells.items()
    }


def seconds_text(seconds):
    for factor, unit in ((1e6, "µs"), (1e3, "ms")):
        if seconds * factor < 1000:
            return f"{seconds * factor:.3g} {unit}"
    return f"{seconds:.3g} s"


def own_times(cells, task):
    """Spineline's times: its first row of a task, so that from a nearby start Newton is compared with Newton."""
    return next(by_case for (t, engine, _), by_case in cells.items() if (t, engine) == (task, "spineline"))


def ratio_text(ratio):
    return f"{ratio:.1f}×" if ratio < 10 else f"{ratio:,.0f}×"


def cell_text(value, own, engine):
    if isinstance(value, str):
        return value
    ratio = "" if engine == "spineline" else f" ({ratio_text(value / own)})"
    return seconds_text(value) + ratio


def table(cells, task, names, missing):
    lines = [f"## {TASKS[task]}", "", f"| engine | method | {' | '.join(names)} |", f"|---|---|{'---|' * len(names)}"]
    own = own_times(cells, task)
    for (of_task, engine, method), by_case in cells.items():
        if of_task == task:
            values = " | ".join(cell_text(by_case[name], own[name], engine) for name in names)
            lines.append(f"| {engine} | {method} | {values} |")
    for engine, reason in missing.items():
        if task in TASKS_OF.get(engine, TASKS):
            lines.append(f"| {engine} | {reason} | {' | '.join('-' for _ in names)} |")
    return lines + [""]


def least_ratios(cells, task, engines, names, methods=""):
    """Per case, how many times longer than Spineline the fastest of some engines takes."""
    own = own_times(cells, task)
    ratios = []
    for name in names:
        times = [
            by_case[name]
            for (of_task, engine, method), by_case in cells.items()
            if of_task == task and engine in engines and methods in method and not isinstance(by_case[name], str)
        ]
        ratios.append(f"{ratio_text(min(times) / own[name])}" if times else "none")
    return ", ".join(ratios)


def ratios(cells, names):
    python = ("pinocchio", "mujoco", "opensim", "numpy")
    both = "tuned: multipliers and forces together; "
    lines = [
        ("personalisation, fastest engine from Python, usual", "personalisation", python, "usual"),
        ("personalisation, fastest engine from Python, tuned, nominal start", "personalisation", python, f"{both}nominal"),
        ("personalisation, fastest engine from Python, tuned, start given", "personalisation", python, f"{both}closed-form"),
        ("personalisation, Octave, nominal start", "personalisation", ("octave",), "nominal"),
        ("personalisation, Octave, start given", "personalisation", ("octave",), "closed-form"),
        ("Newton from a nearby start against Pinocchio's C++ kernels, usual", "equilibrium_near", ("pinocchio C++",), "usual"),
        ("Newton from a nearby start against Pinocchio's C++ kernels, tuned", "equilibrium_near", ("pinocchio C++",), "tuned"),
        ("march against Pinocchio's C++ kernels, usual", "equilibrium", ("pinocchio C++",), "usual"),
        ("march against Pinocchio's C++ kernels, tuned", "equilibrium", ("pinocchio C++",), "tuned"),
    ]
    head = ["## How many times Spineline's time", "", f"In the order {', '.join(names)}.", ""]
    return head + [f"- {what}: {least_ratios(cells, t, e, names, m)}" for what, t, e, m in lines] + [""]


def cannot(results):
    """What each engine could not do, and which engines there were not."""
    said = {(a["engine"], a["version"]): a.get("cannot", []) for a in results["answers"]}
    lines = [
        f"- {engine} {version}" + (": " + "; ".join(faults) if faults else "") for (engine, version), faults in said.items()
    ]
    return lines + [f"- {engine}: {reason}" for engine, reason in results["missing"].items()]


def write(results, truth, names):
    """The report as Markdown."""
    answers = results["answers"]
    cells = gather(answers, truth)
    lines = ["# Spineline and other engines on the same cases", ""]
    lines += [f"{results['machine']}, Python {results['python']}, one thread. Medians; in brackets the ratio to Spineline.", ""]
    lines += agreement(answers, truth)
    for task in TASKS:
        lines += table(cells, task, names, results["missing"])
    lines += ratios(cells, names)
    lines += ["## What the engines could not do", ""]
    lines += cannot(results)
    return "\n".join(lines) + "\n"
