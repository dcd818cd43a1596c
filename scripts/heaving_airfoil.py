#!/usr/bin/env python3
"""Runs the heaving airfoil on meshes and in steps of several sizes, and prints what comes out as a table in Markdown.

    heaving_airfoil.py [--only NAME]... [--directory DIRECTORY] > docs/heaving_airfoil.md

Without --only all settings run, coarse to fine, for some ten minutes. A setting whose results are in DIRECTORY (default:
runs/heaving_airfoil) already is not run again. Needs the program, built by scripts/stsolve.
"""

import argparse
import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
CASE = ROOT / "cases" / "naca0012_heave.toml"

# The workshop's reference: University of California, Berkeley, 63,632 quadrilaterals of degree 3, 800 steps.
IMPULSE, WORK = -2.369197, -1.657725

# Published results at the same motion: who, nodes, steps, errors of impulse and work, cost.
PUBLISHED = [
    ("Michigan, triangles of degree 2", 11_778, "64 ESDIRK5", 5.8e-4, 5.2e-4, "7,582 CPU s"),
    ("Berkeley, quadrilaterals of degree 3", 67_712, "400 DIRK3", 2.7e-4, 1.9e-4, ""),
    ("Michigan, triangles of degree 3", 77_810, "64 ESDIRK5", 2.5e-5, 1.2e-5, ""),
]

# Cells along a side, along the wake and outwards; height of the first cell and length of the last before the trailing edge.
MESHES = {
    "coarse": (8, 6, 10, 0.02, 0.03),
    "medium": (12, 8, 12, 0.015, 0.02),
    "fine": (16, 12, 14, 0.012, 0.015),
}

# Mesh, order in space N_s, order in time N_t, step.
SETTINGS = [
    ("coarse", 4, 3, 0.1),
    ("coarse", 5, 3, 0.1),
    ("medium", 3, 3, 0.1),
    ("medium", 4, 3, 0.1),
    ("medium", 5, 2, 0.1),
    ("medium", 5, 2, 0.05),
    ("medium", 5, 3, 0.2),
    ("medium", 5, 3, 0.1),
    ("medium", 5, 3, 0.05),
    ("medium", 6, 3, 0.1),
    ("fine", 5, 3, 0.1),
    ("fine", 6, 3, 0.1),
]


def name_of(setting):
    mesh, order, time_order, step = setting
    return f"{mesh}_{order}_{time_order}_{step}"


def keys_of(setting):
    mesh, order, time_order, step = setting
    generator = dict(zip(("surface_cells", "wake_cells", "normal_cells", "first_cell", "trailing_edge_cell"), MESHES[mesh]))
    keys = {f"mesh.generate.airfoil.{key}": value for key, value in generator.items()}
    return keys | {"mesh.order": order, "flow.order": order, "time.order": time_order, "time.step": step}


def summary_of(setting, directory):
    """The summary of a setting, which is run if it has not been."""
    output = directory / name_of(setting)
    summary = output / "summary.json"
    if not (summary.exists() and json.loads(summary.read_text())["completed"]):
        changes = [word for key, value in keys_of(setting).items() for word in ("--set", f"{key}={value}")]
        command = [ROOT / "target/release/stsolve", "run", CASE, "--output", output, "--quiet", *changes]
        print(name_of(setting), file=sys.stderr)
        subprocess.run(command, check=True)
    return json.loads(summary.read_text())


def error(value, reference):
    return f"{abs(value / reference - 1):.1e}"


def row_of(setting, summary):
    mesh, order, time_order, step = setting
    wall, cells = summary["walls"]["airfoil"], summary["mesh"]["cells"]
    impulse, work = wall["impulse"][1], wall["work"]
    return (mesh, cells, order, f"{cells * order**2:,}", time_order, step, f"{impulse:.6f}", f"{work:.6f}",
            error(impulse, IMPULSE), error(work, WORK), f"{summary['steady']['walls']['airfoil']['drag_coefficient']:.6f}",
            f"{summary['newton']['per_slab']:.1f}", f"{summary['krylov']['total'] / summary['slabs']:.1f}",
            f"{summary['cost']['wall_seconds']:.0f}", f"{summary['cost']['peak_memory_bytes'] / 1e6:.0f}")


def table(head, rows):
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(str(entry) for entry in line) + " |" for line in lines)


def page(rows):
    head = ("mesh", "cells", "N_s", "nodes", "N_t", "step", "I", "W", "error of I", "error of W", "steady C_d", "Newton",
            "Krylov", "seconds", "MB")
    published = [(who, f"{nodes:,}", steps, f"{i:.1e}", f"{w:.1e}", cost) for who, nodes, steps, i, w, cost in PUBLISHED]
    return f"""# The heaving airfoil: convergence

Made by `scripts/heaving_airfoil.py` from `cases/naca0012_heave.toml`. I is the vertical impulse of the fluid on the airfoil, W its
work; errors are relative to the reference of the workshop, I = {IMPULSE}, W = {WORK}. Newton steps and Krylov
iterations are means over the slabs; seconds are those of the whole run, steady start included.

{table(head, rows)}

Published, same case:

{table(("who", "nodes", "steps", "error of I", "error of W", "cost"), published)}
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", action="append", help="the name of a setting, such as medium_5_3_0.1")
    parser.add_argument("--directory", type=pathlib.Path, default=ROOT / "runs" / "heaving_airfoil")
    arguments = parser.parse_args()
    chosen = [setting for setting in SETTINGS if not arguments.only or name_of(setting) in arguments.only]
    print(page([row_of(setting, summary_of(setting, arguments.directory)) for setting in chosen]), end="")


if __name__ == "__main__":
    main()
