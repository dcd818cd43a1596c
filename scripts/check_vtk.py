#!/usr/bin/env python3
"""Opens a result file with VTK's own reader and compares it with known values.

    check_vtk.py RESULT EXPECTED [--tolerance 1e-12]

EXPECTED is JSON:

    { "steps": [ { "time": t, "samples": [ { "cell": c, "reference": [r, s, t],
                                             "point": [x, y, z], "fields": { name: [value, ...] } } ] } ],
      "node_orders": [ { "dimension": d, "points_per_direction": n, "order": [...] } ] }

with reference coordinates in [0, 1]. "node_orders" may be absent: there, entry q of "order" is VTK's number of the
lattice point with lexicographic number q, compared with VTK's own numbering. Needs the Python packages vtk (9.3 or
newer) and numpy. Exits with 1 and says what differs if anything does.
"""

import argparse
import json
import sys

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy


def open_result(path):
    """The reader and the times of its steps."""
    reader = vtk.vtkHDFReader()
    if not reader.CanReadFile(path):
        sys.exit(f"{path}: VTK cannot read this file")
    reader.SetFileName(path)
    reader.UpdateInformation()
    information, key = reader.GetOutputInformation(0), vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS()
    return reader, list(information.Get(key)) if information.Has(key) else []


def read_step(reader, time):
    """The unstructured grid at a time."""
    reader.UpdateTimeStep(time)
    grid = reader.GetOutputDataObject(0)
    return grid.GetPartition(0) if grid.IsA("vtkPartitionedDataSet") else grid


def evaluate(grid, cell_number, reference):
    """Position and fields at a reference point of a cell, by VTK's interpolation."""
    cell = grid.GetCell(cell_number)
    position, weights = [0.0] * 3, [0.0] * cell.GetNumberOfPoints()
    cell.EvaluateLocation(vtk.reference(0), reference, position, weights)
    nodes = [cell.GetPointId(i) for i in range(cell.GetNumberOfPoints())]
    arrays = grid.GetPointData()
    values = {arrays.GetArrayName(i): np.dot(weights, vtk_to_numpy(arrays.GetArray(i))[nodes])
              for i in range(arrays.GetNumberOfArrays())}
    return np.array(position), {name: np.atleast_1d(value) for name, value in values.items()}


def step_errors(grid, samples):
    """Largest error of the geometry and of each field in a step."""
    errors = {}
    for sample in samples:
        position, fields = evaluate(grid, sample["cell"], sample["reference"])
        pairs = [("geometry", position, sample["point"])]
        pairs += [(name, fields[name], value) for name, value in sample["fields"].items()]
        for name, found, expected in pairs:
            error = np.abs(found - np.array(expected)).max()
            errors[name] = max(errors.get(name, 0.0), error)
    return errors


def vtk_numbering(dimension, points):
    """VTK's number of every lattice point of a cell, axis 0 fastest."""
    p, lattice = points - 1, range(points)
    if dimension == 2:
        index = vtk.vtkHigherOrderQuadrilateral.PointIndexFromIJK
        return [index(i, j, (p, p)) for j in lattice for i in lattice]
    index = vtk.vtkHigherOrderHexahedron.PointIndexFromIJK
    return [index(i, j, k, (p, p, p)) for k in lattice for j in lattice for i in lattice]


def check(path, expected, tolerance):
    """All that differs, as lines of text."""
    reader, times = open_result(path)
    wanted = [step["time"] for step in expected["steps"]]
    if times != wanted:
        return [f"times are {times}, expected {wanted}"]
    differences = []
    for step in expected["steps"]:
        errors = step_errors(read_step(reader, step["time"]), step["samples"])
        print(f"t = {step['time']}:", ", ".join(f"{name} {error:.1e}" for name, error in sorted(errors.items())))
        differences += [f"t = {step['time']}: error of {name} is {error:.1e}, at most {tolerance:.0e} is accepted"
                        for name, error in errors.items() if not error <= tolerance]
    for numbering in expected.get("node_orders", []):
        dimension, points = numbering["dimension"], numbering["points_per_direction"]
        if numbering["order"] != vtk_numbering(dimension, points):
            differences.append(f"numbering in {dimension} dimensions with {points} points per direction")
    return differences


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result")
    parser.add_argument("expected")
    parser.add_argument("--tolerance", type=float, default=1e-12)
    arguments = parser.parse_args()
    with open(arguments.expected, encoding="utf-8") as file:
        expected = json.load(file)
    differences = check(arguments.result, expected, arguments.tolerance)
    for difference in differences:
        print(f"{arguments.result}: {difference}", file=sys.stderr)
    if not differences:
        print(f"{arguments.result}: VTK {vtk.vtkVersion.GetVTKVersion()} agrees in {len(expected['steps'])} steps "
              f"and {len(expected.get('node_orders', []))} numberings")
    sys.exit(1 if differences else 0)


if __name__ == "__main__":
    main()
