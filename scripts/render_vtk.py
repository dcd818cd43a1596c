#!/usr/bin/env python3
"""Draws a field of a result file with VTK, off-screen, curved cells as curved, and keeps it as PNG.

    render_vtk.py RESULT PNG [--field mach] [--time T] [--range LOWER UPPER] [--window X0 Y0 X1 Y1] [--width 1000] [--level 4]
                  [--from X Y Z [--focus X Y Z] [--zoom Z]] [--title TITLE]

ParaView shows the same with a *Nonlinear Subdivision Level* of --level. Without --time the last step is drawn,
without --range the colours span the values, without --window the whole domain is shown. --from looks at the surface of a body in three
dimensions from that direction, in a light that shows its shape; --focus is the point in the middle of the picture. --title is written above, and
adds a bar of the colours. Needs the Python packages vtk (9.3 or newer) and numpy.
"""

import argparse

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from check_vtk import open_result, read_step

# Where nothing is drawn.
GROUND = (1.0, 1.0, 1.0)
# What the bar of the colours calls a field, unless it has a plain name.
NAMES = {"jacobian": "det J / det J_0", "mach": "Mach number"}


def viridis(count=240):
    """Colours from low to high, [colour][red, green, blue] in 0..255."""
    stops = np.array([(68, 1, 84), (65, 68, 135), (42, 120, 142), (34, 168, 132), (122, 209, 81), (253, 231, 37)])
    return spread(stops, count)


def spread(stops, count):
    """`count` colours from colours at equal distances, each that of the middle of its part."""
    places = (np.arange(count) + 0.5) / count * (len(stops) - 1)
    return np.stack([np.interp(places, np.arange(len(stops)), stops[:, i]) for i in range(3)], axis=1)


def surface(grid, level):
    """The cells, each cut into 2^level parts along its axes."""
    filtered = vtk.vtkDataSetSurfaceFilter()
    filtered.SetInputData(grid)
    filtered.SetNonlinearSubdivisionLevel(level)
    filtered.Update()
    return filtered.GetOutput()


def colours_of(colours, limits):
    table = vtk.vtkLookupTable()
    table.SetNumberOfTableValues(len(colours))
    for i, colour in enumerate(colours):
        table.SetTableValue(i, *(colour / 255.0), 1.0)
    table.SetTableRange(*limits)
    return table


def render(grid, field, limits, colours, window, size, level=4, ground=GROUND):
    """The picture, [row][column][red, green, blue] in 0..255, the first row on top. `window` is (x0, y0, x1, y1), `size` its
    pixels."""
    actor = coloured(grid, field, limits, colours, level)
    actor.GetProperty().LightingOff()
    renderer = scene(actor, ground)
    aim(renderer.GetActiveCamera(), window)
    renderer.ResetCameraClippingRange()
    return pixels(renderer, size)


