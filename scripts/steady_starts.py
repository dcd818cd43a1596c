#!/usr/bin/env python3
"""Starts twelve steady flows from the free stream, each at two orders, and prints the results as a table in Markdown.

    steady_starts.py [--only WORD]... [--set KEY=VALUE]... [--directory DIRECTORY] [--threads N]

WORD selects the flows whose name contains it. No case sets a key of `[solver.steady]`. A start that fails must say that the
flow is unsteady. Needs the program, built by scripts/stsolve; the environment variable STSOLVE names another one.
Exit code 1 if a start neither converges nor ends with that message.
"""

import argparse
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = os.environ.get("STSOLVE", ROOT / "target/release/stsolve")

AIRFOIL = """airfoil = { first_cell = FIRST, trailing_edge_cell = 0.02, surface_cells = 14, wake_cells = 8,
    near_wake = { extent = 2, cells = 6 }, normal_cells = 11, near_wall = { extent = 0.6, cells = 8 } }"""

# A case up to its times; `more` are further keys of the flow.
HEAD = """title = "{title}"
[mesh]
order = 4
[mesh.generate.{mesh}
[flow]
order = {order}
gas = {{ gamma = 1.4, prandtl = 0.72, mach = {mach}, viscosity = {viscosity} }}
initial = {{ uniform = {stream} }}
{more}
[flow.boundary]
{boundary}
{forces}
"""

CASE = (
    HEAD
    + """[time]
order = 1
end = 0
step = 1
[solver.steady]
[output]
fields = []
"""
)


def stream(mach, degrees=0.0):
    angle = math.radians(degrees)
    return f"{{ velocity = [{math.cos(angle)}, {math.sin(angle)}], mach = {mach} }}"


def external(mesh, wall, mach, reynolds=None, degrees=0.0):
    far = stream(mach, degrees)
    viscosity = f"{{ constant = {1 / reynolds} }}" if reynolds else '"inviscid"'
    name = "wall" if mesh.startswith("annulus") else "airfoil"
    drag = [math.cos(math.radians(degrees)), math.sin(math.radians(degrees))]
    return dict(
        mesh=mesh,
        mach=mach,
        viscosity=viscosity,
        stream=far,
        boundary=f"{name} = {wall}\nfar = {{ far_field = {far} }}",
        forces=f"[flow.forces]\n{name} = {{ drag_direction = {drag} }}",
    )


def generator(text):
    name, table = text.split(" = ", 1)
    entries = " ".join(table.strip()[1:-1].split())
    depth, start, lines = 0, 0, []
    for i, letter in enumerate(entries + ","):
        depth += letter in "{[" and 1 or 0
        depth -= letter in "}]" and 1 or 0
        if letter == "," and depth == 0:
            lines.append(entries[start:i].strip())
            start = i + 1
    return name + "]\n" + "\n".join(lines)


def airfoil(first):
    return generator(AIRFOIL.replace("FIRST", str(first)))


def euler(mach, degrees=2.0):
    return external(airfoil(0.02), '"slip_wall"', mach, None, degrees)


def viscous(reynolds):
    return external(airfoil(0.01), "{ adiabatic_wall = {} }", 0.2, reynolds)


def cylinder(reynolds):
    mesh = generator("annulus = { inner_radius = 0.5, outer_radius = 100, first_cell = 0.1, cells = [20, 14] }")
    return external(mesh, "{ adiabatic_wall = {} }", 0.1, reynolds)


def total(mach, temperature):
    """Total pressure and temperature of a stream of density and speed 1."""
    factor = 1 + 0.2 * mach**2
    return factor**3.5 / (1.4 * mach**2), temperature * factor


def passage(reynolds, mach=0.2, degrees=37.7):
    pressure, temperature = total(mach, 1.0)
    angle = math.radians(degrees)
    direction = [math.cos(angle), math.sin(angle)]
    boundary = (
        "blade = { adiabatic_wall = {} }\n"
        f"inflow = {{ inflow = {{ total_pressure = {pressure}, total_temperature = {temperature}, direction = {direction} }} }}\n"
        f"outflow = {{ outflow = {{ pressure = {1 / (1.4 * mach**2)} }} }}"
    )
    mesh = generator("turbine_blade = { cells = { side = 12, end = 4, normal = 4, gap = 2, before = 4, after = 8 }, first_cell = 0.015 }")
    viscosity = f"{{ constant = {1 / reynolds} }}"
    return dict(mesh=mesh, mach=mach, viscosity=viscosity, stream=stream(mach, degrees), boundary=boundary, forces="")


