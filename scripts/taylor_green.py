#!/usr/bin/env python3
"""Runs the Taylor-Green vortex at Re = 1600 on 64^3 points up to t = 10, by ours and by PyFR, and prints seconds and dissipation.

    taylor_green.py [--order 4|8] [--quadrature RULE] [--riemann FLUX] [--threads N] [--end T] [--step DT] [--slab DT] [--pyfr COMMAND]
                    [--directory DIRECTORY]

Ours is `cases/taylor_green_3d.toml` in slabs of 0.1: of order 4 with `collocated` quadrature, of order 8 with the split form `kinetic_energy`; with
--quadrature it has that rule and no split form. PyFR takes
explicit steps DT of the classical Runge-Kutta method, with the same cells and points in a cell. Without anti-aliasing it does not survive order 8: the
energy grows at t = 7. The dissipation -dE/dt is that of the kinetic energy per volume, by differences over 0.1; spectral methods find a peak of 0.0128
at t = 9. FLUX of ours between cells is roe or lax_friedrichs, which is that of PyFR. Seconds are processor time, with the start; those of PyFR without
the compilation of its kernels. PyFR is what `scripts/peers` takes; without it ours is run alone. Needs the program, built by scripts/stsolve; the environment variable STSOLVE names another one.
"""

import argparse
import csv
import importlib.machinery
import importlib.util
import math
import os
import pathlib
import resource
import shutil
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = os.environ.get("STSOLVE", ROOT / "target/release/stsolve")
POINTS, SPACING = 64, 0.1
# Keys of ours, and the longest steps of PyFR that are stable.
OURS = {
    4: ["flow.quadrature=collocated"],
    8: ["flow.quadrature=collocated_lobatto", "flow.volume_flux=kinetic_energy"],
}
STEPS = {4: 1.25e-3, 8: 8e-4}

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
    parser.add_argument("--order", type=int, choices=sorted(OURS), default=4)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--end", type=float, default=10.0)
    parser.add_argument("--step", type=float, help="of PyFR, a part of 0.1")
    parser.add_argument("--slab", type=float, default=0.1, help="the slabs of ours")
    parser.add_argument("--quadrature", choices=["conserving", "collocated", "three_halves"], help="the rule of ours")
    parser.add_argument("--riemann", choices=["roe", "low_mach_roe", "lax_friedrichs"], default="roe", help="the flux of ours between cells")
    parser.add_argument("--pyfr", default=shutil.which("pyfr"), help="the command, where it is not on the path")
    parser.add_argument("--directory", default=ROOT / "runs/taylor_green")
    options = parser.parse_args()
    options.step = options.step or STEPS[options.order]
    options.cells = POINTS // options.order
    return options


def processor_seconds(call):
    """Those of the processes that `call` runs."""
    begun = resource.getrusage(resource.RUSAGE_CHILDREN)
    call()
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return ended.ru_utime + ended.ru_stime - begun.ru_utime - begun.ru_stime


def ours(directory, options):
    """Seconds, times and kinetic energy."""
    output = directory / "stsolve"
    rule = OURS[options.order] if options.quadrature is None else [f"flow.quadrature={options.quadrature}"]
    keys = [f"flow.order={options.order}", *rule, f"mesh.generate.box.cells={[options.cells] * 3}"]
    keys += [f"flow.riemann={options.riemann}", "output.fields=[]"]
    keys += [f"time.end={options.end}", f"time.step={options.slab}"]
    command = [PROGRAM, "run", ROOT / "cases/taylor_green_3d.toml", "--output", output, "--force", "--quiet", "--threads", options.threads]
    for key in keys:
        command += ["--set", key]
    seconds = processor_seconds(lambda: subprocess.run(list(map(str, command)), check=True))
    with open(output / "history.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    return seconds, [float(row["t"]) for row in rows], [float(row["kinetic_energy"]) for row in rows]


def theirs(directory, options):
    """The same of PyFR. Its kernels are compiled by a short run before."""
    peers = loaded("peers")
    (directory / "box.msh").write_text(scaled(peers.periodic_box(3, options.cells)))
    environment = {**os.environ, "OMP_NUM_THREADS": str(options.threads)}

    def call(*words):
        subprocess.run([options.pyfr, *words], cwd=directory, env=environment, capture_output=True, text=True, check=True)

    def run(end):
        every = round(SPACING / options.step)
        text = CONFIGURATION.format(
            degree=options.order - 1, end=end, step=options.step, every=every, quadrature=2 * options.order - 2
        )
        (directory / "case.ini").write_text(text)
        (directory / "energy.csv").unlink(missing_ok=True)
        return processor_seconds(lambda: call("run", "-b", "openmp", "box.pyfrm", "case.ini"))

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
