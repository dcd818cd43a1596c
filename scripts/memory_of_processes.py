#!/usr/bin/env python3
"""The memory of the processes that share a flow in three dimensions.

    scripts/memory_of_processes.py [CELLS]      cells per direction, default: 24

Runs a slab of cases/taylor_green_3d.toml with 8 blocks on one process and on eight, with a checkpoint and a step of the result, and resumes the run
of eight for another slab. Prints the largest memory of each process, and its part of that of one. Needs a program with MPI: `cargo build --release --features mpi`, or its path in STSOLVE.
Results stay in runs/memory_of_processes.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RUNS = ROOT / "runs/memory_of_processes"
PROGRAM = os.environ.get("STSOLVE", ROOT / "target/release/stsolve")


def peaks(processes, cells, slabs=1):
    """The largest memory of each process, in bytes, in a run up to this number of slabs; it is resumed after the first one."""
    changes = [f"mesh.generate.box.cells=[{cells},{cells},{cells}]", "parallel.blocks=8", f"time.end={0.1 * slabs}", "output.every=1"]
    settings = [word for change in changes for word in ("--set", change)]
    directory = RUNS / str(processes)
    command = [PROGRAM, "run", ROOT / "cases/taylor_green_3d.toml", *settings, "--threads", "1", "--output", directory, "--quiet", "--resume" if slabs > 1 else "--force"]
    subprocess.run(["mpirun", "-n", str(processes), *command], check=True)
    cost = json.loads((directory / "summary.json").read_text())["cost"]
    return cost.get("peak_memory_of_processes", [cost["peak_memory_bytes"]])


def main():
    cells = int(sys.argv[1]) if len(sys.argv) > 1 else 24
    (one,) = peaks(1, cells)
    print(f"one process: {one / 1e6:.0f} MB")
    for slabs, word in ((1, ""), (2, ", resumed")):
        for rank, peak in enumerate(peaks(8, cells, slabs)):
            print(f"process {rank} of 8{word}: {peak / 1e6:.0f} MB, 1/{one / peak:.1f}", flush=True)


main()
