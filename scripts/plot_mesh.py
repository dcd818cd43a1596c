#!/usr/bin/env python3
"""Draws meshes of order N from result files as they are: cells with curved edges, in panels side by side.

    plot_mesh.py RESULT... --output PICTURE.png [--times T...] [--window X0 X1 Y0 Y1]... [--colour WHAT]

One row for each result and window, in it one panel for each way to draw and each time. Colours, at every point:

    scaled        det J / max of det J in the cell: 1 in a parallelogram, red where it is negative
    deformation   det F = det J / det J_0 of the mesh at the first step: how much an area has grown
    none          edges alone

Inverted cells have red edges.
Edges are drawn through many points of their polynomial (`--draw smooth`), or straight from node to node (`--draw nodal`). Two dimensions only. Needs the module stsolve and the
packages of scripts/requirements.txt; `scripts/plot` prepares them.
"""

import argparse
import sys

import matplotlib
import numpy as np
from PIL import Image
from stsolve import Result

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.collections import LineCollection  # noqa: E402
from matplotlib.colors import LinearSegmentedColormap, LogNorm, Normalize  # noqa: E402

# Of det F.
TICKS = (0.1, 0.2, 0.3, 0.5, 0.7, 0.8, 0.9, 1, 1.1, 1.25, 1.4, 2, 3, 5, 10)
# What counts as no area at all.
INVERTED = 1e-9
# Inches.
BAR_WIDTH = 0.12
LOW = 1.6
INK, PAPER, WRONG = "#26323d", "#ffffff", "#d1242f"
SCALED = LinearSegmentedColormap.from_list("scaled", ["#16425b", "#2f7f9e", "#8dc1c9", "#d9ecea", "#f7fbfa"])
DEFORMATION = LinearSegmentedColormap.from_list(
    "deformation", ["#7a3b12", "#d08b45", "#f3ddbd", "#fbfaf7", "#c6dbe6", "#5492b5", "#173f5f"])


def gauss_lobatto(count):
    """The nodes in [-1, 1]: the ends and the roots of P'_(count-1)."""
    inner = np.polynomial.legendre.Legendre.basis(count - 1).deriv().roots()
    return np.concatenate([[-1.0], np.sort(inner.real), [1.0]])


def lattice(along):
    """All points of the plane with both coordinates in `along`, axis 0 fastest."""
    return np.array([(x, y) for y in along for x in along])


def nodes(result, step):
    """The positions of the nodes, [cell][node][axis]."""
    return np.swapaxes(result.array("position", step), 1, 2)


def order(result):
    """Nodes per direction of the mesh."""
    return round(result.array("position").shape[-1] ** 0.5)


class Colour:
    """What panels are coloured by, on a scale that all of them share."""

    def __init__(self, what, limits):
        self.what = what
        if what == "scaled":
            self.norm, self.map, self.label = Normalize(*(limits or (0.0, 1.0))), SCALED, "det J / max in the cell"
        else:
            low, high = limits or (0.25, 4.0)
            self.norm, self.map, self.label = LogNorm(low, high), DEFORMATION, "det F = det J / det J$_0$"
        self.map = self.map.with_extremes(under=WRONG)

    def values(self, result, step, points, cells):
        """[cell][point]"""
        det = result.determinants(step, points)[cells]
        if self.what == "scaled":
            return det / det.max(axis=1, keepdims=True)
        # Where a cell is inverted no logarithm can tell: below the scale.
        return np.maximum(det / result.determinants(0, points)[cells], INVERTED)


def moved(window, result, step):
    """The window, carried along by the node that was next to its centre at the first step."""
    start, now = (nodes(result, s).reshape(-1, 2) for s in (0, step))
    centre = np.array([window[0] + window[1], window[2] + window[3]]) / 2
    nearest = np.argmin(np.hypot(*(start - centre).T))
    shift = (now - start)[nearest]
    return [window[0] + shift[0], window[1] + shift[0], window[2] + shift[1], window[3] + shift[1]]


def cells_in(window, result, step):
    """The cells that may show in a window."""
    x = nodes(result, step)
    low, high = x.min(axis=1), x.max(axis=1)
    inside = (high[:, 0] >= window[0]) & (low[:, 0] <= window[1]) & (high[:, 1] >= window[2]) & (low[:, 1] <= window[3])
    return np.flatnonzero(inside)