def channel(reynolds=100, mach=0.2):
    pressure, temperature = total(mach, 1.0)
    boundary = (
        "bottom = { adiabatic_wall = {} }\ntop = { adiabatic_wall = {} }\n"
        f"inflow = {{ inflow = {{ total_pressure = {pressure}, total_temperature = {temperature}, direction = [1, 0] }} }}\n"
        f"outflow = {{ outflow = {{ pressure = {1 / (1.4 * mach**2)} }} }}"
    )
    mesh = generator("channel = { extent = [4, 1], cells = [16, 8] }")
    return dict(mesh=mesh, mach=mach, viscosity=f"{{ constant = {1 / reynolds} }}", stream=stream(mach), boundary=boundary, forces="")


STARTS = {
    **{f"NACA 0012 inviscid M = {mach}, alpha = 2": euler(mach) for mach in (0.1, 0.3, 0.5, 0.63)},
    **{f"NACA 0012 viscous Re = {reynolds}": viscous(reynolds) for reynolds in (100, 1000, 5000)},
    **{f"cylinder Re = {reynolds}": cylinder(reynolds) for reynolds in (10, 40)},
    **{f"turbine passage Re = {reynolds}": passage(reynolds) for reynolds in (500, 1000)},
    "channel Re = 100": channel(),
}


def run(directory, name, start, order, arguments):
    place = directory / f"{''.join(c if c.isalnum() else '_' for c in name)}_{order}"
    shutil.rmtree(place, ignore_errors=True)
    place.parent.mkdir(parents=True, exist_ok=True)
    case = place.with_suffix(".toml")
    case.write_text(CASE.format(title=name, order=order, **{"more": "", **start}))
    changes = [part for change in arguments.set for part in ("--set", change)]
    command = [PROGRAM, "run", case, "--output", place, "--threads", str(arguments.threads), *changes]
    begun = time.monotonic()
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    seconds = time.monotonic() - begun
    place.with_suffix(".err").write_text(done.stderr)
    place.with_suffix(".out").write_text(done.stdout + done.stderr)
    if done.returncode != 0:
        return f"{name} | {order} | no | | | | | {seconds:.1f} | {message(done.stderr)}", "unsteady" in done.stderr
    steady = json.loads((place / "summary.json").read_text())["steady"]
    walls = list(steady["walls"].values())
    drag, lift = (sum(wall.get(f"{key}_coefficient") or 0 for wall in walls) for key in ("drag", "lift"))
    counts = f"{steady['newton']} | {steady['krylov']} | {drag:.6f} | {lift:.6f} | {seconds:.1f}"
    return f"{name} | {order} | yes | {counts} | {stages(place)}", True


def stages(place):
    """The orders of the solves that led to the flow, a cross at those that were given up."""
    found = re.findall(r"steady flow of order (\d+)(, dissipative flux)?: .*?( {2}given up)?$", (place.with_suffix(".out")).read_text(), re.M)
    return " ".join(f"{order}{'d' if flux else ''}{'x' if failed else ''}" for order, flux, failed in found)


def message(text):
    lines = [line.strip() for line in text.splitlines() if "steady flow" in line or "likely cause" in line]
    return " ".join(lines)[:300].replace("|", "/")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--orders", default="3,5")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--directory", type=pathlib.Path, default=ROOT / "runs/steady_starts")
    arguments = parser.parse_args()
    print("| flow | N_s | converges | Newton | Krylov | C_D | C_L | seconds | |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    fine = True
    for name, start in STARTS.items():
        if arguments.only and not any(word in name for word in arguments.only):
            continue
        for order in map(int, arguments.orders.split(",")):
            row, good = run(arguments.directory, name, start, order, arguments)
            fine &= good
            print(f"| {row} |", flush=True)
    sys.exit(0 if fine else 1)


if __name__ == "__main__":
    main()
