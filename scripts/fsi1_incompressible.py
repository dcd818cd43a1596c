#!/usr/bin/env python3
"""FSI1 of Turek & Hron in an incompressible fluid, by a method that shares nothing with stsolve.

    python3 -m venv venv && venv/bin/pip install gmsh meshio scikit-fem pypardiso
    venv/bin/python scripts/fsi1_incompressible.py [SIZE]        size of the cells, default 0.85; 2 takes a minute

Steady flow by Taylor-Hood elements P2/P1 on triangles with curved sides; a St. Venant-Kirchhoff flag by P2 elements, in plane strain; the mesh
of the flow follows by linear elasticity. Flow and flag take turns until they agree, with Aitken's relaxation. The loads on the flag are the
residual of the momentum equation at its nodes. The cells are smallest at the corners of the flag, where stress and friction are singular.

Prints the flag under its weight (CSM1), the flow around a rigid flag (CFD1), and the flow that bends the flag (FSI1). Displacements are in mm.
"""

import os
import sys
import tempfile

import gmsh
import meshio
import numpy as np
import skfem
from pypardiso import spsolve
from skfem.helpers import ddot, dot, eye, grad, identity, mul, sym_grad, trace, transpose
from skfem.io import from_meshio

LENGTH, HEIGHT, CENTRE, RADIUS, THICKNESS, END = 2.5, 0.41, 0.2, 0.05, 0.02, 0.6
ROOT = CENTRE + np.sqrt(RADIUS**2 - (THICKNESS / 2) ** 2)
DENSITY, VISCOSITY, MEAN, GRAVITY = 1000, 1, 0.2, 2
SHEAR_MODULUS, POISSON_RATIO = 0.5e6, 0.4
LAME = 2 * SHEAR_MODULUS * POISSON_RATIO / (1 - 2 * POISSON_RATIO)
CORNER, ALONG_FLAG, ALONG_CYLINDER, FAR = 3e-5, 2.5e-3, 4e-3, 0.03
FLUID, SOLID = 1, 2


