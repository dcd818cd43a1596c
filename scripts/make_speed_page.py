#!/usr/bin/env python3
"""Writes docs/src/speed.md, the only page with seconds, from a measurement of the kernels and from finished runs.

    make_speed_page.py [--bench FILE] [--bench-mesh-order-3 FILE] [--bench-collocated FILE] [--bench-lobatto FILE] [--runs DIRECTORY] [--study DIRECTORY] [--date DATE] [--machine NAME]

--bench: output of `stsolve bench --orders 4,8 --kernel flow,elasticity --seconds 2 --json` on an idle machine; the other file, of the same
command with `--kernel flow --mesh-order 3`, with `--kernel flow --quadrature collocated` and with `collocated_lobatto`. --runs: the directory of runs of the shipped cases (runs/NAME). --study: the runs of
`airfoil_study.py` (runs/airfoil_study). --date and --machine: when and where they were measured (default: today, this processor). A section
without input stays as it is.
"""

import argparse
import datetime
import json
import pathlib
import platform

PAGE = pathlib.Path(__file__).resolve().parent.parent / "docs" / "src" / "speed.md"

INTRODUCTION = """# Speed

Measured seconds and rates stand on this page, with machine and date. `scripts/make_speed_page.py` writes it.
"""
KERNELS = {"elasticity operator": "elasticity operator", "residual": "flow residual, conserving quadrature"}
SIZES = [(2, 4), (2, 8), (3, 4), (3, 8)]


def table(head, rows):
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in [head, ["---"] * len(head), *rows])


def bench_rows(file):
    """The rows of a measurement, by kernel, dimension and order."""
    return {(row["kernel"], row["dimension"], row["order"]): row for row in json.loads(file.read_text())["rows"]}


def rate(row):
    """Million unknowns per second, and the share of what the machine can do where it is known."""
    share = row.get("share_of_limit")
    number = f"{row['million_per_second']:.3g}"
    return number if share is None else f"{number} ({100 * share:.0f} %)"


def time_over(kernel, base, rows, size):
    return f"{rows[kernel, *size]['seconds_one'] / rows[base, *size]['seconds_one']:.1f}"


def speedup(rows):
    """From the least to the largest gain of all threads over one, of residual and product."""
    gains = [row["speedup"] for (kernel, *_), row in rows.items() if kernel in ("residual", "product")]
    return f"{min(gains):.1f} to {max(gains):.1f}"


def processor():
    """The name of this processor."""
    info = pathlib.Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def collocated(file, text):
    """The rows of a collocated rule: its residual, and what a product costs."""
    if not file:
        return []
    rows = bench_rows(file)
    return [
        (f"flow residual, {text}", *(rate(rows["residual", *size]) for size in SIZES)),
        ("Jacobian product, time over that residual's", *(time_over("product", "residual", rows, size) for size in SIZES)),
    ]


def kernels(file, others, date, name):
    machine, rows = json.loads(file.read_text())["machine"], bench_rows(file)
    lines = [(text, *(rate(rows[kernel, *size]) for size in SIZES)) for kernel, text in KERNELS.items()]
    lines.append(("Jacobian product, time over the residual's", *(time_over("product", "residual", rows, size) for size in SIZES)))
    if others.bench_mesh_order_3:
        coarse = bench_rows(others.bench_mesh_order_3)
        lines.append(("flow residual on a mesh of order 3", *(rate(coarse["residual", *size]) for size in SIZES)))
    lines += collocated(others.bench_collocated, "collocated quadrature (Gauss)")
    lines += collocated(others.bench_lobatto, "collocated quadrature (Gauss-Lobatto)")
    head = ("kernel", *(f"{dimension}-D, N = {order}" for dimension, order in SIZES))
    solve, set_up = ([rows[f"elasticity {part}", 2, order]["seconds_one"] for order in (4, 8)] for part in ("solve", "set-up"))
    return f"""Measured on {date} on {machine['threads']} cores of {name}. Peak of one core: {machine['gflops_one']:.0f} GFLOP/s and
{machine['gbytes_one']:.0f} GB/s; of all: {machine['gflops_all']:.0f} GFLOP/s and {machine['gbytes_all']:.0f} GB/s. The table shows million unknowns per second on one core, and the share of the peak that limits the kernel:

{table(head, lines)}

On all threads the residual and the product are {speedup(rows)} times as fast. 10^5 unknowns of elasticity in 2-D with N = 4 / 8 take
{set_up[0] + solve[0]:.2g} / {set_up[1] + solve[1]:.2g} s for set-up and solve, and {solve[0]:.2g} / {solve[1]:.2g} s for each further solve.
"""


def summaries(directory):
    """Names and summaries of the finished runs in a directory."""
    for file in sorted(directory.glob("*/summary.json")):
        summary = json.loads(file.read_text())
        if summary["completed"]:
            yield file.parent.name, summary


def cost(summary):
    spent = summary["cost"]
    return spent["threads"], f"{spent['wall_seconds']:.2g}", f"{spent['peak_memory_bytes'] / 1e6:.0f}"


def measured_runs(directory, date, label):
    found = list(summaries(directory))
    machine = found[0][1]["machine"]
    where = f"{machine['processors']} processors ({machine.get('processor', machine['system'])})"
    rows = [(label(name), *cost(summary)) for name, summary in found]
    return f"Measured on {date} on {where}: whole runs, with set-up and output.\n\n{table(('run', 'threads', 'seconds', 'MB'), rows)}\n"


def sections():
    """The sections that the page has."""
    parts = PAGE.read_text().split("\n## ")[1:] if PAGE.exists() else []
    return {title: text.strip() + "\n" for title, _, text in (part.partition("\n") for part in parts)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("--bench", "--bench-mesh-order-3", "--bench-collocated", "--bench-lobatto", "--runs", "--study"):
        parser.add_argument(name, type=pathlib.Path)
    parser.add_argument("--date", default=datetime.date.today().isoformat())
    parser.add_argument("--machine", default=processor())
    arguments = parser.parse_args()
    page = sections()
    if arguments.bench:
        page["Kernels"] = kernels(arguments.bench, arguments, arguments.date, arguments.machine)
    if arguments.runs:
        page["Runs of the shipped cases"] = measured_runs(arguments.runs, arguments.date, lambda name: f"[`{name}`](cases/{name}.md)")
    if arguments.study:
        page["Airfoil study"] = measured_runs(arguments.study, arguments.date, lambda name: f"`{name}`")
    PAGE.write_text("\n".join([INTRODUCTION, *(f"## {title}\n\n{text}" for title, text in page.items())]))


if __name__ == "__main__":
    main()
