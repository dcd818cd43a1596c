#!/usr/bin/env python3
"""Memory and time of one slab of two large wings: 20384 cells of order 4, and 2002 cells of order 8.

    scripts/large_wings.py [4] [8]        default: both

Runs cases/naca0012_wave.toml from uniform flow with other cells. Prints the unknowns of the slab, Krylov iterations, seconds and the memory of the
whole process, with its bytes per unknown and the estimate of `stsolve check`. Results stay in runs/large_wings.
"""

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RUNS = ROOT / "runs/large_wings"
CASE = ROOT / "cases/naca0012_wave.toml"

COMMON = {"mesh.order": 2, "solver.krylov_restart": 12}
AIRFOIL = {
    "surface_cells": 14,
    "wake_cells": 12,
    "normal_cells": 14,
    "near_wake.cells": 6,
    "near_wall.cells": 8,
}
WINGS = {
    "4": {
        "flow.order": 4,
        "mesh.extrude.layers": 28,
        "time.step": 0.05,
        "time.end": 0.05,
        **{f"mesh.generate.airfoil.{key}": value for key, value in AIRFOIL.items()},
    },
    "8": {"flow.order": 8, "mesh.extrude.layers": 11, "time.step": 0.02, "time.end": 0.02},
}


def stsolve(*words):
    """Runs the program; returns its standard output."""
    done = subprocess.run([ROOT / "scripts/stsolve", *words], check=True, stdout=subprocess.PIPE, text=True)
    return done.stdout


def measure(order):
    """Runs the wing of an order and tells what it took."""
    case, output = RUNS / f"wing_{order}.toml", RUNS / f"wing_{order}"
    # The search for the steady flow is left out: the slab alone is measured.
    case.write_text(CASE.read_text().replace("[solver.steady]\n", ""))
    sets = [word for key, value in (COMMON | WINGS[order]).items() for word in ("--set", f"{key}={value}")]
    check = json.loads(stsolve("check", case, "--json", "--probe", "never", *sets))
    stsolve("run", case, "--output", output, "--force", "--quiet", *sets)
    summary = json.loads((output / "summary.json").read_text())
    unknowns, memory = summary["unknowns"]["flow"], summary["cost"]["peak_memory_bytes"]
    estimate = 1e6 * check["unknowns and memory"]["memory of a run"]
    print(
        f"N = {order}: {unknowns} unknowns, {summary['krylov']['total']} Krylov iterations, "
        f"{summary['cost']['wall_seconds']:.0f} s, {1e-6 * memory:.0f} MB, {memory / unknowns:.0f} bytes per unknown "
        f"(estimated {estimate / unknowns:.0f})",
        flush=True,
    )


def main():
    RUNS.mkdir(parents=True, exist_ok=True)
    for order in sys.argv[1:] or WINGS:
        measure(order)


if __name__ == "__main__":
    main()