def make_mesh(size):
    """Triangles of degree 2: those of the fluid, and those of the flag."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    shape = gmsh.model.geo

    def points(places):
        return [shape.addPoint(x, y, 0) for x, y in places]

    half = THICKNESS / 2
    centre, north, west, south, east = points(CENTRE + RADIUS * np.array([(0, 0), (0, 1), (-1, 0), (0, -1), (1, 0)]))
    upper, lower = points([(ROOT, CENTRE + half), (ROOT, CENTRE - half)])
    tip = points([(END, CENTRE - half), (END, CENTRE), (END, CENTRE + half)])
    corners = points([(0, 0), (LENGTH, 0), (LENGTH, HEIGHT), (0, HEIGHT)])
    arcs = [(upper, north), (north, west), (west, south), (south, lower)]
    cylinder = [shape.addCircleArc(a, centre, b) for a, b in arcs]
    root = [shape.addCircleArc(lower, centre, east), shape.addCircleArc(east, centre, upper)]
    flag = [shape.addLine(a, b) for a, b in zip([lower, *tip], [*tip, upper])]
    walls = [shape.addLine(corners[k], corners[(k + 1) % 4]) for k in range(4)]
    fluid = shape.addPlaneSurface([shape.addCurveLoop(walls), shape.addCurveLoop(flag + cylinder)])
    solid = shape.addPlaneSurface([shape.addCurveLoop(flag + [-root[1], -root[0]])])
    shape.synchronize()
    gmsh.model.addPhysicalGroup(2, [fluid], FLUID)
    gmsh.model.addPhysicalGroup(2, [solid], SOLID)
    sharp = [upper, lower, tip[0], tip[2]]
    set_sizes(size, [(sharp, [], CORNER, 0.15), ([], flag, ALONG_FLAG, 0.1), ([], cylinder, ALONG_CYLINDER, 0.1)])
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(2)
    with tempfile.TemporaryDirectory() as directory:
        path = os.path.join(directory, "fsi1.msh")
        gmsh.write(path)
        gmsh.finalize()
        read = meshio.read(path)
    kinds, triangles = read.cell_data_dict["gmsh:physical"]["triangle6"], read.cells_dict["triangle6"]
    return [part(read.points, triangles[kinds == kind]) for kind in (FLUID, SOLID)]


def part(points, triangles):
    """The mesh of some triangles, without the points of others."""
    used, numbers = np.unique(triangles, return_inverse=True)
    return from_meshio(meshio.Mesh(points[used, :2], [("triangle6", numbers.reshape(triangles.shape))]))


def set_sizes(size, near):
    """Cells that grow with the distance from points and curves."""
    field, fields = gmsh.model.mesh.field, []
    for points, curves, least, growth in near:
        distance, formula = field.add("Distance"), field.add("MathEval")
        field.setNumbers(distance, "PointsList", points)
        field.setNumbers(distance, "CurvesList", curves)
        field.setNumber(distance, "Sampling", 400)
        field.setString(formula, "F", f"min({least} + {growth}*F{distance}, {FAR})*{size}")
        fields.append(formula)
    least = field.add("Min")
    field.setNumbers(least, "FieldsList", fields)
    field.setAsBackgroundMesh(least)
    for option in ["MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"]:
        gmsh.option.setNumber(f"Mesh.{option}", 0)


def solved(matrix, right, free):
    """The solution of the rows and columns `free`; zero elsewhere."""
    x = np.zeros(len(right))
    x[free] = spsolve(matrix[free][:, free].tocsr(), right[free])
    return x


@skfem.BilinearForm
def momentum_jacobian(u, v, w):
    convection = mul(grad(u), w.u) + mul(grad(w.u), u)
    return DENSITY * dot(convection, v) + VISCOSITY * ddot(grad(u), grad(v))


@skfem.BilinearForm
def divergence(u, q, _):
    return -trace(grad(u)) * q


@skfem.LinearForm
def momentum(v, w):
    # At walls at rest the transposed gradient has no traction, and with this form parallel flow leaves the channel undisturbed.
    return DENSITY * dot(mul(grad(w.u), w.u), v) + VISCOSITY * ddot(grad(w.u), grad(v))


class Flow:
    """The flow on a mesh that is moved. Its unknowns are velocities, then pressures."""

    def __init__(self, mesh):
        self.mesh = mesh
        self.place(mesh)
        self.x, self.y = self.velocity.doflocs
        self.boundary = self.velocity.get_dofs().all()
        on_wall = np.isclose(self.y, 0) | np.isclose(self.y, HEIGHT)
        leaves = np.isclose(self.x, LENGTH) & ~on_wall
        fixed = self.boundary[~leaves[self.boundary]]
        self.free = np.setdiff1d(np.arange(self.velocity.N + self.pressure.N), fixed)
        self.solution = np.zeros(self.velocity.N + self.pressure.N)
        along_x = self.velocity.split_indices()[0]
        enters = along_x[np.isclose(self.x[along_x], 0)]
        self.solution[enters] = 6 * MEAN * self.y[enters] * (HEIGHT - self.y[enters]) / HEIGHT**2

    def place(self, mesh):
        self.velocity = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementTriP2()), intorder=6)
        self.pressure = self.velocity.with_element(skfem.ElementTriP1())

    def solve(self):
        n, coupling = self.velocity.N, divergence.assemble(self.velocity, self.pressure)
        for _ in range(20):
            u, p = self.solution[:n], self.solution[n:]
            at = self.velocity.interpolate(u)
            rows = [[momentum_jacobian.assemble(self.velocity, u=at), coupling.T], [coupling, None]]
            self.residual = momentum.assemble(self.velocity, u=at) + coupling.T @ p
            jacobian, residual = skfem.bmat(rows).tocsr(), np.concatenate([self.residual, coupling @ u])
            step = solved(jacobian, -residual, self.free)
            self.solution += step
            if np.abs(step[:n]).max() < 1e-11:
                return

    def forces(self):
        """The forces of the fluid on the nodes of its boundary."""
        return -self.residual

    def drag_and_lift(self):
        is_body = (np.abs(self.x - 0.35) < 0.3) & (np.abs(self.y - CENTRE) < 0.1)
        on_body = self.boundary[is_body[self.boundary]]
        return tuple(self.forces()[np.intersect1d(on_body, part)].sum() for part in self.velocity.split_indices())


def stress(u):
    """F, and S = 2 mu E + lambda tr E."""
    f = grad(u) + identity(u)
    strain = 0.5 * (mul(transpose(f), f) - identity(u))
    return f, 2 * SHEAR_MODULUS * strain + eye(LAME * trace(strain), 2)


@skfem.LinearForm
def internal_force(v, w):
    return ddot(mul(*stress(w.u)), grad(v))


@skfem.BilinearForm
def stiffness(u, v, w):
    f, s = stress(w.u)
    strain = 0.5 * (mul(transpose(f), grad(u)) + mul(transpose(grad(u)), f))
    change = 2 * SHEAR_MODULUS * strain + eye(LAME * trace(strain), 2)
    return ddot(mul(grad(u), s) + mul(f, change), grad(v))


@skfem.LinearForm
def weight(v, _):
    return -DENSITY * GRAVITY * v[1]


class Flag:
    """The flag, with St. Venant-Kirchhoff's law."""

    def __init__(self, mesh):
        self.basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementTriP2()), intorder=6)
        x, y = self.basis.doflocs
        boundary = self.basis.get_dofs().all()
        fixed = boundary[np.hypot(x[boundary] - CENTRE, y[boundary] - CENTRE) < RADIUS * (1 + 1e-6)]
        self.free = np.setdiff1d(np.arange(self.basis.N), fixed)
        self.displacement = np.zeros(self.basis.N)
        self.tip = np.flatnonzero(np.isclose(x, END) & np.isclose(y, CENTRE))

    def solve(self, load):
        """The equilibrium with the `load`, from the displacement before."""
        for _ in range(30):
            at = self.basis.interpolate(self.displacement)
            out_of_balance = load - internal_force.assemble(self.basis, u=at)
            step = solved(stiffness.assemble(self.basis, u=at), out_of_balance, self.free)
            self.displacement += step
            if np.abs(step).max() < 1e-13:
                return

    def tip_in_mm(self):
        return tuple(1e3 * self.displacement[self.tip])


