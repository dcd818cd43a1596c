#!/usr/bin/env python3
"""Starts twelve flows at once from a uniform state, without a steady start, and prints the results as a table in Markdown.

    starts.py [--only WORD]... [--set KEY=VALUE]... [--directory DIRECTORY] [--threads N] [--order N]

WORD selects the flows whose name contains it. Every flow must reach t = 0.5, and may waste at most 30 % of its Jacobian products on
slabs that are rejected. Needs the program, built by scripts/stsolve; the environment variable STSOLVE names another one.
Exit code 1 if a flow falls short of either.
"""

import argparse
import json
import pathlib
import shutil
import subprocess
import sys

from steady_starts import HEAD, PROGRAM, ROOT, airfoil, channel, external, generator, passage

CASE = (
    HEAD
    + """[time]
order = 2
end = 0.5
step = {step}
[solver]
newton_tolerance = 1e-4
[output]
fields = []
"""
)

MOST_WASTED = 0.3


def wing_section(reynolds, mach, degrees):
    return external(airfoil(0.5 * min(0.02, reynolds**-0.5)), "{ adiabatic_wall = {} }", mach, reynolds, degrees)


def cylinder(reynolds, mach):
    first = min(0.1, 2 * reynolds**-0.5)
    mesh = generator(f"annulus = {{ inner_radius = 0.5, outer_radius = 50, first_cell = {first}, cells = [36, 20] }}")
    return external(mesh, "{ adiabatic_wall = {} }", mach, reynolds)


def sphere(reynolds, mach):
    mesh = generator("ellipsoid = { semi_axes = [0.5, 0.5, 0.5], outer_radius = 20, first_cell = 0.1, cells = [3, 3, 3, 6] }")
    far = f"{{ velocity = [1, 0, 0], mach = {mach} }}"
    boundary = f"wall = {{ adiabatic_wall = {{}} }}\nfar = {{ far_field = {far} }}"
    return dict(mesh=mesh, mach=mach, viscosity=f"{{ constant = {1 / reynolds} }}", stream=far, boundary=boundary, forces="")


MIRRORED = {"more": 'wall_flux = "mirrored"'}

STARTS = {
    "NACA 0012 Re = 100, M = 0.05, alpha = 20": wing_section(100, 0.05, 20.0),
    "NACA 0012 Re = 1000, M = 0.2, alpha = 0": wing_section(1000, 0.2, 0.0),
    "NACA 0012 Re = 1e4, M = 0.3, alpha = 10": wing_section(1e4, 0.3, 10.0),
    "NACA 0012 Re = 1e5, M = 0.6, alpha = 5": wing_section(1e5, 0.6, 5.0),
    "NACA 0012 Re = 1e5, M = 0.2, alpha = 20": wing_section(1e5, 0.2, 20.0),
    "cylinder Re = 100, M = 0.05": cylinder(100, 0.05),
    "cylinder Re = 1e4, M = 0.4": cylinder(1e4, 0.4),
    "cylinder Re = 1e5, M = 0.3, mirrored walls": {**cylinder(1e5, 0.3), **MIRRORED},
    "channel Re = 1e4, M = 0.3": channel(1e4, 0.3),
    "turbine passage Re = 1e4, M = 0.4": passage(1e4, 0.4),
    "turbine passage Re = 4e4, M = 0.3": passage(4e4, 0.3),
    "sphere Re = 300, M = 0.2": sphere(300, 0.2),
}


def wasted(summary):
    """The part of the Jacobian products that served attempts which were rejected."""
    krylov, products = summary["krylov"]["total"], summary["cost"]["jacobian_products"]
    return max(0.0, 1 - krylov / products) if summary["rejected_slabs"] else 0.0


def run(name, start, arguments):
    """The row of one flow, and whether it is good."""
    place = arguments.directory / "".join(c if c.isalnum() else "_" for c in name)
    shutil.rmtree(place, ignore_errors=True)
    place.parent.mkdir(parents=True, exist_ok=True)
    case = place.with_suffix(".toml")
    case.write_text(CASE.format(title=name, order=arguments.order, step=arguments.step, **{"more": "", **start}))
    changes = [part for change in arguments.set for part in ("--set", change)]
    command = [PROGRAM, "run", case, "--output", place, "--threads", str(arguments.threads), *changes]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    place.with_suffix(".out").write_text(done.stdout + done.stderr)
    if not (place / "summary.json").exists():
        return f"{name} | {done.stderr.splitlines()[-1]} | | | | | ", False
    summary = json.loads((place / "summary.json").read_text())
    lost, layer = wasted(summary), summary.get("start_layer")
    layer = "" if layer is None else f"{layer:.3f}"
    counts = f"{summary['slabs']} | {summary['rejected_slabs']} | {lost:.0%} | {layer} | {summary['cost']['wall_seconds']:.1f}"
    return f"{name} | {summary['time']:.3f} | {counts}", summary["completed"] and lost <= MOST_WASTED


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--order", type=int, default=4)
    parser.add_argument("--step", type=float, default=0.05)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--directory", type=pathlib.Path, default=ROOT / "runs/starts")
    arguments = parser.parse_args()
    print("| flow | t | slabs | rejected | wasted | layer | seconds |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    fine = True
    for name, start in STARTS.items():
        if not arguments.only or any(word in name for word in arguments.only):
            row, good = run(name, start, arguments)
            fine &= good
            print(f"| {row} |", flush=True)
    sys.exit(0 if fine else 1)


if __name__ == "__main__":
    main()
