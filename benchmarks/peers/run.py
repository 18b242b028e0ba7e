"""Runs Spineline and other engines on the same cases, one after the other, and prints what they took.

`cargo xtask peers [--rounds N] [--without-octave]` builds what is needed and calls this.

Every engine is a program that is given a case and prints JSON, in a fresh process with one thread. A round is every case,
and for each case every engine in turn, so that a busy minute of the machine meets them all. Octave, which needs minutes,
takes part in the first round only.
"""

import argparse
import datetime
import importlib.util
import json
import os
import platform
import shutil
import subprocess
import sys
from pathlib import Path

import report
import summary

HERE = Path(__file__).resolve().parent
NAMES = ("mild", "severe", "extreme")
PYTHON_ENGINES = {"pinocchio": "pinocchio", "mujoco": "mujoco", "opensim": "opensim", "numpy": "scipy"}
ONE_THREAD = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}


def build_pinocchio_cpp(folder):
    """The C++ program, built against the headers of Pinocchio's wheel, or why it cannot be built.

    Nothing is linked but the header-only templates, so that they are compiled for this very processor.
    """
    found = importlib.util.find_spec("pinocchio")
    if found is None:
        return None, "pinocchio is not installed"
    wheel = next((path for path in Path(found.origin).parents if (path / "include" / "pinocchio").is_dir()), None)
    eigen = next((path for path in (Path("/usr/include/eigen3"), Path("/usr/local/include/eigen3")) if path.is_dir()), None)
    if wheel is None or eigen is None or shutil.which("g++") is None:
        return None, "g++, Eigen's headers or Pinocchio's are missing"
    source, program = HERE / "pinocchio_cpp" / "newton.cpp", folder / "pinocchio-newton"
    if not program.exists() or program.stat().st_mtime < source.stat().st_mtime:
        print("building Pinocchio's C++ program: about a minute", flush=True)
        # Pinocchio's own build has the same two settings of Boost's lists.
        options = "-std=c++17 -O3 -march=native -DNDEBUG -w".split()
        boost = ["-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS"]
        includes = [f"-I{wheel / 'include'}", f"-I{eigen}"]
        built = subprocess.run(["g++", *options, *boost, *includes, source, "-o", program], check=False)
        if built.returncode != 0:
            return None, "it did not compile"
    return program, None


def commands(spineline, folder, with_octave):
    """The program of every engine, and why others have none."""
    found, missing = {"spineline": [spineline, "time"]}, {}
    program, reason = build_pinocchio_cpp(folder)
    if program:
        found["pinocchio C++"] = [program]
    else:
        missing["pinocchio C++"] = reason
    for engine, module in PYTHON_ENGINES.items():
        if importlib.util.find_spec(module):
            found[engine] = [sys.executable, HERE / "peer.py", engine]
        else:
            missing[engine] = "not installed"
    octave = shutil.which("octave")
    if octave and with_octave:
        found["octave"] = [octave, "--no-gui", "--no-init-file", "--quiet", HERE / "octave" / "peer.m"]
    else:
        missing["octave"] = "left out" if octave else "not installed"
    return found, missing


class Broken(Exception):
    """An engine that is there and does not work."""


def run(command, cases, name):
    """What an engine says of one case."""
    ended = subprocess.run(
        [*command, cases, name], capture_output=True, text=True, check=False, env=os.environ | ONE_THREAD
    )
    lines = ended.stdout.strip().splitlines()
    if not lines or not lines[-1].startswith("{"):
        raise Broken((ended.stderr.strip().splitlines() or [f"it ended with {ended.returncode}"])[-1])
    return json.loads(lines[-1])


def machine():
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        return next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def rounds(engines, missing, cases, count):
    """All answers; an engine that does not work joins the missing ones, but for Spineline."""
    answers = []
    for turn in range(count):
        for name in NAMES:
            for engine, command in list(engines.items()):
                if engine == "octave" and turn > 0:
                    continue
                print(f"round {turn + 1}, {name}: {engine}", flush=True)
                try:
                    answers.append(run(command, cases, name))
                except Broken as reason:
                    if engine == "spineline":
                        raise SystemExit(f"spineline failed on {name}: {reason}") from reason
                    missing[engine] = f"does not work here: {reason}"
                    del engines[engine]
    return [answer for answer in answers if answer["engine"] not in missing]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, required=True, help="spineline-peers, built in release")
    parser.add_argument("--out", type=Path, required=True, help="folder of the results")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--without-octave", action="store_true")
    arguments = parser.parse_args()
    spineline, folder = arguments.program, arguments.out
    folder.mkdir(parents=True, exist_ok=True)
    cases = folder / "cases.json"
    subprocess.run([spineline, "cases", cases], check=True)
    engines, missing = commands(spineline, folder, not arguments.without_octave)
    answers = rounds(engines, missing, cases, arguments.rounds)
    truth = {case["name"]: case["multipliers"] for case in json.loads(cases.read_text(encoding="utf-8"))["cases"]}
    results = {
        "machine": machine(),
        "cores": os.cpu_count(),
        "date": datetime.date.today().isoformat(),
        "python": platform.python_version(),
        "missing": missing,
        "answers": answers,
    }
    (folder / "results.json").write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    text = report.write(results, truth, NAMES)
    (folder / "results.md").write_text(text, encoding="utf-8")
    short = summary.write(results, truth)
    (folder / "summary.md").write_text(short, encoding="utf-8")
    print(f"\n{text}\n{short}")
    print(f"written to {folder}")


if __name__ == "__main__":
    main()
