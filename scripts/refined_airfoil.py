#!/usr/bin/env python3
"""Refines the mesh of cases/naca0012_heave.toml once and twice at the same slabs, and prints what iterations and time do.

    refined_airfoil.py [--slabs N] [--directory DIRECTORY] [--threads N]

The table in Markdown has the iterations of the steady start, those of every slab, and of the slabs after the second one the mean time per unknown.
Needs the program, built by scripts/stsolve; the environment variable STSOLVE names another one.
"""

import argparse
import json
import os
import pathlib
import subprocess
from datetime import datetime

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = os.environ.get("STSOLVE", ROOT / "target/release/stsolve")

# Cells along each line of the generator, and the sizes of cells, of the mesh of the case.
CELLS = {"surface_cells": 15, "wake_cells": 8, "normal_cells": 10, "near_wake.cells": 6, "near_wall.cells": 7}
SIZES = {"first_cell": 0.015, "trailing_edge_cell": 0.02}


def run(factor, output, options):
    """Runs the case on a mesh with `factor` times the cells in each direction."""
    keys = {key: value * factor for key, value in CELLS.items()} | {key: value / factor for key, value in SIZES.items()}
    command = [PROGRAM, "run", ROOT / "cases/naca0012_heave.toml", "--output", output, "--force", "--quiet"]
    command += ["--threads", str(options.threads), "--set", f"time.end={0.1 * options.slabs}"]
    for key, value in keys.items():
        command += ["--set", f"mesh.generate.airfoil.{key}={value}"]
    subprocess.run(command, check=True)


def slabs(output):
    """The Krylov iterations of every slab, and when its last Newton step ended."""
    steps = []
    for line in (output / "log.jsonl").read_text().splitlines():
        record = json.loads(line)
        if record["fields"].get("message") == "Newton step":
            time = datetime.fromisoformat(record["timestamp"].replace("Z", "+00:00"))
            steps.append((record["fields"]["step"], record["fields"]["krylov"], time))
    found = []
    for step, krylov, time in steps:
        if step == 1:
            found.append([0, time])
        found[-1] = [found[-1][0] + krylov, time]
    return found


def row(factor, options):
    output = pathlib.Path(options.directory) / f"times_{factor}"
    run(factor, output, options)
    summary = json.loads((output / "summary.json").read_text())
    found, unknowns = slabs(output), summary["unknowns"]["flow"]
    counts = [krylov for krylov, _ in found[-options.slabs :]]
    seconds = (found[-1][1] - found[-options.slabs + 1][1]).total_seconds() / (options.slabs - 2)
    peak = summary["cost"]["peak_memory_bytes"] / unknowns
    return [
        summary["mesh"]["cells"],
        unknowns,
        summary["steady"]["krylov"],
        ", ".join(map(str, counts)),
        f"{seconds / unknowns * 1e6:.2f}",
        f"{peak:.0f}",
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--slabs", type=int, default=5)
    parser.add_argument("--directory", default=ROOT / "runs/refined_airfoil")
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    head = ["cells", "unknowns", "steady start", "slabs", "microseconds per unknown and slab", "bytes per unknown"]
    print(f"| {' | '.join(head)} |\n|{' --- |' * len(head)}")
    for factor in (1, 2, 4):
        print(f"| {' | '.join(map(str, row(factor, options)))} |", flush=True)


if __name__ == "__main__":
    main()
