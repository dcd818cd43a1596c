#!/usr/bin/env python3
"""The figures of a flag that flaps in a channel, as Turek & Hron print them.

    scripts/flapping_flag.py [--from TIME] [--to TIME] RUN [RUN...]

RUN is the directory of a run of cases/turek_hron_fsi2.toml or turek_hron_fsi3.toml. Prints the displacement of the tip in millimetres, and drag and
lift of cylinder and flag together, each as mean and half difference of the largest and the smallest value. The frequency is that of tip_y, from the
first to the last upward crossing of its mean.
"""

import argparse
import csv
import pathlib
import sys

WALLS = ("cylinder", "flag")


def columns(run, start, end):
    """The columns of history.csv that are needed, between two times."""
    with open(run / "history.csv", newline="") as file:
        rows = [row for row in csv.DictReader(file) if start <= float(row["t"]) <= end]
    if not rows:
        sys.exit(f"{run}: no slab ends between t = {start} and {end}")
    force = lambda axis: [sum(float(row[f"{wall}_force_{axis}"]) for wall in WALLS) for row in rows]
    tip = lambda axis: [1e3 * float(row[f"tip_{axis}"]) for row in rows]
    return [float(row["t"]) for row in rows], {"tip_x": tip("x"), "tip_y": tip("y"), "drag": force("x"), "lift": force("y")}


def mean_and_half_difference(values):
    return (max(values) + min(values)) / 2, (max(values) - min(values)) / 2


def frequency(times, values):
    """Crossings of the mean upwards per time."""
    mean, _ = mean_and_half_difference(values)
    pairs = zip(zip(times, values), zip(times[1:], values[1:]))
    crossings = [t + (mean - y) * (t1 - t) / (y1 - y) for (t, y), (t1, y1) in pairs if y < mean <= y1]
    return (len(crossings) - 1) / (crossings[-1] - crossings[0]) if len(crossings) > 1 else float("nan")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", nargs="+", type=pathlib.Path)
    parser.add_argument("--from", dest="start", type=float, default=0)
    parser.add_argument("--to", dest="end", type=float, default=float("inf"))
    arguments = parser.parse_args()
    print("| run | tip_x, mm | tip_y, mm | frequency, Hz | drag, N/m | lift, N/m |\n|---|---|---|---|---|---|")
    for run in arguments.runs:
        times, series = columns(run, arguments.start, arguments.end)
        cells = {name: "{:.2f} +- {:.2f}".format(*mean_and_half_difference(values)) for name, values in series.items()}
        of_tip = f"{cells['tip_x']} | {cells['tip_y']} | {frequency(times, series['tip_y']):.4f}"
        print(f"| {run} | {of_tip} | {cells['drag']} | {cells['lift']} |")


if __name__ == "__main__":
    main()
