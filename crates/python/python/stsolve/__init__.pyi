from collections.abc import Iterator, Mapping
from os import PathLike
from typing import Any, Callable, Literal, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str
"""The version, as the command prints it."""

class CaseError(ValueError):
    """The input is wrong; nothing was done. The message is that of the command."""

class SolveError(RuntimeError):
    """A slab could not be solved; the last good state is written. The message is that of the command."""

class Case:
    """A case file, with settings written over it: Case("case.toml", {"flow.order": 4})."""

    def __init__(self, path: Union[str, "PathLike[str]"], settings: Optional[Mapping[str, Any]] = None) -> None:
        """Reads and checks the case. Raises CaseError with all errors, their places and the remedies."""
    @property
    def name(self) -> str:
        """The name of the case: that of its file without the ending."""
    @property
    def title(self) -> str:
        """The title of the case."""
    @property
    def text(self) -> str:
        """The resolved case with all defaults, as TOML."""
    def run(
        self,
        output: Optional[Union[str, "PathLike[str]"]] = None,
        existing: Literal["keep", "resume", "replace"] = "keep",
        on_slab: Optional[Callable[["Slab"], Any]] = None,
        progress: bool = False,
        threads: Optional[int] = None,
    ) -> dict[str, Any]:
        """Runs the case; returns what summary.json says.

        output: the directory; default that of the case, or runs/<name>.
        existing: what becomes of a run there. "keep" refuses to write, "resume" goes on from its checkpoint, "replace" replaces it.
        on_slab: called with every slab that is done. The run stops with a checkpoint if it returns False or raises an exception.
        progress: shows a line with the time that is left, on a terminal or in a notebook.
        threads: the number of threads; default all cores. The results have the same bits for any number.

        Raises CaseError, or SolveError after the last good state is written. Ctrl-C stops the run with a checkpoint.
        Raises RuntimeError if the case has controls and another run of it goes on: load the case again for each run.
        """

class Slab:
    """The end of a slab, as on_slab receives it. dict(slab) has the columns of history.csv and their numbers.

    The fields are arrays that cannot be written. They stay valid after the call and after the run.
    """

    @property
    def number(self) -> int:
        """The number of the slab in the run, from 1."""
    @property
    def time(self) -> float:
        """The time at the end of the slab."""
    @property
    def dt(self) -> float:
        """The length of the slab."""
    @property
    def flow(self) -> Optional[NDArray[np.float64]]:
        """The conserved state in the slab, [cell][time node][component][node], as Result.array("flow") has it, without a copy.

        The last time node is the end of the slab. None in a run without a flow.
        """
    @property
    def velocity(self) -> Optional[NDArray[np.float64]]:
        """The velocity of the nodes of mesh or structure in the slab, [time node][C0 node][component], without a copy."""
    @property
    def displacement(self) -> NDArray[np.float64]:
        """The displacement of these nodes at the end of the slab, [C0 node][component]."""
    @property
    def position(self) -> NDArray[np.float64]:
        """The position of the nodes of every cell at the end of the slab, [cell][component][node], as Result.array("position") has it.

        It is computed when it is first asked for.
        """
    def keys(self) -> list[str]:
        """The columns of history.csv."""
    def __getitem__(self, column: str, /) -> float:
        """A number of the row of the slab in history.csv: slab["airfoil_lift_coefficient"]."""
    def __contains__(self, column: object, /) -> bool:
        """Whether history.csv has the column."""
    def __iter__(self) -> Iterator[str]:
        """The columns of history.csv."""
    def __len__(self) -> int:
        """The number of columns."""

class Result:
    """The result of a run: its directory, or result.vtkhdf in it. Step -1 is the last one, and the default."""

    def __init__(self, path: Union[str, "PathLike[str]"]) -> None:
        """Opens the result. It shows what was last published by a run that may still go on."""
    @property
    def times(self) -> NDArray[np.float64]:
        """The time of every step."""
    @property
    def case_text(self) -> str:
        """The resolved case, as TOML."""
    @property
    def dimension(self) -> int:
        """2 or 3."""
    @property
    def boundaries(self) -> list[str]:
        """The names of the boundaries."""
    @property
    def arrays(self) -> dict[str, list[tuple[str, int]]]:
        """The arrays of exact coefficients: for each its axes, as pairs of a label and a length."""
    @property
    def history(self) -> dict[str, NDArray[np.float64]]:
        """The columns of history.csv."""
    def step_at(self, time: float) -> int:
        """The step whose time is nearest."""
    def facets(self, boundary: str) -> NDArray[np.int64]:
        """The facets of a boundary, [facet][2]: the cell, and the face 2 axis + side of its reference cell, side 0 or 1."""
    def array(self, name: str, step: int = -1) -> NDArray[np.float64]:
        """Exact coefficients of a step: values at the Gauss-Lobatto nodes of each cell, axis 0 fastest."""
    def surface(self, wall: str, step: int = -1) -> dict[str, Any]:
        """The distribution on a wall of output.surfaces: the columns of surface_NAME.csv."""
    def evaluate(self, points: ArrayLike, step: int = -1, name: str = "flow") -> NDArray[np.float64]:
        """An array of the result at points, [point][axis] to [point][component]; NaN outside of the mesh.

        The flow has the components density, momentum per axis, total energy per volume.
        """
    def values(self, name: str, step: int, points: ArrayLike) -> NDArray[np.float64]:
        """An array of the result at points of the reference cell [-1, 1]^D, in every cell: [cell][point][component]."""
    def determinants(self, step: int, points: ArrayLike, name: str = "position") -> NDArray[np.float64]:
        """det J at points of the reference cell, in every cell: [cell][point]."""

def boundary_layer(
    result: Result, wall: str, thickness: float, number: int = -1
) -> dict[str, NDArray[np.float64]]:
    """Integral quantities of the boundary layer at the points of result.surface(wall, number), up to a distance from the wall.

    The keys are displacement_thickness, momentum_thickness, energy_thickness, shape_factor, thickness and edge_velocity.
    """

def spectrum(
    times: ArrayLike, values: ArrayLike, segments: int = 1
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Frequencies and the power spectral density of a signal by Welch's method; its integral is the variance.

    Values at uneven times are interpolated by cubics. A warning tells of steps that are more than twice the mean one.
    """

def main() -> None:
    """The command stsolve; ends the process with its exit code."""