def render_from(grid, limits, arguments):
    """As `render`, seen from a direction, with y upwards, in light."""
    actor = coloured(grid, arguments.field, limits, viridis(), arguments.level)
    actor.GetProperty().SetAmbient(0.35)
    renderer = scene(actor, GROUND)
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(0.0, 0.0, 0.0)
    camera.SetPosition(*arguments.direction)
    camera.SetViewUp(0.0, 1.0, 0.0)
    renderer.ResetCamera()
    if arguments.focus:
        look_at(camera, arguments.focus)
    camera.Zoom(arguments.zoom)
    if arguments.title:
        label(renderer, actor, arguments)
    return pixels(renderer, (arguments.width, arguments.width // 2))


def look_at(camera, focus):
    """Moves the camera, without turning it, until `focus` is in the middle."""
    shift = np.subtract(focus, camera.GetFocalPoint())
    camera.SetPosition(*np.add(camera.GetPosition(), shift))
    camera.SetFocalPoint(*focus)


def label(renderer, actor, arguments):
    """Writes the title above, and adds the bar of the colours on the right."""
    title = vtk.vtkTextActor()
    title.SetInput(arguments.title)
    title.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
    title.SetPosition(0.01, 0.93)
    plain(title.GetTextProperty(), 17)
    bar = vtk.vtkScalarBarActor()
    bar.SetLookupTable(actor.GetMapper().GetLookupTable())
    bar.SetTitle(NAMES.get(arguments.field, arguments.field))
    bar.SetNumberOfLabels(5)
    bar.SetLabelFormat("%.2f")
    bar.UnconstrainedFontSizeOn()
    for text in (bar.GetTitleTextProperty(), bar.GetLabelTextProperty()):
        plain(text, 14)
    bar.SetBarRatio(0.2)
    bar.SetPosition(0.85, 0.15)
    bar.SetWidth(0.13)
    bar.SetHeight(0.7)
    renderer.AddViewProp(title)
    renderer.AddViewProp(bar)


def plain(text, size):
    """Letters without ornament."""
    text.SetColor(0.1, 0.1, 0.1)
    text.SetFontSize(size)
    text.BoldOff()
    text.ItalicOff()
    text.ShadowOff()


def coloured(grid, field, limits, colours, level):
    """The surface, coloured by a field."""
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(surface(grid, level))
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray(field)
    mapper.InterpolateScalarsBeforeMappingOn()
    mapper.SetLookupTable(colours_of(colours, limits))
    mapper.UseLookupTableScalarRangeOn()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    return actor


def scene(actor, ground):
    renderer = vtk.vtkRenderer()
    renderer.AddActor(actor)
    renderer.SetBackground(*ground)
    return renderer


def aim(camera, window):
    """Looks along z at a window, in parallel."""
    x0, y0, x1, y1 = window
    centre = (0.5 * (x0 + x1), 0.5 * (y0 + y1))
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(*centre, 0.0)
    camera.SetPosition(*centre, 1.0)
    camera.SetParallelScale(0.5 * (y1 - y0))


def pixels(renderer, size):
    screen = vtk.vtkRenderWindow()
    screen.SetOffScreenRendering(1)
    screen.SetMultiSamples(0)
    screen.SetSize(*size)
    screen.AddRenderer(renderer)
    screen.Render()
    image = vtk.vtkWindowToImageFilter()
    image.SetInput(screen)
    image.ReadFrontBufferOff()
    image.Update()
    data = image.GetOutput()
    width, height, _ = data.GetDimensions()
    return vtk_to_numpy(data.GetPointData().GetScalars()).reshape(height, width, -1)[::-1, :, :3]


def write(picture, path):
    data = vtk.vtkImageData()
    height, width, _ = picture.shape
    data.SetDimensions(width, height, 1)
    data.AllocateScalars(vtk.VTK_UNSIGNED_CHAR, 3)
    vtk_to_numpy(data.GetPointData().GetScalars())[:] = picture[::-1].reshape(-1, 3)
    writer = vtk.vtkPNGWriter()
    writer.SetInputData(data)
    writer.SetFileName(path)
    writer.Write()


def render_window(grid, limits, arguments):
    x0, x1, y0, y1, _, _ = grid.GetBounds()
    window = arguments.window or (x0, y0, x1, y1)
    height = round(arguments.width * (window[3] - window[1]) / (window[2] - window[0]))
    return render(grid, arguments.field, limits, viridis(), window, (arguments.width, height), arguments.level)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result")
    parser.add_argument("picture")
    parser.add_argument("--field", default="mach")
    parser.add_argument("--time", type=float)
    parser.add_argument("--range", type=float, nargs=2)
    parser.add_argument("--window", type=float, nargs=4)
    parser.add_argument("--width", type=int, default=1000)
    parser.add_argument("--level", type=int, default=4)
    parser.add_argument("--from", type=float, nargs=3, dest="direction", metavar=("X", "Y", "Z"))
    parser.add_argument("--focus", type=float, nargs=3, metavar=("X", "Y", "Z"))
    parser.add_argument("--zoom", type=float, default=1.1)
    parser.add_argument("--title")
    arguments = parser.parse_args()
    reader, times = open_result(arguments.result)
    grid = read_step(reader, times[-1] if arguments.time is None else arguments.time)
    values = grid.GetPointData().GetArray(arguments.field)
    if values is None:
        names = [grid.GetPointData().GetArrayName(i) for i in range(grid.GetPointData().GetNumberOfArrays())]
        parser.error(f"no field {arguments.field}; there are {', '.join(names)}")
    limits = arguments.range or values.GetRange()
    if arguments.direction:
        picture = render_from(grid, limits, arguments)
    else:
        picture = render_window(grid, limits, arguments)
    write(picture, arguments.picture)


if __name__ == "__main__":
    main()