def triangles(count, cells):
    """Two for every square of a count x count lattice in each cell."""
    corner = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    one = np.concatenate([np.stack([corner, corner + 1, corner + count], 1),
                          np.stack([corner + 1, corner + count + 1, corner + count], 1)])
    return (np.arange(cells)[:, None, None] * count**2 + one).reshape(-1, 3)


def fill(axes, result, step, cells, colour, count):
    """Colours the cells; returns the values, [cell][point]."""
    points = lattice(np.linspace(-1.0, 1.0, count))
    x = result.values("position", step, points)[cells].reshape(-1, 2)
    values = colour.values(result, step, points, cells)
    axes.tripcolor(*x.T, values.ravel(), triangles=triangles(count, len(cells)), shading="gouraud", cmap=colour.map,
                   norm=colour.norm, rasterized=True)
    return values


def lines(result, step, cells, across, along):
    """Polylines on which one reference coordinate is in `across` and the other runs through `along`."""
    parts = []
    for swap in (False, True):
        for fixed in across:
            points = np.stack([along, np.full_like(along, fixed)], axis=1)
            parts.append(result.values("position", step, points[:, ::-1] if swap else points)[cells])
    return np.concatenate(parts)


def outline(axes, result, step, cells, ink, width):
    """The edges of cells."""
    along = np.linspace(-1.0, 1.0, 6 * order(result))
    edges = lines(result, step, cells, (-1.0, 1.0), along)
    axes.add_collection(LineCollection(edges, colors=ink, linewidths=width))


def draw_edges(axes, result, step, cells, nodal, inner, width):
    """The edges of cells and, thin, `inner` lines inside."""
    count = order(result)
    along = gauss_lobatto(count) if nodal else np.linspace(-1.0, 1.0, 6 * count)
    if nodal or inner:
        points = gauss_lobatto(count if nodal else inner)[1:-1]
        axes.add_collection(LineCollection(lines(result, step, cells, points, along), colors=INK, linewidths=0.35 * width,
                                           alpha=0.45))
    axes.add_collection(LineCollection(lines(result, step, cells, (-1.0, 1.0), along), colors=INK, linewidths=width))


def whole(result, step):
    x = nodes(result, step)
    (x0, y0), (x1, y1) = x.min(axis=(0, 1)), x.max(axis=(0, 1))
    margin = 0.02 * max(x1 - x0, y1 - y0)
    return [x0 - margin, x1 + margin, y0 - margin, y1 + margin]


def draw_panel(axes, result, panel, colour, options):
    """One mesh. Says below it the smallest value shown."""
    draw, window, time = panel
    step = result.step_at(time) if time is not None else len(result.times) - 1
    window = whole(result, step) if window is None else moved(window, result, step) if options.follow else window
    cells = cells_in(window, result, step)
    if colour:
        smallest = fill(axes, result, step, cells, colour, options.samples).min(axis=1)
        inverted = cells[smallest <= INVERTED]
        text, ink = ("inverted", WRONG) if len(inverted) else (f"smallest {smallest.min():.2f}", INK)
        axes.set_xlabel(text, fontsize=7, color=ink, labelpad=3)
    size = max(window[1] - window[0], window[3] - window[2])
    typical = np.median(np.ptp(nodes(result, step)[cells], axis=1).max(axis=1))
    width = np.clip(9.0 * typical / size, 0.25, 0.8)
    draw_edges(axes, result, step, cells, draw == "nodal", options.inner, width)
    if colour and len(inverted):
        outline(axes, result, step, inverted, WRONG, 1.3 * width)
    axes.set(xlim=window[:2], ylim=window[2:], aspect="equal", xticks=[], yticks=[])
    for spine in axes.spines.values():
        spine.set(color=INK, linewidth=0.4)
    return result.times[step]


def add_bar(figure, grid, colour):
    """The scale of the colours, beside all panels."""
    scale = matplotlib.cm.ScalarMappable(colour.norm, colour.map)
    bar = figure.colorbar(scale, ax=grid, fraction=0.03, pad=0.01, aspect=figure.get_figheight() / BAR_WIDTH)
    # Beside a low picture the label needs two lines.
    label = colour.label if figure.get_figheight() > LOW else colour.label.replace(" / ", " /\n")
    bar.set_label(label, fontsize=7.5, color=INK)
    bar.outline.set_linewidth(0.4)
    if colour.what == "deformation":
        ticks = [tick for tick in TICKS if colour.norm.vmin <= tick <= colour.norm.vmax]
        bar.set_ticks(ticks, labels=[f"{tick:g}" for tick in ticks])
        bar.minorticks_off()
    bar.ax.tick_params(labelsize=7, width=0.4, colors=INK)


