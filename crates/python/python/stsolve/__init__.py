"""Compressible flow around things that move and bend.

    import stsolve

    case = stsolve.Case("cases/vortex.toml", {"flow.order": 4})
    summary = case.run(output="runs/vortex", existing="replace", on_slab=lambda slab: print(slab.time, slab["mass"]))
    result = stsolve.Result("runs/vortex")
    state = result.evaluate(points)          # points: an array [point][axis]
"""

import sys

from ._analysis import boundary_layer, spectrum
from ._stsolve import Case, CaseError, Result, Slab, SolveError, __version__, execute

__all__ = ["Case", "CaseError", "Result", "Slab", "SolveError", "__version__", "boundary_layer", "main", "spectrum"]


def main():
    """The command `stsolve`."""
    sys.exit(execute(["stsolve", *sys.argv[1:]]))
