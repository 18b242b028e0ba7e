"""Times cohorts of synthetic patients: the program alone, and the Python package on Dask, in one run.

`cargo xtask cohorts [--cases N] [--patients N] [--replicates N] [--rows N] [--workers N]...` builds what is needed and calls this.

Rounds alternate between program and Dask, so that a busy minute of the machine meets both. It tests nothing.
"""

import argparse
import json
import os
import shutil
import statistics
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import spineline as sl
from distributed import Client, LocalCluster

SUBJECTS = 18
ROUNDS = 3
# Synthetic patients that differ: one takes 60 ms to make.
DISTINCT = 1_800


def synthetic_patients(program, folder, count):
    """Cases of synthetic patients, 18 of every seed, as they are read from their files."""
    seeds = range(1, -(-count // SUBJECTS) + 1)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        outs = [folder / f"seed-{seed}" for seed in seeds]
        words = [[program, "phantom", "--seed", str(seed), "--out", out] for seed, out in zip(seeds, outs)]
        list(pool.map(lambda command: subprocess.run(command, check=True, capture_output=True), words))
    files = sorted(file for out in outs for file in out.glob("*.json") if not file.name.endswith(".truth.json"))
    return [json.loads(file.read_text(encoding="utf-8")) for file in files[:count]]


def with_moved_corner(reading, hundredths):
    """The reading with one corner moved by hundredths of a pixel: a cohort refuses a patient with the landmarks of another one."""
    base = reading["vertebrae"]["L4"]
    column, row = base["superior_left"]
    moved = base | {"superior_left": [column + hundredths / 100, row]}
    return reading | {"vertebrae": reading["vertebrae"] | {"L4": moved}}


def write_cases(patients, folder, count, readings=None):
    """Case files in one folder: the patients again and again under other names; with fewer readings where asked."""
    folder.mkdir(parents=True)
    paths = [folder / f"patient-{number:06}.json" for number in range(1, count + 1)]
    for number, path in enumerate(paths):
        case = patients[number % len(patients)] | {"case_id": path.stem}
        again = number // len(patients)
        films = [
            film | {"readings": [with_moved_corner(one, again) for one in film["readings"][:readings]]}
            for film in case["films"]
        ]
        path.write_text(json.dumps(case | {"films": films}), encoding="utf-8")
    return paths


def timed(command):
    """Seconds and largest resident memory, in MB, of a command."""
    start = time.perf_counter()
    running = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    largest = 0.0
    while running.poll() is None:
        largest = max(largest, resident_mb(running.pid))
        time.sleep(0.01)
    if running.returncode != 0:
        raise SystemExit(f"{' '.join(map(str, command))} ended with {running.returncode}")
    return time.perf_counter() - start, largest


def resident_mb(process="self"):
    """Largest resident memory of a process so far, in MB; 0 once it has ended."""
    try:
        lines = Path(f"/proc/{process}/status").read_text(encoding="utf-8").splitlines()
    except OSError:
        return 0.0
    return next((int(line.split()[1]) / 1024 for line in lines if line.startswith("VmHWM")), 0.0)


def by_program(program, cases, out, threads, replicates=None):
    """The program on cases or a folder of them, with the same tables as the package writes."""
    shutil.rmtree(out, ignore_errors=True)
    tables = ["--tables", out, "--tables-format", "parquet"]
    more = [] if replicates is None else ["--replicates", str(replicates), "--seed", "1"]
    return timed([program, "analyze", *cases, "--threads", str(threads), *tables, *more])


def by_dask(client, cases, out, chunk=100, replicates=None):
    """The package on a cluster that has started."""
    shutil.rmtree(out, ignore_errors=True)
    start = time.perf_counter()
    run = sl.Cohort(cases).analyze(out=out, executor=client.get_executor(), chunk=chunk, replicates=replicates)
    seconds = time.perf_counter() - start
    if not run.is_complete:
        raise SystemExit(f"{len(run.lost)} tasks were lost")
    return seconds, max(client.run(resident_mb).values())


def compare(measure_program, measure_dask):
    """Medians of both over the rounds, one after the other."""
    rounds = [(measure_program(), measure_dask()) for _ in range(ROUNDS)]
    return [statistics.median(one[side] for one in rounds) for side in (0, 1)]


def with_workers(program, cases, folder, workers, asked):
    """Rows of the table for a number of workers, and the seconds of one replicate on one of them."""
    with LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        memory = {"program": 0.0, "dask": 0.0}

        def alone():
            seconds, memory["program"] = by_program(program, [folder / "cases"], folder / "alone", workers)
            return seconds

        def on_dask():
            seconds, memory["dask"] = by_dask(client, cases, folder / "dask")
            return seconds

        # Workers import the package before the clock starts.
        client.run(resident_mb)
        by_dask(client, cases[:200], folder / "first")
        whole = compare(alone, on_dask)
        patients = cases[: asked.patients]
        repeated = [
            by_program(program, patients, folder / "alone", workers, asked.replicates)[0],
            by_dask(client, patients, folder / "dask", 1, asked.replicates)[0],
        ]
    print(row(f"{len(cases)} patients, {workers} {'core' if workers == 1 else 'cores'}", whole, memory), flush=True)
    print(row(f"{len(patients)} patients × {asked.replicates} replicates, {workers} {'core' if workers == 1 else 'cores'}", repeated, None), flush=True)
    return workers * repeated[1] / (len(patients) * asked.replicates)


def row(what, seconds, memory):
    alone, dask = seconds
    resident = f"{memory['program']:.0f} / {memory['dask']:.0f}" if memory else "-"
    return f"| {what} | {alone:.1f} | {dask:.1f} | {100 * (dask / alone - 1):+.1f} % | {resident} |"


def cost(seconds_per_replicate, patients=100_000, replicates=10_000, cores=64):
    """What a large study costs where every core is as fast as here and none waits for another."""
    core_hours = seconds_per_replicate * patients * replicates / 3600
    return (
        f"{patients} patients × {replicates} replicates at {1e3 * seconds_per_replicate:.2f} ms each: "
        f"{core_hours:.0f} core-hours, {core_hours / cores:.1f} hours on {cores} cores"
    )


def main():
    words = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    words.add_argument("--program", type=Path, required=True)
    words.add_argument("--out", type=Path, required=True)
    words.add_argument("--cases", type=int, default=10_000, help="patients without replicates")
    words.add_argument("--patients", type=int, default=200, help="patients with replicates")
    words.add_argument("--replicates", type=int, default=1000, help="replicates of each of them")
    words.add_argument("--rows", type=int, default=100_000, help="patients of the run that shows the memory; 0: none")
    words.add_argument("--workers", type=int, nargs="+", default=[1, 2], help="cores, one row each")
    asked = words.parse_args()
    patients = synthetic_patients(asked.program, asked.out / "patients", min(asked.cases, DISTINCT))
    cases = write_cases(patients, asked.out / "cases", asked.cases)
    print(f"{len(patients)} synthetic patients, repeated under other names; five films with six readings each; medians of {ROUNDS} rounds in s; replicates once\n")
    print("| | program | package on Dask | Dask over program | memory, MB: program / a worker |")
    print("|---|---|---|---|---|", flush=True)
    each = [with_workers(asked.program, cases, asked.out, workers, asked) for workers in asked.workers]
    if asked.rows:
        more = asked.out / "more"
        shutil.rmtree(asked.out / "cases")
        write_cases(patients, more, asked.rows, readings=1)
        seconds, memory = by_program(asked.program, [more], asked.out / "alone", 2)
        print(f"| {asked.rows} patients with one reading, 2 cores | {seconds:.1f} | - | - | {memory:.0f} / - |")
    print(f"\n{cost(each[-1])}")


if __name__ == "__main__":
    main()
