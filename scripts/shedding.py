#!/usr/bin/env python3
"""The vortex street of a run: prints Strouhal number, mean drag and amplitude of lift of a wall over the last whole periods.

    shedding.py RUN_DIRECTORY [--wall NAME] [--periods N] [--length L] [--speed U]
    shedding.py RUN_DIRECTORY --from T ...

A period lasts from one upward zero crossing of the lift coefficient to the next, St = L / (U period). Where the lift keeps its sign in the second
half of the time, its middle value there takes the place of zero. With --from the flow need not be
periodic: means are those from the time T on, and St is the peak of the spectrum of the drag, by a Hann window. In
a plane vortex street the drag has twice the frequency of the lift.
"""

import argparse
import cmath
import csv
import math
import pathlib
import sys


def columns(directory, wall):
    rows = list(csv.DictReader((directory / "history.csv").open()))
    names = ("t", "dt", f"{wall}_lift_coefficient", f"{wall}_drag_coefficient")
    missing = [name for name in names if rows and name not in rows[0]]
    if missing:
        sys.exit(f"{directory / 'history.csv'} has no column {missing[0]}: is `{wall}` the name of a wall?")
    return [[float(row[name]) for row in rows] for name in names]


def level_of(time, lift):
    """Zero, or the middle of the lift in the second half of the time if that does not change its sign."""
    late = [l for t, l in zip(time, lift) if t >= (time[0] + time[-1]) / 2]
    return 0 if min(late) < 0 < max(late) else (min(late) + max(late)) / 2


def upward_crossings(time, lift, level):
    lift = [l - level for l in lift]
    pairs = zip(zip(time, lift), zip(time[1:], lift[1:]))
    return [t - l * (t1 - t) / (l1 - l) for (t, l), (t1, l1) in pairs if l < 0 <= l1]


def fourier(values):
    """The discrete Fourier transform of a list whose length is a power of two."""
    if len(values) == 1:
        return values
    even, odd = fourier(values[::2]), fourier(values[1::2])
    turned = [cmath.exp(-2j * math.pi * k / len(values)) * value for k, value in enumerate(odd)]
    return [a + b for a, b in zip(even, turned)] + [a - b for a, b in zip(even, turned)]


def even(time, signal, count):
    """The signal at `count` even times from the first to the last, by straight lines."""
    values, k = [], 0
    for number in range(count):
        at = time[0] + (time[-1] - time[0]) * number / (count - 1)
        while k < len(time) - 2 and time[k + 1] < at:
            k += 1
        values.append(signal[k] + (signal[k + 1] - signal[k]) * (at - time[k]) / (time[k + 1] - time[k]))
    return values


def peak(time, step, signal):
    """The frequency of the largest peak of the spectrum, from two periods in the time to half of the rate of the rows.

    A transform of even values finds it to a quarter of a period in the time, a sum over the rows to a fiftieth.
    """
    start, length, mean = time[0], time[-1] - time[0], sum(s * h for s, h in zip(signal, step)) / sum(step)
    weight = [math.sin(math.pi * (t - start) / length) ** 2 for t in time]
    window = [(s - mean) * w for s, w in zip(signal, weight)]
    count = 2 ** math.ceil(math.log2(len(time)))
    coarse = fourier(even(time, window, count) + 3 * count * [0])
    spacing = (count - 1) / count / (4 * length)
    last = int((len(time) - 1) / (2 * length) / spacing)
    about = spacing * max(range(math.ceil(2 / length / spacing), last + 1), key=lambda k: abs(coarse[k]))
    size = lambda f: abs(sum(w * h * cmath.exp(-2j * math.pi * f * t) for w, h, t in zip(window, step, time)))
    near = round(50 * length * about)
    return max((k / (50 * length) for k in range(max(100, near - 25), near + 26)), key=size)


def irregular(arguments, rows):
    rows = [row for row in zip(*rows) if row[0] >= arguments.start]
    if len(rows) < 16:
        sys.exit(f"only {len(rows)} rows from t = {arguments.start:g} on")
    time, step, lift, drag = zip(*rows)
    mean = lambda signal: sum(s * h for s, h in zip(signal, step)) / sum(step)
    strouhal = peak(time, step, drag) * arguments.length / arguments.speed
    print(f"St {strouhal:.4f}  mean C_D {mean(drag):.4f}  mean C_L {mean(lift):.4f}  t {time[0]:.2f} to {time[-1]:.2f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("--wall", default="wall")
    parser.add_argument("--periods", type=int, default=4)
    parser.add_argument("--length", type=float, default=1)
    parser.add_argument("--speed", type=float, default=1)
    parser.add_argument("--from", dest="start", type=float)
    arguments = parser.parse_args()
    time, step, lift, drag = columns(arguments.directory, arguments.wall)
    if arguments.start is not None:
        return irregular(arguments, (time, step, lift, drag))
    if arguments.periods < 1:
        sys.exit("--periods: at least 1")
    if not time:
        sys.exit("there are no slabs yet")
    crossings = upward_crossings(time, lift, level_of(time, lift))
    if len(crossings) <= arguments.periods:
        sys.exit(f"only {max(0, len(crossings) - 1)} periods so far")
    first, last = crossings[-1 - arguments.periods], crossings[-1]
    inside = [k for k, t in enumerate(time) if first < t <= last]
    mean = sum(drag[k] * step[k] for k in inside) / sum(step[k] for k in inside)
    amplitude = max(abs(lift[k]) for k in inside)
    strouhal = arguments.periods * arguments.length / (arguments.speed * (last - first))
    print(f"St {strouhal:.4f}  mean C_D {mean:.4f}  largest |C_L| {amplitude:.4f}  t {first:.2f} to {last:.2f}")


if __name__ == "__main__":
    main()
