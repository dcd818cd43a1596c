"""Executes every block of Python in the pages, each by itself, beside runs that they may read."""

import contextlib
import io
import os
import re
import sys
import tempfile
import traceback
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import stsolve  # noqa: E402
from coarse import HEAVE, VORTEX  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
PAGES = [*sorted((ROOT / "docs/src").glob("*.md")), ROOT / "crates/output/FORMAT.md"]
# What the pages read: a line through the wake, the wall, averages.
OBSERVED = {
    "output.lines.wake": {"from": [1.5, -1], "to": [1.5, 1], "points": 41, "every": 5},
    "output.surfaces.walls": ["airfoil"],
    "output.surfaces.every": 5,
    "output.averages.from": 1,
}
# Other names of that run in the pages.
NAMES = ["naca0012_heave", "cylinder_street", "case"]


def blocks():
    """The blocks of Python in the pages, as (page:line, text)."""
    for page in PAGES:
        text = page.read_text()
        for block in re.finditer(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL):
            yield f"{page.relative_to(ROOT)}:{text[: block.start()].count(chr(10)) + 2}", block[1]


def prepare(directory):
    """A folder like the one from which a reader works."""
    os.chdir(directory)
    os.symlink(ROOT / "cases", "cases")
    case = stsolve.Case("cases/naca0012_heave.toml", {**HEAVE, "flow.order": 3, **OBSERVED})
    case.run(output="runs/airfoil")
    stsolve.Case("cases/vortex.toml", VORTEX).run(output="runs/vortex")
    # Its profile is that of a channel.
    profile = {"output.averages.from": 0, "output.averages.along": ["x"]}
    stsolve.Case("cases/couette.toml", profile).run(output="runs/channel")
    for name in NAMES:
        os.symlink("airfoil", f"runs/{name}")
    os.symlink("runs/airfoil/result.vtkhdf", "result.vtkhdf")


def execute(place, text):
    """Whether a block ends without an exception."""
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            exec(compile(text, place, "exec"), {"__name__": "__main__"})
    except Exception:  # noqa: BLE001
        print(place)
        traceback.print_exc(file=sys.stdout)
        return False
    return True


def main():
    with tempfile.TemporaryDirectory() as directory:
        prepare(directory)
        results = [execute(place, text) for place, text in blocks()]
        os.chdir(ROOT)
    print(f"{sum(results)} passed, {len(results) - sum(results)} failed")
    sys.exit(len(results) < 12 or not all(results))


if __name__ == "__main__":
    main()
