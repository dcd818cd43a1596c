#!/usr/bin/env python3
"""The benchmark DFG 2D-1 for small Mach numbers M, and its limit M -> 0, beside the incompressible values.

    channel_cylinder.py [--orders 6] [--directory runs/channel_cylinder] [--threads N] [--within 1e-4]

Runs `cases/channel_cylinder.toml` with M = 0.1, 0.05 and 0.025 by the mean velocity. With the Mach number the pressure of the outflow and the gas
constant change: p = rho U^2 / (gamma M^2). The limit is that of a straight line in M^2 through the last two values. With --within a larger
relative difference is a failure. Runs $STSOLVE, else scripts/stsolve.
"""

import argparse
import json
import math
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
MACH = (0.1, 0.05, 0.025)
# Drag and lift coefficient: Nabh (1998), as quoted for DFG 2D-1.
PUBLISHED = (5.57953523384, 0.010618948146)


def coefficients(order, mach, directory, threads):
    """Drag and lift coefficient of the steady flow."""
    pressure = 0.2**2 / (1.4 * mach**2)
    changes = {
        "flow.order": order, "mesh.order": order, "flow.initial.uniform.mach": mach, "flow.reference.pressure": pressure,
        "flow.gas.gas_constant": pressure, "flow.boundary.outflow.outflow.pressure": pressure,
    }
    output = directory / f"order_{order}_mach_{mach}"
    command = [os.environ.get("STSOLVE", str(ROOT / "scripts" / "stsolve")), "run", str(ROOT / "cases" / "channel_cylinder.toml")]
    command += ["--output", str(output), "--force", *threads]
    for key, value in changes.items():
        command += ["--set", f"{key}={value!r}"]
    run = subprocess.run(command, capture_output=True, text=True)
    if run.returncode:
        sys.exit(run.stderr)
    cylinder = json.loads((output / "summary.json").read_text())["steady"]["walls"]["cylinder"]
    return cylinder["drag_coefficient"], cylinder["lift_coefficient"]


def limit(values):
    """The straight line in M^2 through the last two values, at M = 0."""
    (x, y), (a, b) = [mach**2 for mach in MACH[-2:]], values[-2:]
    return tuple((x * second - y * first) / (x - y) for first, second in zip(a, b))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--orders", type=int, nargs="+", default=[6])
    parser.add_argument("--directory", type=pathlib.Path, default=pathlib.Path("runs/channel_cylinder"))
    parser.add_argument("--threads", type=int)
    parser.add_argument("--within", type=float, default=math.inf)
    arguments = parser.parse_args()
    threads = ["--threads", str(arguments.threads)] if arguments.threads else []
    print("| order | M | drag coefficient | lift coefficient |\n|---|---|---|---|")
    worst = 0
    for order in arguments.orders:
        values = [coefficients(order, mach, arguments.directory, threads) for mach in MACH]
        for mach, (drag, lift) in zip(MACH, values):
            print(f"| {order} | {mach} | {drag:.6f} | {lift:.7f} |")
        drag, lift = limit(values)
        errors = drag / PUBLISHED[0] - 1, lift / PUBLISHED[1] - 1
        print(f"| {order} | limit | {drag:.6f} ({errors[0]:+.1e}) | {lift:.7f} ({errors[1]:+.1e}) |", flush=True)
        worst = max([worst, *map(abs, errors)])
    print("| | incompressible | {:.6f} | {:.7f} |".format(*PUBLISHED))
    if worst > arguments.within:
        sys.exit(f"a limit differs by {worst:.1e}, allowed are {arguments.within:g}")


if __name__ == "__main__":
    main()
