#!/usr/bin/env python3
"""Writes the Gmsh files that the tests of the mesh reader compare.

    python -m pip install gmsh
    scripts/make_gmsh_meshes.py DIRECTORY
    STSOLVE_GMSH_MESHES=DIRECTORY cargo test -p mesh -p cgns gmsh

Each shape is written in every degree that Gmsh has (tetrahedra up to 6), as MSH 2.2 and 4.1, as text and binary:

    SHAPE_DIMENSION_pDEGREE_vVERSION_ENCODING.msh

and up to degree 4, prisms up to 2, as CGNS, SHAPE_DIMENSION_pDEGREE.cgns:

quarter   a quarter of the annulus 1 < r < 2, 3 x 4 quadrilaterals in a pattern; in space 0 < z < 1 in two layers.
          Boundaries "inner", "outer", "right" (y = 0), "left" (x = 0), "front", "back"
turned    the same in the plane with the surface's normal downwards: left-handed cells
disc      the unit disc, quadrilaterals without a pattern, boundary "wall"; in space extruded
triangles the unit disc
prisms    the disc extruded, triangles in the plane
tetrahedra
          the disc extruded
mixed     the unit square or cube, quadrilaterals on the left and triangles on the right; in space prisms and hexahedra
periodic  the unit square or cube, opposite sides periodic in x: "left", "right", "walls"
"""

import sys
from pathlib import Path

import gmsh


def physical(dimension, names):
    """Names groups of entities; the cells are the group "fluid"."""
    for name, entities in names.items():
        gmsh.model.addPhysicalGroup(dimension - 1, entities, name=name)
    cells = [tag for _, tag in gmsh.model.getEntities(dimension)]
    gmsh.model.addPhysicalGroup(dimension, cells, name="fluid")


def names_by_place(dimension, place):
    """Groups of the boundary entities by what `place` says of their bounding boxes."""
    names = {}
    for _, tag in gmsh.model.getBoundary(gmsh.model.getEntities(dimension), oriented=False):
        name = place(gmsh.model.getBoundingBox(dimension - 1, tag))
        names.setdefault(name, []).append(tag)
    return names


def in_space(dimension, layers, structured=True):
    if dimension == 3:
        layers = dict(numElements=[layers], recombine=True) if structured else {}
        gmsh.model.geo.extrude(gmsh.model.getEntities(2), 0, 0, 1, **layers)
        gmsh.model.geo.synchronize()


def quarter(dimension, turned=False):
    geo = gmsh.model.geo
    centre = geo.addPoint(0, 0, 0)
    a, b, c, d = (geo.addPoint(*x, 0) for x in [(1, 0), (2, 0), (0, 2), (0, 1)])
    lines = [geo.addLine(a, b), geo.addCircleArc(b, centre, c), geo.addLine(c, d), geo.addCircleArc(d, centre, a)]
    loop = geo.addCurveLoop([-line for line in reversed(lines)] if turned else lines)
    surface = geo.addPlaneSurface([loop])
    for line, cells in zip(lines, (3, 4, 3, 4)):
        geo.mesh.setTransfiniteCurve(line, cells + 1)
    geo.mesh.setTransfiniteSurface(surface, cornerTags=[a, b, c, d])
    geo.mesh.setRecombine(2, surface)
    geo.synchronize()
    in_space(dimension, 2)

    def place(box):
        x0, y0, z0, x1, y1, z1 = box
        if dimension == 3 and z1 - z0 < 0.1:
            return "front" if z0 < 0.5 else "back"
        if y1 - y0 < 0.1:
            return "right"
        if x1 - x0 < 0.1:
            return "left"
        return "outer" if max(x1, y1) > 1.5 else "inner"

    physical(dimension, names_by_place(dimension, place))


def disc(dimension, recombined=True, layers=True):
    geo = gmsh.model.geo
    centre = geo.addPoint(0, 0, 0)
    points = [geo.addPoint(*x, 0, 0.7) for x in [(1, 0), (0, 1), (-1, 0), (0, -1)]]
    arcs = [geo.addCircleArc(points[i], centre, points[(i + 1) % 4]) for i in range(4)]
    surface = geo.addPlaneSurface([geo.addCurveLoop(arcs)])
    if recombined:
        geo.mesh.setRecombine(2, surface)
        # Every triangle and quadrilateral is split into quadrilaterals: none but these are left.
        gmsh.option.setNumber("Mesh.SubdivisionAlgorithm", 1)
    geo.synchronize()
    in_space(dimension, 1, layers)
    physical(dimension, names_by_place(dimension, lambda box: "ends" if dimension == 3 and box[5] - box[2] < 0.1 else "wall"))


