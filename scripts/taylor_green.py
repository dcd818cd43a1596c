#!/usr/bin/env python3
"""Runs the Taylor-Green vortex at Re = 1600 on 64^3 points up to t = 10, by ours and by PyFR, and prints seconds and dissipation.

    taylor_green.py [--threads N] [--end T] [--step DT] [--pyfr COMMAND] [--directory DIRECTORY]

Ours is `cases/taylor_green_3d.toml` with order 8 and the split form `kinetic_energy`, in slabs of 0.1. PyFR takes explicit steps DT of the classical
Runge-Kutta method, with the same 8^3 cells and 8 points per direction. The dissipation -dE/dt is that of the kinetic energy per volume, by differences
over 0.1; spectral methods find a peak of 0.0128 at t = 9. PyFR is what `scripts/peers` takes; without it ours is run alone. Needs the program, built by
scripts/stsolve; the environment variable STSOLVE names another one.
"""

import argparse
import csv
import importlib.machinery
import importlib.util
import math
import os
import pathlib
import shutil
import subprocess
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = os.environ.get("STSOLVE", ROOT / "target/release/stsolve")
CELLS, ORDER, SPACING = 8, 8, 0.1

CONFIGURATION = """
[backend]
precision = double
[backend-openmp]
cflags = -mprefer-vector-width=512
gimmik-max-nnz = 1000000
[constants]
gamma = 1.4
mu = 6.25e-4
Pr = 0.71
p0 = 71.42857142857143
[solver]
system = navier-stokes
order = {degree}
[solver-time-integrator]
formulation = std
scheme = rk4
controller = none
tstart = 0
tend = {end}
dt = {step}
[solver-interfaces]
riemann-solver = rusanov
ldg-beta = 0.5
ldg-tau = 0.1
[solver-interfaces-quad]
flux-pts = gauss-legendre
[solver-elements-hex]
soln-pts = gauss-legendre
[soln-plugin-integrate]
nsteps = {every}
file = energy.csv
header = true
quad-deg = {quadrature}
int-energy = 0.5*rho*(u*u + v*v + w*w)
[soln-ics]
rho = 1 + (cos(2*x) + cos(2*y))*(cos(2*z) + 2)/16/p0
u = sin(x)*cos(y)*cos(z)
v = -cos(x)*sin(y)*cos(z)
w = 0
p = p0 + (cos(2*x) + cos(2*y))*(cos(2*z) + 2)/16
"""


def main():
    options = parse()
    directory = pathlib.Path(options.directory)
    directory.mkdir(parents=True, exist_ok=True)
    print("| program | seconds | peak of the dissipation | at t | at t = 9 |\n| --- | --- | --- | --- | --- |", flush=True)
    print(row("stsolve", *ours(directory, options)), flush=True)
    if options.pyfr is not None:
        print(row("PyFR", *theirs(directory, options)), flush=True)


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--end", type=float, default=10.0)
    parser.add_argument("--step", type=float, default=5e-4, help="of PyFR, a part of 0.1; 1e-3 is not stable")
    parser.add_argument("--pyfr", default=shutil.which("pyfr"), help="the command, where it is not on the path")
    parser.add_argument("--directory", default="taylor_green")
    return parser.parse_args()


def ours(directory, options):
    """Seconds, times and kinetic energy per volume."""
    output = directory / "stsolve"
    keys = ["flow.order=8", "flow.quadrature=collocated_lobatto", "flow.volume_flux=kinetic_energy", f"time.end={options.end}", "output.fields=[]"]
    command = [PROGRAM, "run", ROOT / "cases/taylor_green_3d.toml", "--output", output, "--force", "--quiet", "--threads", options.threads]
    for key in keys:
        command += ["--set", key]
    begun = time.perf_counter()
    subprocess.run(list(map(str, command)), check=True)
    seconds = time.perf_counter() - begun
    with open(output / "history.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    return seconds, [float(row["t"]) for row in rows], [float(row["kinetic_energy"]) for row in rows]


def theirs(directory, options):
    """The same of PyFR. Its kernels are compiled by a short run before."""
    peers = loaded("peers")
    (directory / "box.msh").write_text(scaled(peers.periodic_box(3, CELLS)))
    environment = {**os.environ, "OMP_NUM_THREADS": str(options.threads)}

    def call(*words):
        subprocess.run([options.pyfr, *words], cwd=directory, env=environment, capture_output=True, text=True, check=True)

    def run(end):
        every = round(SPACING / options.step)
        text = CONFIGURATION.format(degree=ORDER - 1, end=end, step=options.step, every=every, quadrature=2 * ORDER - 2)
        (directory / "case.ini").write_text(text)
        (directory / "energy.csv").unlink(missing_ok=True)
        begun = time.perf_counter()
        call("run", "-b", "openmp", "box.pyfrm", "case.ini")
        return time.perf_counter() - begun

    call("import", "box.msh", "box.pyfrm")
    start = run(options.step)
    seconds = run(options.end) - start
    with open(directory / "energy.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    return seconds, [float(row["t"]) for row in rows], [float(row["int-energy"]) for row in rows]


def loaded(name):
    """A script without an ending, as a module."""
    loader = importlib.machinery.SourceFileLoader(name, str(ROOT / "scripts" / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


def scaled(mesh):
    """The unit box of `peers` with sides of 2 pi."""
    head, rest = mesh.split("$Nodes\n")
    nodes, tail = rest.split("$EndNodes")
    count, *lines = nodes.strip().split("\n")

    def moved(line):
        node, *place = line.split()
        return " ".join([node, *(repr(2 * math.pi * float(x)) for x in place)])

    return head + "$Nodes\n" + "\n".join([count, *map(moved, lines)]) + "\n$EndNodes" + tail


def row(name, seconds, times, energies):
    volume = (2 * math.pi) ** 3
    pairs = list(zip(zip(times, energies), zip(times[1:], energies[1:])))
    rates = [(0.5 * (t + s), (e - f) / (s - t) / volume) for (t, e), (s, f) in pairs if s > t]
    at, peak = max(rates, key=lambda rate: rate[1])
    near_nine = min(rates, key=lambda rate: abs(rate[0] - 9))
    late = f"{near_nine[1]:.5f}" if abs(near_nine[0] - 9) < 0.2 else "-"
    return f"| {name} | {seconds:.0f} | {peak:.5f} | {at:.2f} | {late} |"


if __name__ == "__main__":
    main()
