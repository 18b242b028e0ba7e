"""The short table: one row per task, one column per engine, medians over the cases."""

from statistics import median

import report

ROWS = {
    "equilibrium": "One equilibrium under a line; Spineline: explicit march",
    "equilibrium_near": "The same by general Newton, from that at 95 % of the force",
    "amplitude": "The smallest force that gives a lean",
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
WAYS = ("usual", "tuned")


def over_cases(by_case):
    """Median over the cases in which the result is right, and how many those are."""
    right = [value for value in by_case.values() if not isinstance(value, str)]
    return (median(right) if right else None), len(right)


def fastest(cells, task, engine, way):
    """Of an engine's rows that were done one way: the one right in most cases, and of those the fastest."""
    found = [
        over_cases(by_case)
        for (of_task, of_engine, method), by_case in cells.items()
        if (of_task, of_engine) == (task, engine) and method.startswith(way)
    ]
    return min(found, key=lambda one: (-one[1], one[0] or 0.0), default=None)


def part(found, own, cases):
    """A time, its ratio, and what is not right."""
    if found is None:
        return None
    seconds, right = found
    if seconds is None:
        return "wrong"
    text = f"{report.seconds_text(seconds)} ({report.ratio_text(seconds / own)})"
    return text if right == cases else f"{text}, right in {right} of {cases}"


def cell(cells, task, engine, missing, cases):
    if engine in missing:
        return missing[engine].split(":")[0] if task in report.TASKS_OF.get(engine, ROWS) else "-"
    own, _ = over_cases(report.own_times(cells, task))
    if engine == "spineline":
        return report.seconds_text(own)
    parts = [part(fastest(cells, task, engine, way), own, cases) for way in WAYS]
    if parts == [None, None]:
        parts = [part(fastest(cells, task, engine, ""), own, cases)]
    return " / ".join(one for one in parts if one) or "-"


def write(results, truth, names):
    """The table as Markdown, with machine and date, and what each engine could not do."""
    cells = report.gather(results["answers"], truth)
    head = ["", *ENGINES.values()]
    lines = [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}"]
    for task, label in ROWS.items():
        row = [cell(cells, task, engine, results["missing"], len(names)) for engine in ENGINES]
        lines.append(f"| {' | '.join([label, *row])} |")
    lines += [
        "",
        "Time, and in brackets how many times Spineline's: usual / tuned. Medians over the cases in which the result is right.",
        f"Machine: {results['machine']}, {results['cores']} cores; one thread.",
        f"Date: {results['date']}.",
        "",
        "What the engines could not do:",
        "",
        *report.cannot(results),
    ]
    return "\n".join(lines) + "\n"