def periodic(dimension):
    geo = gmsh.model.geo
    points = [geo.addPoint(*x, 0) for x in [(0, 0), (1, 0), (1, 1), (0, 1)]]
    lines = [geo.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
    surface = geo.addPlaneSurface([geo.addCurveLoop(lines)])
    for line, cells in zip(lines, (3, 2, 3, 2)):
        geo.mesh.setTransfiniteCurve(line, cells + 1)
    geo.mesh.setTransfiniteSurface(surface)
    geo.mesh.setRecombine(2, surface)
    geo.synchronize()
    in_space(dimension, 1)

    def place(box):
        return "walls" if box[3] - box[0] > 0.1 else ("left" if box[0] < 0.5 else "right")

    names = names_by_place(dimension, place)
    shift = [1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
    gmsh.model.mesh.setPeriodic(dimension - 1, names["right"], names["left"], shift)
    physical(dimension, names)


def mixed(dimension):
    geo = gmsh.model.geo
    points = [geo.addPoint(*x, 0, 0.4) for x in [(0, 0), (0.5, 0), (1, 0), (1, 1), (0.5, 1), (0, 1)]]
    lines = [geo.addLine(points[i], points[(i + 1) % 6]) for i in range(6)]
    middle = geo.addLine(points[1], points[4])
    left = geo.addPlaneSurface([geo.addCurveLoop([lines[0], middle, lines[4], lines[5]])])
    geo.addPlaneSurface([geo.addCurveLoop([lines[1], lines[2], lines[3], -middle])])
    for line, cells in ((lines[0], 2), (middle, 3), (lines[4], 2), (lines[5], 3)):
        geo.mesh.setTransfiniteCurve(line, cells + 1)
    geo.mesh.setTransfiniteSurface(left)
    geo.mesh.setRecombine(2, left)
    geo.synchronize()
    in_space(dimension, 2)
    outer = gmsh.model.getBoundary(gmsh.model.getEntities(dimension), oriented=False, combined=True)
    physical(dimension, {"walls": [tag for _, tag in outer]})


SHAPES = {
    "quarter": (quarter, (2, 3)),
    "turned": (lambda dimension: quarter(dimension, turned=True), (2,)),
    "disc": (disc, (2, 3)),
    "triangles": (lambda dimension: disc(dimension, recombined=False), (2,)),
    "prisms": (lambda dimension: disc(dimension, recombined=False), (3,)),
    "tetrahedra": (lambda dimension: disc(dimension, recombined=False, layers=False), (3,)),
    "mixed": (mixed, (2, 3)),
    "periodic": (periodic, (2, 3)),
}


def write(directory, shape, dimension, degree):
    gmsh.clear()
    gmsh.option.setNumber("Mesh.SubdivisionAlgorithm", 0)
    SHAPES[shape][0](dimension)
    gmsh.model.mesh.generate(dimension)
    gmsh.model.mesh.setOrder(degree)
    for version in (2.2, 4.1):
        for binary, encoding in ((0, "text"), (1, "binary")):
            gmsh.option.setNumber("Mesh.MshFileVersion", version)
            gmsh.option.setNumber("Mesh.Binary", binary)
            gmsh.write(str(directory / f"{shape}_{dimension}_p{degree}_v{version}_{encoding}.msh"))
    # Gmsh writes prisms as CGNS up to degree 2.
    if degree <= (2 if dimension == 3 and shape in ("prisms", "mixed") else 4):
        gmsh.write(str(directory / f"{shape}_{dimension}_p{degree}.cgns"))


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    directory = Path(sys.argv[1])
    directory.mkdir(parents=True, exist_ok=True)
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    for shape, (_, dimensions) in SHAPES.items():
        for dimension in dimensions:
            # Gmsh has hexahedra up to degree 9; its curved tetrahedra are accurate to 1e-6, which degree 6 reaches.
            highest = 6 if shape == "tetrahedra" else 10 if dimension == 2 else 9
            for degree in range(1, highest + 1):
                write(directory, shape, dimension, degree)
    gmsh.finalize()
    print(f"{len(list(directory.glob('*.msh')))} files in {directory}")


if __name__ == "__main__":
    main()
