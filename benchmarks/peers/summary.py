"""The short table: one row per task, one column per engine, medians over the cases."""

from statistics import median

import report

ROWS = {
    "equilibrium": "One equilibrium under a line; Spineline: explicit march",
    "equilibrium_near": "The same by general Newton, from that at 95 % of the force",
    "amplitude": "The smallest force that gives a lateral tilt",
    "personalisation": "Personalisation from two bends",
}
ENGINES = {
    "spineline": "Spineline",
    "pinocchio C++": "Pinocchio (C++)",
    "pinocchio": "Pinocchio",
    "mujoco": "MuJoCo",
    "opensim": "OpenSim",
    "numpy": "numpy (Python)",
    "octave": "Octave",
}


def over_cases(by_case, own):
    """Median over the cases in which the result is right, its ratio to Spineline's in the same cases, and their number."""
    right = [case for case, value in by_case.items() if not isinstance(value, str)]
    if not right:
        return None, None, 0
    seconds = median(by_case[case] for case in right)
    return seconds, seconds / median(own[case] for case in right), len(right)


def part(cells, task, engine, way):
    """Of an engine's rows that were done one way, the one right in most cases, and of those the fastest."""
    own = report.own_times(cells, task)
    found = [
        over_cases(by_case, own)
        for (of_task, of_engine, method), by_case in cells.items()
        if (of_task, of_engine) == (task, engine) and method.startswith(way)
    ]
    if not found:
        return None
    seconds, ratio, right = min(found, key=lambda one: (-one[2], one[0] or 0.0))
    if seconds is None:
        return "wrong"
    text = f"{report.seconds_text(seconds)} ({report.ratio_text(ratio)})"
    return text if right == len(own) else f"{text}, right in {right} of {len(own)}"


def cell(cells, task, engine, missing):
    if engine in missing:
        return missing[engine].split(":")[0] if task in report.TASKS_OF.get(engine, ROWS) else "-"
    if engine == "spineline":
        return report.seconds_text(median(report.own_times(cells, task).values()))
    parts = [part(cells, task, engine, way) for way in report.WAYS]
    if parts == [None, None]:
        parts = [part(cells, task, engine, "")]
    return " / ".join(one for one in parts if one) or "-"


def write(results, truth):
    """The table as Markdown, with machine and date, and what each engine could not do."""
    cells = report.gather(results["answers"], truth)
    head = ["", *ENGINES.values()]
    lines = [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}"]
    for task, label in ROWS.items():
        row = [cell(cells, task, engine, results["missing"]) for engine in ENGINES]
        lines.append(f"| {' | '.join([label, *row])} |")
    lines += [
        "",
        "Time, and in brackets how many times Spineline's: usual / tuned. Medians over the cases in which the result is right.",
        "Where the usual fit is wrong, the published method is, whichever the engine: see the README of this comparison.",
        f"Machine: {results['machine']}, {results['cores']} cores; one thread.",
        f"Date: {results['date']}.",
        "",
        "What the engines could not do:",
        "",
        *report.cannot(results),
    ]
    return "\n".join(lines) + "\n"
