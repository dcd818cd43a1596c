#!/usr/bin/env python3
"""Compares the pictures in a report with VTK's pictures of the same result.

    check_pictures.py DIRECTORY

DIRECTORY is the directory of a run in two dimensions for which `stsolve report` has made report.html. Fields that are also in
result.vtkhdf are compared at the first, a middle and the last time. For the density VTK draws the same polynomial in each cell, so
all but a few pixels must have the same colour, or the next one. Other fields are interpolated by VTK between its points and are
compared for information. All fields must cover the same pixels. Exits with 1 and names the differences. If VTK cannot draw
off-screen, or has no field to compare, it says so and exits with 0. Needs the Python packages vtk (9.3 or newer) and numpy.
"""

import argparse
import base64
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from check_vtk import open_result, read_step
from render_vtk import render, spread

# What the report calls a field, and what the file does.
FIELDS = {"Density": "density", "Pressure": "pressure", "Mach number": "mach", "Mesh: det J / det J\u2080": "jacobian"}

# Fields that are polynomials of the degree that VTK draws: the others it interpolates between its points.
EXACT = {"density"}

# Colours of which there is none in the maps: nothing is drawn there.
GROUND = (0.0, 1.0, 0.0)

# Of the pixels at most this part may be drawn by one and not by the other, or differ by more than a colour.
AT_EDGES = 0.002


def decode(uri):
    """The picture of a data URI, [row][column][red, green, blue, opacity]."""
    with tempfile.NamedTemporaryFile(suffix=".png") as file:
        file.write(base64.b64decode(uri.split(",", 1)[1]))
        file.flush()
        reader = vtk.vtkPNGReader()
        reader.SetFileName(file.name)
        reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)[::-1]


def numbers(picture, colours):
    """The number of the nearest colour of each pixel."""
    packed = picture[:, :, :3].astype(int) @ [1 << 16, 1 << 8, 1]
    found, places = np.unique(packed, return_inverse=True)
    found = np.stack([found >> 16, found >> 8 & 255, found & 255], axis=1)
    nearest = np.abs(found[:, None, :] - np.round(colours)[None, :, :]).sum(axis=2).argmin(axis=1)
    return nearest[places].reshape(packed.shape)


def compare(ours, theirs, colours):
    """Parts of the pixels that only one draws, and that differ by more than one colour."""
    mine, other = ours[:, :, 3] > 0, (theirs != np.array(GROUND) * 255).any(axis=2)
    both = mine & other
    apart = np.abs(numbers(ours, colours) - numbers(theirs, colours))[both] > 1
    return (mine != other).mean(), apart.mean() if both.any() else 1.0


def wrong(directory):
    """All that differs; says what was compared."""
    text = (directory / "report.html").read_text(encoding="utf-8")
    data = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL).group(1)
    pictures = json.loads(data)["pictures"]
    pane = next(window for window in pictures["windows"] if window["label"] == "whole domain")
    window, size = (*pane["lower"], *pane["upper"]), (pane["width"], pane["height"])
    reader, times = open_result(str(directory / "result.vtkhdf"))
    frames = sorted({0, len(pictures["times"]) // 2, len(pictures["times"]) - 1})
    for frame in frames:
        grid = read_step(reader, times[pictures["steps"][frame]])
        for quantity, drawn in zip(pictures["quantities"], pane["pictures"]):
            field = FIELDS.get(quantity["label"])
            if field is None or grid.GetPointData().GetArray(field) is None:
                continue
            stops = re.findall(r"#(..)(..)(..)", quantity["colours"])
            colours = spread(np.array([[int(part, 16) for part in stop] for stop in stops]), 240)
            theirs = render(grid, field, (quantity["lower"], quantity["upper"]), colours, window, size, ground=GROUND)
            edges, apart = compare(decode(drawn[frame][0]), theirs, colours)
            what = f"t = {pictures['times'][frame]:g}, {field}: {100 * edges:.2f} % of the pixels are drawn by one " \
                   f"alone, {100 * apart:.2f} % differ by more than a colour of 240"
            print(what)
            if edges > AT_EDGES or (field in EXACT and apart > AT_EDGES):
                yield what


def can_draw():
    """Whether VTK can draw here: without a display it may end the process."""
    probe = "import vtk; w = vtk.vtkRenderWindow(); w.SetOffScreenRendering(1); w.AddRenderer(vtk.vtkRenderer()); w.Render()"
    return subprocess.run([sys.executable, "-c", probe], capture_output=True, check=False).returncode == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", type=pathlib.Path)
    directory = parser.parse_args().directory
    if not can_draw():
        print(f"{directory}: skipped: VTK cannot draw off-screen here")
        return
    differences = list(wrong(directory))
    for difference in differences:
        print(f"{directory}: {difference}", file=sys.stderr)
    sys.exit(1 if differences else 0)


if __name__ == "__main__":
    main()
