"""Coarse versions of shipped cases, which run in seconds."""

from pathlib import Path

CASES = Path(__file__).resolve().parents[2] / "cases"

VORTEX = {"flow.order": 4, "mesh.order": 4, "mesh.generate.box.cells": [6, 6], "time.end": 0.5, "time.step": 0.125}

HEAVE = {
    "mesh.order": 4,
    "mesh.generate.airfoil.surface_cells": 10,
    "mesh.generate.airfoil.wake_cells": 6,
    "mesh.generate.airfoil.near_wake": {"extent": 2, "cells": 4},
    "mesh.generate.airfoil.normal_cells": 8,
    "mesh.generate.airfoil.near_wall": {"extent": 0.6, "cells": 5},
    "mesh.generate.airfoil.first_cell": 0.02,
    "mesh.generate.airfoil.trailing_edge_cell": 0.03,
    "time.order": 2,
}
