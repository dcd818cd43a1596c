#!/usr/bin/env python3
"""Draws the motion of a structure: its outline at several times, displacements magnified, above curves from history.csv.

    plot_structure.py DIRECTORY PICTURE.png [--times T...] [--magnify FACTOR]

DIRECTORY is that of a run. Without --times, the outlines are of eight steps over the run, or over the first period of the first natural
mode; without --magnify, displacements are drawn so that the largest is a tenth of the structure. Below it: the coordinates of the natural
modes if there are some, otherwise the displacements of the points observed. Two dimensions only. Needs the module stsolve (`scripts/wheel`)
and the packages of scripts/requirements.txt.
"""

import argparse
import json
import pathlib
import sys

import matplotlib
import numpy as np
from stsolve import Result

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.collections import LineCollection, PolyCollection  # noqa: E402

INK, BODY, PAPER = "#26323d", "#d9ecea", "#ffffff"
TIMES = matplotlib.colormaps["viridis"]
OUTLINES = 8
# Points of an edge.
POINTS = 25


def edges(result, step, magnify):
    """The edges of all cells, [edge][point][axis], displacements since the first step magnified."""
    along = np.linspace(-1.0, 1.0, POINTS)
    sides = [np.stack(pair, axis=1) for end in (-1.0, 1.0)
             for pair in ((along, np.full_like(along, end)), (np.full_like(along, end), along))]
    rest, now = (np.concatenate([result.values("position", s, side) for side in sides]) for s in (0, step))
    return rest + magnify * (now - rest)


def boundary(rest):
    """Which edges belong to one cell only: no other has the same middle at rest."""
    middles = rest[:, POINTS // 2]
    apart = np.linalg.norm(middles[:, None] - middles, axis=2)
    return (apart < 1e-9 * np.ptp(rest, axis=(0, 1)).max()).sum(axis=1) == 1


def chosen_steps(result, summary, times):
    """The steps at `times`, or of the first period, or of the whole run."""
    if times is None:
        frequencies = summary.get("structure", {}).get("natural_frequencies")
        end = min(result.times[-1], 1.0 / frequencies[0]) if frequencies else result.times[-1]
        times = np.linspace(result.times[0], end, OUTLINES)
    return sorted({result.step_at(time) for time in times})


def draw_outlines(axes, result, steps, magnify):
    rest = edges(result, 0, 0.0)
    outer = boundary(rest)
    axes.add_collection(PolyCollection(rest, facecolors="none", edgecolors=BODY, linewidths=0.8))
    for number, step in enumerate(steps):
        colour = TIMES(number / max(len(steps) - 1, 1) * 0.92)
        drawn = edges(result, step, magnify)[outer]
        axes.add_collection(LineCollection(drawn, colors=[colour], linewidths=1.3, label=f"{result.times[step]:.4g}"))
    axes.autoscale()
    axes.margins(0.03)
    axes.set(aspect="equal", xticks=[], yticks=[])
    axes.set_title(f"outline at the times t, displacements times {magnify:.3g}", fontsize=9, color=INK)
    axes.legend(title="t", fontsize=7, title_fontsize=7, loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)


def draw_history(axes, columns):
    modes = [name for name in columns if name.startswith("mode_")]
    known = {"t", "dt"}
    names = modes or [name for name in columns if name not in known and name.endswith(("_x", "_y", "_z"))]
    for name in names:
        axes.plot(columns["t"], columns[name], linewidth=1.0, label=name)
    axes.set_xlabel("t", fontsize=8, color=INK)
    axes.set_title("coordinates of the natural modes" if modes else "displacements of points", fontsize=9, color=INK)
    axes.tick_params(labelsize=7, colors=INK)
    axes.grid(linewidth=0.3)
    axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)


def magnification(result, steps):
    """So that the largest displacement is a tenth of the structure."""
    rest, size = result.array("position", 0), 0.0
    for step in steps:
        size = max(size, np.abs(result.array("position", step) - rest).max())
    return 0.1 * np.ptp(rest, axis=(0, 2)).max() / size if size > 0.0 else 1.0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("picture")
    parser.add_argument("--times", nargs="+", type=float)
    parser.add_argument("--magnify", type=float)
    arguments = parser.parse_args()
    result = Result(arguments.directory)
    if result.dimension != 2:
        sys.exit("only results in two dimensions can be drawn")
    summary = json.loads((arguments.directory / "summary.json").read_text())
    steps = chosen_steps(result, summary, arguments.times)
    figure, (above, below) = plt.subplots(2, 1, figsize=(8.0, 4.6), height_ratios=[1.25, 1.0], layout="constrained")
    draw_outlines(above, result, steps, arguments.magnify or magnification(result, steps))
    draw_history(below, result.history)
    figure.savefig(arguments.picture, dpi=100, facecolor=PAPER)


if __name__ == "__main__":
    main()
