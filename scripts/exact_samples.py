#!/usr/bin/env python3
"""Evaluates the exact coefficients in a result file at sample points, as input of check_vtk.py.

    exact_samples.py RESULT > EXPECTED

Position and density are polynomials: they are sampled at VTK's lattice points and inside of the cells. The velocity,
momentum / density, is what VTK draws at the lattice points alone. Needs the Python packages h5py and numpy.
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
    """Values at x of the Lagrange polynomials of the nodes, [node]."""
    others = [np.delete(nodes, i) for i in range(len(nodes))]
    return np.array([np.prod((x - o) / (node - o)) for node, o in zip(nodes, others)])


def shape_functions(order, dimension, points):
    """Values of the nodal basis on Gauss-Lobatto nodes at points in [0, 1]^3, [point][node], axis 0 fastest."""
    nodes = gauss_lobatto(order)
    rows = []
    for point in points:
        row = np.ones(1)
        for axis in range(dimension):
            row = np.outer(lagrange(nodes, 2.0 * point[axis] - 1.0), row).ravel()
        rows.append(row)
    return np.array(rows)


def padded(vectors):
    """Vectors [point][component] with three components."""
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))


def step_samples(exact, step, dimension, points, lattice, drawn):
    """The samples of all cells at a step; the velocity at the first `lattice` points."""
    order = lambda name: round(exact[name].shape[-1] ** (1 / dimension))
    to_points = {name: shape_functions(order(name), dimension, points).T for name in ("position", "flow")}
    # The end of a slab is its last time node.
    position, flow = exact["position"][step], exact["flow"][step][:, -1]
    samples = []
    for cell in range(len(position)):
        x = padded((position[cell] @ to_points["position"]).T)
        u = (flow[cell] @ to_points["flow"]).T
        velocity = padded(u[:, 1 : 1 + dimension] / u[:, :1])
        for q, reference in enumerate(points):
            fields = {"density": [u[q, 0]]} | ({"velocity": velocity[q].tolist()} if q < lattice else {})
            fields = {name: value for name, value in fields.items() if name in drawn}
            samples.append({"cell": cell, "reference": reference, "point": x[q].tolist(), "fields": fields})
    return samples


def expected(path):
    """What a reader of the file must find, see check_vtk.py."""
    with h5py.File(path) as file:
        attributes, exact = file["stsolve"].attrs, file["stsolve/exact"]
        dimension, count = int(attributes["dimension"]), int(attributes["points_per_direction"])
        along = np.arange(count) / (count - 1)
        axes = [along if axis < dimension else [0.0] for axis in range(3)]
        lattice = list(itertools.product(*axes))
        points = lattice + INSIDE
        times, drawn = file["VTKHDF/Steps/Values"][:], set(file["VTKHDF/PointData"])
        return {"steps": [{"time": time, "samples": step_samples(exact, step, dimension, points, len(lattice), drawn)}
                          for step, time in enumerate(times)]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result")
    json.dump(expected(parser.parse_args().result), sys.stdout)


if __name__ == "__main__":
    main()