@skfem.BilinearForm
def mesh_stiffness(u, v, w):
    return (2 * ddot(sym_grad(u), sym_grad(v)) + trace(grad(u)) * trace(grad(v))) / w.h**2


class Follower:
    """The mesh of the flow as an elastic body, stiff where cells are small."""

    def __init__(self, flow):
        self.matrix, self.mesh = mesh_stiffness.assemble(flow.velocity), flow.mesh
        self.free = np.setdiff1d(np.arange(flow.velocity.N), flow.boundary)
        places, self.nodes = keys(flow.mesh.doflocs), []
        for part in flow.velocity.split_indices():
            order = np.argsort(keys(flow.velocity.doflocs[:, part]))
            sorted_places = keys(flow.velocity.doflocs[:, part])[order]
            self.nodes.append(part[order[np.searchsorted(sorted_places, places)]])

    def moved(self, boundary):
        """The mesh with the displacement `boundary` there."""
        d = boundary + solved(self.matrix, -self.matrix @ boundary, self.free)
        return type(self.mesh)(self.mesh.doflocs + np.array([d[nodes] for nodes in self.nodes]), self.mesh.t)


def keys(x):
    """Places as numbers that can be sorted."""
    return np.round(x[0], 10) + 1j * np.round(x[1], 10)


def shared(flow, flag):
    """The unknowns of flow and flag at the same places."""
    pairs = []
    for of_flow, of_flag in zip(flow.velocity.split_indices(), flag.basis.split_indices()):
        there = dict(zip(keys(flag.basis.doflocs[:, of_flag]), of_flag))
        on_boundary = np.intersect1d(of_flow, flow.boundary)
        places = keys(flow.velocity.doflocs[:, on_boundary])
        pairs += [(k, there[place]) for k, place in zip(on_boundary, places) if place in there]
    return np.array(pairs).T


def equilibrium(flow, flag):
    """Flow and flag in turns."""
    follower, (of_flow, of_flag) = Follower(flow), shared(flow, flag)
    factor, before = 0.6, None
    for _ in range(30):
        load, boundary, start = np.zeros(flag.basis.N), np.zeros(flow.velocity.N), flag.displacement.copy()
        load[of_flag] = flow.forces()[of_flow]
        flag.solve(load)
        change = flag.displacement - start
        if before is not None:
            difference = change - before
            factor *= -(before @ difference) / (difference @ difference)
        before = change
        flag.displacement = start + factor * change
        boundary[of_flow] = flag.displacement[of_flag]
        flow.place(follower.moved(boundary))
        flow.solve()
        if np.abs(change).max() < 1e-11:
            return


def main():
    size = float(sys.argv[1]) if len(sys.argv) > 1 else 0.85
    fluid_mesh, solid_mesh = make_mesh(size)
    flow, flag = Flow(fluid_mesh), Flag(solid_mesh)
    print(f"{fluid_mesh.nelements} cells of the flow, {solid_mesh.nelements} of the flag, {len(flow.solution)} unknowns of the flow")
    for part in np.linspace(0.2, 1, 5):
        flag.solve(part * weight.assemble(flag.basis))
    print("CSM1  tip %.5f %.5f" % flag.tip_in_mm())
    flag.displacement[:] = 0
    flow.solve()
    print("CFD1  drag %.5f  lift %.5f" % flow.drag_and_lift(), flush=True)
    equilibrium(flow, flag)
    print("FSI1  tip %.6f %.5f" % flag.tip_in_mm() + "  drag %.5f  lift %.5f" % flow.drag_and_lift())


if __name__ == "__main__":
    main()