def palette(colour):
    """The 256 colours of a picture: those of the scale, and of lines half over them. The file is a quarter as large with them."""
    scale = (colour.map if colour else SCALED)(np.linspace(0.0, 1.0, 150))[:, :3]
    ink, paper, wrong = (np.array(matplotlib.colors.to_rgb(c)) for c in (INK, PAPER, WRONG))
    under = np.concatenate([scale[::8], [paper, wrong]])
    blends = [(1.0 - part) * under + part * ink for part in (0.2, 0.4, 0.6, 0.8)]
    colours = np.concatenate([scale, [ink, paper, wrong], *blends])
    picture = Image.new("P", (1, 1))
    picture.putpalette(np.rint(255 * colours).astype(np.uint8).ravel().tolist())
    return picture


def draw_picture(results, options):
    """All panels: a row for each result and window, a column for each way to draw and time."""
    rows = [(result, window) for result in results for window in options.window or [None]]
    columns = [(draw, time) for draw in options.draw for time in options.times or [None]]
    colour = Colour(options.colour, options.limits) if options.colour != "none" else None
    shapes = [window or whole(result, 0) for result, window in rows]
    heights = [options.width * (y1 - y0) / (x1 - x0) + 0.3 for x0, x1, y0, y1 in shapes]
    figure, grid = plt.subplots(len(rows), len(columns), squeeze=False, layout="constrained", height_ratios=heights,
                                figsize=(options.width * len(columns) + 1.0, sum(heights)))
    figure.get_layout_engine().set(w_pad=0.03, h_pad=0.03)
    for row, (result, window) in enumerate(rows):
        for column, (draw, time) in enumerate(columns):
            drawn = draw_panel(grid[row, column], result, (draw, window, time), colour, options)
            if row == 0:
                title = options.titles[column] if options.titles else f"{options.time_name} = {drawn:.4g}"
                grid[row, column].set_title(title, fontsize=8, color=INK, pad=4)
        if options.rows:
            grid[row, 0].set_ylabel(options.rows[row], fontsize=8, color=INK)
    if colour:
        add_bar(figure, grid, colour)
    figure.savefig(options.output, dpi=options.dpi, facecolor=PAPER)
    with Image.open(options.output) as picture:
        reduced = picture.convert("RGB").quantize(palette=palette(colour), dither=Image.Dither.NONE)
    reduced.save(options.output, optimize=True)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", nargs="+", metavar="RESULT")
    parser.add_argument("--output", required=True, metavar="PICTURE.png")
    parser.add_argument("--times", nargs="+", type=float, metavar="T", help="the steps nearest to these times; default: the last")
    parser.add_argument("--time-name", default="t", help="what a title calls the time")
    parser.add_argument("--window", nargs=4, type=float, action="append", metavar=("X0", "X1", "Y0", "Y1"))
    parser.add_argument("--follow", action="store_true", help="windows move with the mesh at their centre")
    parser.add_argument("--colour", choices=("scaled", "deformation", "none"), default="scaled")
    parser.add_argument("--limits", nargs=2, type=float, metavar=("LOW", "HIGH"), help="of the colours")
    parser.add_argument("--draw", nargs="+", choices=("smooth", "nodal"), default=["smooth"])
    parser.add_argument("--inner", type=int, default=0, metavar="N", help="lines through N Gauss-Lobatto points of a cell")
    parser.add_argument("--rows", nargs="+", help="a label for each row")
    parser.add_argument("--titles", nargs="+", help="a title for each column")
    parser.add_argument("--width", type=float, default=2.2, help="of a panel, in inches")
    parser.add_argument("--samples", type=int, default=13, help="points of a cell per direction that are coloured")
    parser.add_argument("--dpi", type=int, default=130)
    return parser.parse_args()


def main():
    options = arguments()
    results = [Result(path) for path in options.results]
    if any(result.dimension != 2 for result in results):
        sys.exit("only results in two dimensions can be drawn")
    draw_picture(results, options)


if __name__ == "__main__":
    main()
