"""Reads a result file of stsolve exactly: its coefficients, and their values at any points of the reference cell.

    from read_result import Result

    with Result("result.vtkhdf") as result:
        step = result.step_at(0.5)
        x = result.values("position", step, [(0.0, 0.0), (1.0, -1.0)])      # [cell][point][component]
        ratio = result.determinants(step, points) / result.determinants(0, points)

Reference coordinates lie in [-1, 1], as in crates/output/FORMAT.md. Needs the Python packages h5py and numpy.
"""

import itertools
import pathlib

import h5py
import numpy as np


def gauss_lobatto(count):
    """The nodes in [-1, 1]: the ends and the roots of P'_(count-1)."""
    inner = np.polynomial.legendre.Legendre.basis(count - 1).deriv().roots()
    return np.concatenate([[-1.0], np.sort(inner.real), [1.0]])


def lagrange(nodes, x):
    """Values at x of the Lagrange polynomials of the nodes, [point][node]."""
    others = [np.delete(nodes, i) for i in range(len(nodes))]
    factors = [(np.asarray(x)[:, None] - o) / (node - o) for node, o in zip(nodes, others)]
    return np.stack([np.prod(factor, axis=1) for factor in factors], axis=1)


def differentiation(nodes):
    """Derivatives at the nodes of the Lagrange polynomials of the nodes, [point][node]."""
    differences = nodes[:, None] - nodes + np.eye(len(nodes))
    weights = 1.0 / np.prod(differences, axis=1)
    matrix = weights / weights[:, None] / differences
    np.fill_diagonal(matrix, 0.0)
    return matrix - np.diag(matrix.sum(axis=1))


def lattice(points, dimension):
    """All points of [-1, 1]^dimension with coordinates in `points`, axis 0 fastest."""
    return np.array([p[::-1] for p in itertools.product(points, repeat=dimension)])


def shape_functions(order, points, along=None):
    """The nodal basis on Gauss-Lobatto nodes, or its derivative along an axis, [point][node], axis 0 fastest."""
    points, nodes = np.atleast_2d(points), gauss_lobatto(order)
    rows = np.ones((len(points), 1))
    for axis in range(points.shape[1]):
        row = lagrange(nodes, points[:, axis])
        if axis == along:
            row = row @ differentiation(nodes)
        rows = (row[:, :, None] * rows[:, None, :]).reshape(len(points), -1)
    return rows


class Result:
    """A result file, open for reading."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        self.file = h5py.File(path)
        self.attributes, self.exact = self.file["stsolve"].attrs, self.file["stsolve/exact"]
        self.dimension = int(self.attributes["dimension"])
        self.times = self.file["VTKHDF/Steps/Values"][:]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.file.close()

    def step_at(self, time):
        """The step whose time is nearest."""
        return int(np.argmin(np.abs(self.times - time)))

    def order(self, name):
        """Nodes per direction of a field."""
        return round(self.exact[name].shape[-1] ** (1 / self.dimension))

    def coefficients(self, name, step):
        """Values at the nodes, [cell][component][node]; of a field in time, those at the top of the slab."""
        values = self.exact[name][step]
        return values[:, -1] if values.ndim == 4 else values

    def values(self, name, step, points):
        """A field at points of every cell, [cell][point][component]."""
        basis = shape_functions(self.order(name), points)
        return np.swapaxes(self.coefficients(name, step) @ basis.T, 1, 2)

    def jacobians(self, step, points):
        """dx_i / dxi_j at points of every cell, [cell][point][i][j]."""
        x, order = self.coefficients("position", step), self.order("position")
        columns = [x @ shape_functions(order, points, along).T for along in range(self.dimension)]
        return np.transpose(np.stack(columns, axis=-1), (0, 2, 1, 3))

    def determinants(self, step, points):
        """det J at points of every cell, [cell][point]."""
        return np.linalg.det(self.jacobians(step, points))
