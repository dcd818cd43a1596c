#!/usr/bin/env python3
"""What a body that the flow moves costs beside the same motion prescribed.

    scripts/body_cost.py [MASS]...        default: 2

Runs cases/cylinder_viv.toml to t = 20 with a cylinder of each mass on its springs. Then the recorded motion is prescribed by a table and the
same flow runs again, without a body. Prints Newton steps and Krylov iterations per slab from t = 4 on, and the seconds of both runs.
Results stay in runs/body_cost.
"""

import csv
import json
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CASE = ROOT / "cases/cylinder_viv.toml"
RUNS = ROOT / "runs/body_cost"

# The weight of the mesh between the radii 1 and 15, as in the case.
S = "min(max((sqrt(x^2+y^2)-1)/14,0),1)"
WEIGHT = f"(1-({S})^3*(({S})*(6*({S})-15)+10))"


def run(text, name):
    """Runs a case; returns its history and its summary."""
    RUNS.mkdir(parents=True, exist_ok=True)
    case = RUNS / f"{name}.toml"
    case.write_text(text)
    command = [ROOT / "scripts/stsolve", "run", case, "--output", RUNS / name, "--force", "--quiet"]
    subprocess.run([*command, "--set", "time.end=20"], check=True)
    with open(RUNS / name / "history.csv") as file:
        rows = list(csv.DictReader(file))
    return rows, json.loads((RUNS / name / "summary.json").read_text())


def prescribed(text, rows):
    """The case `text` without its body, which moves as in `rows`."""
    times = [0.0] + [float(row["t"]) for row in rows]
    values = [0.0] + [float(row["cylinder_y"]) for row in rows]
    without = re.sub(r"\[bodies\.cylinder\].*?\n\n", "", text, flags=re.S)
    motion = f'[motion]\ndisplacement = [0, "way(t)*{WEIGHT}"]\n'
    return f'{without}\n{motion}\n[tables.way]\nends = "free"\nt = {times}\nvalues = {values}\n'


def tell(name, rows, summary):
    """Prints the work of a run."""
    late = [row for row in rows if float(row["t"]) > 4]
    mean = {key: sum(int(row[key]) for row in late) / len(late) for key in ("newton", "krylov")}
    seconds = summary["cost"]["wall_seconds"]
    print(f"{name:24} {mean['newton']:6.2f} Newton  {mean['krylov']:6.2f} Krylov  {seconds:7.1f} s")


def main():
    source = CASE.read_text()
    for mass in sys.argv[1:] or ["2"]:
        text = source.replace("mass = 2\n", f"mass = {mass}\n").replace("2*omega^2", f"{mass}*omega^2")
        rows, summary = run(text, f"free_{mass}")
        tell(f"mass {mass}, free", rows, summary)
        tell(f"mass {mass}, prescribed", *run(prescribed(text, rows), f"prescribed_{mass}"))


if __name__ == "__main__":
    main()
