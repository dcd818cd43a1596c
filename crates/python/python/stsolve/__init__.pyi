from os import PathLike
from typing import Any, Callable, Literal, Mapping, Optional, Union

import numpy as np
from numpy.typing import NDArray

__version__: str

class CaseError(ValueError):
    """The input is wrong; nothing was done."""

class SolveError(RuntimeError):
    """A slab could not be solved; the last good state is written."""

class Case:
    """A case file, with settings written over it: Case("case.toml", {"flow.order": 4})."""

    def __init__(self, path: Union[str, "PathLike[str]"], settings: Optional[Mapping[str, Any]] = None) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def text(self) -> str: ...
    def run(
        self,
        output: Optional[Union[str, "PathLike[str]"]] = None,
        existing: Literal["keep", "resume", "replace"] = "keep",
        on_slab: Optional[Callable[[dict[str, float]], Any]] = None,
    ) -> dict[str, Any]:
        """Runs the case; returns what summary.json says. The run stops with a checkpoint if on_slab returns False."""

class Result:
    """The result of a run: its directory, or result.vtkhdf in it."""

    def __init__(self, path: Union[str, "PathLike[str]"]) -> None: ...
    @property
    def times(self) -> NDArray[np.float64]: ...
    @property
    def case_text(self) -> str: ...
    @property
    def arrays(self) -> dict[str, list[tuple[str, int]]]: ...
    @property
    def history(self) -> dict[str, NDArray[np.float64]]: ...
    def array(self, name: str, step: int = -1) -> NDArray[np.float64]:
        """Exact coefficients of a step; averages over time too."""
    def surface(self, wall: str, step: int = -1) -> dict[str, Any]:
        """The distribution on a wall of output.surfaces: the columns of surface_NAME.csv."""
    def evaluate(self, points: NDArray[np.float64], step: int = -1) -> NDArray[np.float64]:
        """The conserved state at points, [point][axis] to [point][component]; NaN outside of the mesh."""

def main() -> None: ...
