#!/usr/bin/env python3
"""Evaluates the exact coefficients in a result file at sample points, as input of check_vtk.py.

    exact_samples.py RESULT > EXPECTED

Position and density are polynomials: they are sampled at VTK's lattice points and inside the cells. The velocity,
momentum / density, agrees with VTK's at the lattice points alone. Needs the Python packages h5py and numpy.
"""

import argparse
import itertools
import json
import sys

import numpy as np
from read_result import Result

# Reference points in [0, 1]^3 beside the lattice points.
INSIDE = [(0.13, 0.7, 0.4), (0.9, 0.2, 0.55)]


def padded(vectors):
    """Vectors [point][component] with three components."""
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))


def step_samples(result, step, points, lattice, drawn):
    """The samples of all cells at a step; the velocity at the first `lattice` points."""
    # The reference coordinates of VTK lie in [0, 1].
    reference = 2.0 * np.array(points)[:, : result.dimension] - 1.0
    positions, flow = (result.values(name, step, reference) for name in ("position", "flow"))
    samples = []
    for cell, (x, u) in enumerate(zip(positions, flow)):
        x, velocity = padded(x), padded(u[:, 1 : 1 + result.dimension] / u[:, :1])
        for q, point in enumerate(points):
            fields = {"density": [u[q, 0]]} | ({"velocity": velocity[q].tolist()} if q < lattice else {})
            fields = {name: value for name, value in fields.items() if name in drawn}
            samples.append({"cell": cell, "reference": point, "point": x[q].tolist(), "fields": fields})
    return samples


def expected(path):
    """What a reader of the file must find, see check_vtk.py."""
    with Result(path) as result:
        count = int(result.attributes["points_per_direction"])
        along = np.arange(count) / (count - 1)
        axes = [along if axis < result.dimension else [0.0] for axis in range(3)]
        lattice = list(itertools.product(*axes))
        points, drawn = lattice + INSIDE, set(result.file["VTKHDF/PointData"])
        return {"steps": [{"time": time, "samples": step_samples(result, step, points, len(lattice), drawn)}
                          for step, time in enumerate(result.times)]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result")
    json.dump(expected(parser.parse_args().result), sys.stdout)


if __name__ == "__main__":
    main()
