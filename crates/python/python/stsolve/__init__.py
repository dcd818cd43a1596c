"""Compressible flow around things that move and bend.

    import stsolve

    case = stsolve.Case("cases/vortex.toml", {"flow.order": 4})
    summary = case.run(output="runs/vortex", existing="replace", on_slab=lambda slab: print(slab.time, slab["mass"]))
    result = stsolve.Result("runs/vortex")
    state = result.evaluate(points)          # points: an array [point][axis]
"""

import signal as _signal
import sys as _sys

from ._analysis import boundary_layer, spectrum
from ._stsolve import Case, CaseError, Result, Slab, SolveError, __version__
from ._stsolve import execute as _execute

__all__ = ["Case", "CaseError", "Result", "Slab", "SolveError", "__version__", "boundary_layer", "main", "spectrum"]


def main():
    """The command `stsolve`."""
    # Python's own handler would wait for the end of the computation.
    if _signal.getsignal(_signal.SIGINT) is _signal.default_int_handler:
        _signal.signal(_signal.SIGINT, _signal.SIG_DFL)
    _sys.exit(_execute(["stsolve", *_sys.argv[1:]]))
