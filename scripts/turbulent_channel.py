#!/usr/bin/env python3
"""The mean flow and the fluctuations of a turbulent channel beside published ones.

    turbulent_channel.py [RUN] [--order 4] [--upto 150] [--within PERCENT]

Reads averages_along.csv of a run of `cases/turbulent_channel.toml`, runs/turbulent_channel if none is given. Both halves of the channel are
averaged. The published values are those of del Alamo & Jimenez, Phys. Fluids 15 (2003) L41, at Re_tau = 186. Prints a table in Markdown: the
distance from the wall, the mean velocity and the root mean squares of its fluctuations, all in wall units, and the error of the balance of
momentum, whose exact shear is 1 - y / h. With --within a mean velocity that differs by more up to the distance --upto is a failure.
"""

import argparse
import csv
import math
import pathlib
import sys

RE_TAU = 180
# y+, U+, u'+, v'+, w'+
PUBLISHED = (
    (1.594, 1.586, 0.5825, 0.0187, 0.2718), (3.580, 3.513, 1.2704, 0.0736, 0.4983), (6.349, 5.961, 2.0131, 0.1703, 0.6937),
    (9.889, 8.451, 2.5070, 0.2962, 0.8456), (14.184, 10.531, 2.6591, 0.4337, 0.9589), (19.216, 12.073, 2.5788, 0.5647, 1.0332),
    (24.964, 13.171, 2.3930, 0.6749, 1.0731), (31.403, 13.965, 2.1816, 0.7576, 1.0889), (38.506, 14.567, 1.9840, 0.8120, 1.0899),
    (46.241, 15.053, 1.8145, 0.8410, 1.0802), (54.577, 15.470, 1.6732, 0.8496, 1.0603), (68.126, 16.022, 1.5047, 0.8356, 1.0129),
    (82.814, 16.519, 1.3706, 0.8024, 0.9521), (98.498, 16.974, 1.2529, 0.7596, 0.8827), (120.70, 17.511, 1.1024, 0.6992, 0.7828),
    (149.98, 18.030, 0.9152, 0.6367, 0.6691),
)


def profile(run):
    """The columns of a run by the distance from the nearer wall: {name: [value]}, both halves averaged."""
    with (run / "averages_along.csv").open() as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    rows.sort(key=lambda row: row["y"])
    halves = list(zip(rows, reversed(rows)))[:(len(rows) + 1) // 2]
    mean = {name: [(low[name] + high[name]) / 2 for low, high in halves] for name in rows[0] if name != "y"}
    # The shear changes its sign with the side.
    mean["reynolds_stress_xy"] = [(low["reynolds_stress_xy"] - high["reynolds_stress_xy"]) / 2 for low, high in halves]
    return {**mean, "distance": [1 + low["y"] for low, _ in halves]}


class Polynomials:
    """Columns between nodes: in every cell the polynomial through its `order` nodes."""

    def __init__(self, columns, order):
        self.columns, self.order, self.nodes = columns, order, columns["distance"]

    def weights(self, distance):
        """The number of the first node of the cell, and of each of its nodes the Lagrange polynomial and its derivative there."""
        last = (len(self.nodes) - 1) // (self.order - 1) - 1
        cell = min(last, sum(distance > self.nodes[k] for k in range(self.order - 1, len(self.nodes), self.order - 1)))
        x = self.nodes[cell * (self.order - 1):][:self.order]
        others = [[y for j, y in enumerate(x) if j != k] for k in range(self.order)]
        scales = [math.prod(own - y for y in rest) for own, rest in zip(x, others)]
        values = [math.prod(distance - y for y in rest) / scale for rest, scale in zip(others, scales)]
        slopes = [
            sum(math.prod(distance - y for j, y in enumerate(rest) if j != i) for i in range(len(rest))) / scale
            for rest, scale in zip(others, scales)
        ]
        return cell * (self.order - 1), values, slopes

    def at(self, name, distance):
        """The value of a column and its derivative."""
        first, values, slopes = self.weights(distance)
        own = self.columns[name][first:][:self.order]
        return tuple(sum(w * v for w, v in zip(weights, own)) for weights in (values, slopes))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", type=pathlib.Path, nargs="?", default=pathlib.Path("runs/turbulent_channel"))
    parser.add_argument("--order", type=int, default=4, help="of the flow")
    parser.add_argument("--upto", type=float, default=150, help="in wall units")
    parser.add_argument("--within", type=float, help="percent")
    arguments = parser.parse_args()
    columns = Polynomials(profile(arguments.run), arguments.order)
    print("| y+ | U+ | published | difference | u'+ | published | v'+ | published | w'+ | published | shear |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    worst = 0
    for y, mean, *published in PUBLISHED:
        u, slope = columns.at("mean_velocity_x", y / RE_TAU)
        rms = [max(0, columns.at(f"reynolds_stress_{c}{c}", y / RE_TAU)[0]) ** 0.5 for c in "xyz"]
        shear = slope / RE_TAU - columns.at("reynolds_stress_xy", y / RE_TAU)[0]
        difference = 100 * (u / mean - 1)
        worst = max(worst, abs(difference) if y <= arguments.upto else 0)
        fluctuations = " | ".join(f"{own:.3f} | {other:.3f}" for own, other in zip(rms, published))
        print(f"| {y:.1f} | {u:.3f} | {mean:.3f} | {difference:+.1f} % | {fluctuations} | {shear - (1 - y / RE_TAU):+.3f} |")
    print(f"\nup to y+ = {arguments.upto:g} the mean velocity differs by at most {worst:.1f} %")
    if arguments.within is not None and worst > arguments.within:
        sys.exit(1)


if __name__ == "__main__":
    main()
