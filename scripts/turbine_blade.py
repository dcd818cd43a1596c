#!/usr/bin/env python3
"""Loss, force, mass flow and separation of flows through a blade row, with error bars.

    scripts/turbine_blade.py --from TIME RUN [RUN...] [--plot FILE]

RUN is the directory of a run with an inflow `inflow`, an outflow `outflow` and a wall `blade`. Prints a table with a row for each run: means over
the time from TIME to the end. The loss coefficient is (p01 - p02) / (p02 - p2) of the mean states. An error is that of 95 %: the means over eight
parts of the time, and Student's factor. Points of separation are those of `surface_blade_separation.csv`, in chords along x.

--plot draws the mean pressure and skin friction of `surface_blade_mean.csv` along the blade. It needs the packages of scripts/requirements.txt.
"""

import argparse
import csv
import pathlib
import statistics
import sys

PARTS = 8
STUDENT = 2.365


def columns(path):
    """The columns of a table of numbers, by name."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


def mean(history, name, rows):
    """The mean of a column over slabs, weighted by their lengths."""
    lengths = [history["t"][row] - history["t"][row - 1] for row in rows]
    return sum(history[name][row] * length for row, length in zip(rows, lengths)) / sum(lengths)


def loss(history, rows):
    """(p01 - p02) / (p02 - p2)."""
    before, after = (mean(history, f"{name}_total_pressure", rows) for name in ("inflow", "outflow"))
    return (before - after) / (after - mean(history, "outflow_pressure", rows))


def equal_parts(rows, t):
    """The rows in parts of equal time, each by the middle of its slab; `t` are the ends of slabs."""
    start, length = t[rows[0] - 1], t[rows[-1]] - t[rows[0] - 1]
    parts = [[] for _ in range(PARTS)]
    for row in rows:
        parts[int(PARTS * ((t[row - 1] + t[row]) / 2 - start) / length)].append(row)
    return parts


def with_error(quantity, rows, t):
    """A quantity over all rows, and its error."""
    values = [quantity(part) for part in equal_parts(rows, t)]
    return quantity(rows), STUDENT * statistics.stdev(values) / PARTS**0.5


def separation(run):
    """The zeros of the mean skin friction along the blade, each with its first letter and its error."""
    path = run / "surface_blade_separation.csv"
    if not path.exists():
        return "-"
    means = columns(run / "surface_blade_mean.csv")
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return ", ".join(f"{row['kind'][0]} {float(row['x']):.4f} +- {error_of_zero(means, float(row['s'])):.4f}" for row in rows)


def error_of_zero(means, s):
    """The error along x of the zero of the skin friction at `s`: the error of the friction over its slope."""
    points = sorted(zip(means["s"], means["x"], means["skin_friction"], means["skin_friction_error"]))
    after = next((number for number, point in enumerate(points) if point[0] > s), len(points) - 1)
    (_, x_0, friction_0, error_0), (_, x_1, friction_1, error_1) = points[max(after, 1) - 1 : max(after, 1) + 1]
    return max(error_0, error_1) * abs((x_1 - x_0) / (friction_1 - friction_0))


def plot(runs, path):
    """Draws c_p and c_f along the blade with their errors; s runs over the suction side first."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(2, 1, sharex=True, figsize=(7, 6), layout="constrained")
    for run in runs:
        means = columns(run / "surface_blade_mean.csv")
        for axis, name in zip(axes, ("pressure_coefficient", "skin_friction")):
            low, high = ([value + sign * error for value, error in zip(means[name], means[f"{name}_error"])] for sign in (-1, 1))
            (line,) = axis.plot(means["s"], means[name], label=run.name, linewidth=1)
            axis.fill_between(means["s"], low, high, color=line.get_color(), alpha=0.25, linewidth=0)
    axes[0].set_ylabel("c_p")
    axes[1].set_ylabel("c_f along s")
    axes[1].axhline(0, color="black", linewidth=0.5)
    axes[1].set_xlabel("s: trailing edge, suction side, leading edge, pressure side")
    axes[0].legend()
    figure.savefig(path, dpi=110)


def main():
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--from", dest="start", type=float, required=True, help="the time at which means begin")
    parser.add_argument("--plot", type=pathlib.Path, help="a picture of the means along the blade")
    parser.add_argument("runs", type=pathlib.Path, nargs="+")
    options = parser.parse_args()
    print("| run | loss | force x | force y | mass flow | zeros of the skin friction: s separation, a attachment |")
    print("|---|---|---|---|---|---|")
    for run in options.runs:
        history = columns(run / "history.csv")
        rows = [row for row, t in enumerate(history["t"]) if row > 0 and history["t"][row - 1] >= options.start - 1e-9]
        if len(rows) < PARTS:
            sys.exit(f"{run}: {len(rows)} slabs begin after t = {options.start}, and the error needs {PARTS}")
        if not all(equal_parts(rows, history["t"])):
            sys.exit(f"{run}: a slab is longer than a part of the time, of which the error needs {PARTS}")
        quantities = [
            lambda rows: loss(history, rows),
            lambda rows: mean(history, "blade_force_x", rows),
            lambda rows: mean(history, "blade_force_y", rows),
            lambda rows: mean(history, "outflow_mass_flow", rows),
        ]
        values = [with_error(quantity, rows, history["t"]) for quantity in quantities]
        numbers = " | ".join(f"{value:.5f} +- {error:.5f}" for value, error in values)
        print(f"| {run.name} | {numbers} | {separation(run)} |")
    if options.plot:
        plot(options.runs, options.plot)


if __name__ == "__main__":
    main()
