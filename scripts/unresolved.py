#!/usr/bin/env python3
"""Runs flows that the mesh does not resolve with several treatments, and prints how long each lives as a table in Markdown.

    unresolved.py [--only WORD]... [--treatment WORD]... [--directory DIRECTORY] [--threads N] [--must-live]

WORD selects the flows, or the treatments, whose name contains it. Needs the program, built by scripts/stsolve; the environment variable
STSOLVE names another one. With --must-live the exit code is 1 if a run does not reach its end.
"""

import argparse
import csv
import json
import pathlib
import shutil
import subprocess
import sys

from starts import CASE
from steady_starts import PROGRAM, ROOT, channel

TAYLOR_GREEN = ROOT / "cases/taylor_green_3d.toml"
BLADE = ROOT / "cases/turbine_blade.toml"
NOTHING = "output.fields=[]"
BOX = "mesh.generate.box.cells=[{0},{0},{0}]".format


def taylor_green(cells, order, *more):
    return TAYLOR_GREEN, [BOX(cells), f"flow.order={order}", "output.every=1000", NOTHING, *more]


def blade(order):
    return BLADE, [f"flow.order={order}", "flow.gas.viscosity.constant=2e-5", "time.end=6", "output.every=1000", NOTHING]


# Gas that fills a channel suddenly, at Re = 20,000 by its height. The case is written beside its results.
CHANNEL = CASE.format(title="channel", order=4, step=0.05, more="", **channel(2e4, 0.3))


FLOWS = {
    "Taylor-Green Re = 1600, 4^3 cells, N = 6": taylor_green(4, 6),
    "Taylor-Green Re = 1600, 2^3 cells, N = 8": taylor_green(2, 8),
    "Taylor-Green inviscid, 4^3 cells, N = 4": taylor_green(4, 4, "flow.gas={gamma=1.4}"),
    "Kelvin-Helmholtz, 16^2 cells, N = 4": (ROOT / "cases/kelvin_helmholtz.toml", ["output.every=1000", NOTHING]),
    "blade Re = 50,000, N = 3": blade(3),
    "blade Re = 50,000, N = 5": blade(5),
    "channel Re = 20,000, N = 4": (CHANNEL, ["time.end=8", "output.every=1000"]),
}

# The keys that every treatment sets: quadrature and volume flux, so that those of a case do not matter.
def points(quadrature, volume_flux):
    return [f'flow.quadrature="{quadrature}"', f'flow.volume_flux="{volume_flux}"']


NO_FALLBACK = 'solver.fallback="none"'

TREATMENTS = {
    "defaults": points("conserving", "central"),
    "conserving": [*points("conserving", "central"), NO_FALLBACK],
    "three_halves": [*points("three_halves", "central"), NO_FALLBACK],
    "nodes, kinetic_energy": points("collocated_lobatto", "kinetic_energy"),
    "nodes, entropy": points("collocated_lobatto", "entropy"),
    "nodes, viscosity": [*points("collocated_lobatto", "entropy_viscosity"), NO_FALLBACK],
}


def total(history, column):
    """The sum of a column of history.csv."""
    with history.open() as rows:
        return sum(int(float(row[column])) for row in csv.DictReader(rows))


def run(flow, treatment, arguments):
    """The row of one run, and whether it reached its end."""
    case, changes = FLOWS[flow]
    place = arguments.directory / "".join(c if c.isalnum() else "_" for c in f"{flow} {treatment}")
    shutil.rmtree(place, ignore_errors=True)
    place.parent.mkdir(parents=True, exist_ok=True)
    if isinstance(case, str):
        text, case = case, place.with_suffix(".toml")
        case.write_text(text)
    changes = [part for change in [*changes, *TREATMENTS[treatment]] for part in ("--set", change)]
    command = [PROGRAM, "run", case, "--output", place, "--threads", str(arguments.threads), "-q", *changes]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    place.with_suffix(".out").write_text(done.stdout + done.stderr)
    if not (place / "summary.json").exists():
        return f"{flow} | {treatment} | {(done.stderr.splitlines() or ['no message'])[-1]} | | | | ", False
    summary = json.loads((place / "summary.json").read_text())
    lives = "lives to" if summary["completed"] else "dies at"
    builds = total(place / "history.csv", "preconditioner_builds")
    counts = f"{summary['slabs']} | {summary['rejected_slabs']} | {summary['newton']['max']} | {builds}"
    return f"{flow} | {treatment} | {lives} {summary['time']:.3f} | {counts} | {summary['cost']['wall_seconds']:.0f}", summary["completed"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--treatment", action="append", default=[])
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--directory", type=pathlib.Path, default=ROOT / "runs/unresolved")
    parser.add_argument("--must-live", action="store_true")
    arguments = parser.parse_args()
    chosen = lambda name, words: not words or any(word in name for word in words)
    print("| flow | treatment | end | slabs | rejected | most Newton steps | preconditioners | seconds |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    all_live = True
    for flow in (flow for flow in FLOWS if chosen(flow, arguments.only)):
        for treatment in (name for name in TREATMENTS if chosen(name, arguments.treatment)):
            row, lives = run(flow, treatment, arguments)
            all_live &= lives
            print(f"| {row} |", flush=True)
    sys.exit(1 if arguments.must_live and not all_live else 0)


if __name__ == "__main__":
    main()
