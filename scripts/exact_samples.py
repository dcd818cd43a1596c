#!/usr/bin/env python3
"""Evaluates the exact coefficients in a result file at sample points, as input of check_vtk.py.

    exact_samples.py RESULT > EXPECTED

Position and density are polynomials: they are sampled at VTK's lattice points and inside the cells. The velocity,
momentum / density, agrees with VTK's at the lattice points alone. Needs the Python packages h5py and numpy.

It reads the file as crates/output/FORMAT.md describes it, without the module stsolve and without VTK: a check of both.
"""

import argparse
import itertools
import json
import sys

import h5py
import numpy as np

# Reference points in [0, 1]^3 beside the lattice points.
INSIDE = [(0.13, 0.7, 0.4), (0.9, 0.2, 0.55)]


def gauss_lobatto(count):
    """The nodes in [-1, 1]: the ends and the roots of P'_(count-1)."""
    inner = np.polynomial.legendre.Legendre.basis(count - 1).deriv().roots()
    return np.concatenate([[-1.0], np.sort(inner.real), [1.0]])


def lagrange(nodes, x):
    """Values at x of the Lagrange polynomials of the nodes, [point][node]."""
    others = [np.delete(nodes, i) for i in range(len(nodes))]
    factors = [(np.asarray(x)[:, None] - o) / (node - o) for node, o in zip(nodes, others)]
    return np.stack([np.prod(factor, axis=1) for factor in factors], axis=1)


def shape_functions(order, points):
    """The nodal basis on Gauss-Lobatto nodes, [point][node], axis 0 fastest."""
    nodes, rows = gauss_lobatto(order), np.ones((len(points), 1))
    for axis in range(points.shape[1]):
        row = lagrange(nodes, points[:, axis])
        rows = (row[:, :, None] * rows[:, None, :]).reshape(len(points), -1)
    return rows


def values(coefficients, points):
    """A field with the coefficients [cell][component][node] at points of every cell, [cell][point][component]."""
    order = round(coefficients.shape[-1] ** (1 / points.shape[1]))
    return np.swapaxes(coefficients @ shape_functions(order, points).T, 1, 2)


def padded(vectors):
    """Vectors [point][component] with three components."""
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))


def step_samples(exact, step, points, lattice, drawn):
    """The samples of all cells at a step; the velocity at the first `lattice` points."""
    position, flow = exact["position"][step], exact["flow"][step][:, -1]
    dimension = position.shape[1]
    # The reference coordinates of VTK lie in [0, 1].
    reference = 2.0 * np.array(points)[:, :dimension] - 1.0
    samples = []
    for cell, (x, u) in enumerate(zip(values(position, reference), values(flow, reference))):
        x, velocity = padded(x), padded(u[:, 1 : 1 + dimension] / u[:, :1])
        for q, point in enumerate(points):
            fields = {"density": [u[q, 0]]} | ({"velocity": velocity[q].tolist()} if q < lattice else {})
            fields = {name: value for name, value in fields.items() if name in drawn}
            samples.append({"cell": cell, "reference": point, "point": x[q].tolist(), "fields": fields})
    return samples


def expected(path):
    """What a reader of the file must find, see check_vtk.py."""
    with h5py.File(path) as file:
        attributes, exact = file["stsolve"].attrs, file["stsolve/exact"]
        count, dimension = int(attributes["points_per_direction"]), int(attributes["dimension"])
        along = np.arange(count) / (count - 1)
        lattice = list(itertools.product(*([along if axis < dimension else [0.0] for axis in range(3)])))
        points, drawn = lattice + INSIDE, set(file["VTKHDF/PointData"])
        return {"steps": [{"time": time, "samples": step_samples(exact, step, points, len(lattice), drawn)}
                          for step, time in enumerate(file["VTKHDF/Steps/Values"][:])]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result")
    json.dump(expected(parser.parse_args().result), sys.stdout)


if __name__ == "__main__":
    main()
