#!/usr/bin/env python3
"""The flutter of a thin airfoil on springs by Theodorsen's theory, beside what runs of cases/flutter_airfoil.toml measured.

    flutter_theory.py [--after T] [SPEED=DIRECTORY]...

The section is that of the case: chord, density and speed of the stream are 1, and the reduced speed U / (b omega_a) sets the springs.
Prints the reduced speed and the angular frequency at which the growth rate is zero. DIRECTORY is that of a run at the reduced speed SPEED,
`--set constants.reduced_speed=SPEED`; its growth rate and frequency are fitted to the coordinates in history.csv. Between runs the flutter
speed is interpolated. Needs the Python packages of scripts/requirements.txt.
"""

import argparse
import csv
import math
import pathlib

import numpy as np

# Half a chord; the elastic axis at 0.4 chords, the centre of mass at 0.5.
B = 0.5
AXIS = (0.4 - B) / B
CENTRE = 0.1 / B
# The mass over that of a cylinder of air around the chord; radius of gyration about the axis, in half chords; ratio of frequencies.
MASS_RATIO = 20.0
GYRATION = 0.5
FREQUENCIES = 0.4
# A trapezoidal rule for the integrals of the Bessel functions: its error falls exponentially.
S = np.arange(0.0, 7.0, 0.002)


def bessel_k(order, z):
    """The modified Bessel function K_0 or K_1 of a complex argument, but for the factor that both share."""
    values = np.exp(-S**2) * S ** (2 * order) * (1.0 + S**2 / (2.0 * z)) ** (order - 0.5)
    values[0] *= 0.5
    return values.sum() / math.gamma(order + 0.5)


def theodorsen(z):
    """Theodorsen's function of the complex reduced frequency z = p b / U, continued to growing and decaying motions."""
    k0, k1 = bessel_k(0, z), bessel_k(1, z)
    return k1 / (k0 + k1)


def matrix(p, reduced_speed):
    """The equations of motion for h (down, in chords) and alpha (nose up), both growing as exp(p t)."""
    mass = MASS_RATIO * math.pi * B**2
    static, inertia = mass * CENTRE * B, mass * (GYRATION * B) ** 2
    omega = 1.0 / (B * reduced_speed)
    c, lever = theodorsen(p * B), B * (0.5 - AXIS)
    apparent, circulation = math.pi * B**2, 2.0 * math.pi * B * c
    wash = np.array([p, 1.0 + lever * p])
    lift = apparent * np.array([p**2, p - B * AXIS * p**2]) + circulation * wash
    moment = apparent * np.array([B * AXIS * p**2, -lever * p - B**2 * (0.125 + AXIS**2) * p**2])
    moment = moment + circulation * B * (AXIS + 0.5) * wash
    structure = np.array([
        [mass * (p**2 + (FREQUENCIES * omega) ** 2), static * p**2],
        [static * p**2, inertia * (p**2 + omega**2)],
    ])
    return structure + np.array([lift, -moment])


def root(guess, reduced_speed):
    """A root p of the determinant near a guess, by the secant method."""
    def determinant(p):
        return np.linalg.det(matrix(p, reduced_speed))

    old, new = guess, guess * (1.0 + 1e-4)
    before = determinant(old)
    for _ in range(60):
        now = determinant(new)
        if abs(new - old) < 1e-13 * abs(new) or now == before:
            break
        old, new, before = new, new - now * (new - old) / (now - before), now
    return new


def roots(reduced_speed, start=0.5, steps=60):
    """Both roots, followed from a low reduced speed on, that of plunge first."""
    found = []
    for ratio in (FREQUENCIES, 1.0):
        p = 1j * ratio / (B * start)
        previous = start
        for speed in np.geomspace(start, reduced_speed, steps):
            p = root(p * previous / speed, speed)
            previous = speed
        found.append(p)
    return found


def flutter(low=1.0, high=8.0):
    """The reduced speed and angular frequency at which the first root is neutral."""
    def worst(speed):
        return max(roots(speed), key=lambda p: p.real)

    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if worst(middle).real < 0.0 else (low, middle)
    return high, abs(worst(high).imag)


def history(directory):
    """The columns of history.csv."""
    with open(directory / "history.csv", newline="") as file:
        rows = list(csv.reader(file))
    return dict(zip(rows[0], np.array(rows[1:], dtype=float).T))


def measured(directory, after):
    """The root that grows most, from the coordinates after a time: the eigenvalues of the step between delayed samples, four of them."""
    columns = history(directory)
    kept = columns["t"] > after
    t = columns["t"][kept]
    delays = len(t) // 3
    first, second = [], []
    for name in ("airfoil_y", "airfoil_rotation"):
        series = columns[name][kept] / np.abs(columns[name][kept]).max()
        rows = np.array([series[i:i + delays] for i in range(len(series) - delays + 1)])
        first.append(rows[:-1])
        second.append(rows[1:])
    u, sigma, v = np.linalg.svd(np.vstack(first), full_matrices=False)
    step = (u[:, :4].T @ np.vstack(second) @ v[:4].T) / sigma[:4]
    found = np.log(np.linalg.eigvals(step).astype(complex)) / (t[1] - t[0])
    return max((p for p in found if p.imag > 0.0), key=lambda p: abs(p.imag))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", nargs="*", metavar="SPEED=DIRECTORY")
    parser.add_argument("--after", type=float, default=10.0, help="fit the coordinates after this time [default: 10]")
    arguments = parser.parse_args()
    neutral, omega = flutter()
    print(f"theory: flutter at the reduced speed {neutral:.4f}, angular frequency {omega:.4f}, reduced frequency {omega * B:.4f}")
    points = []
    for name in arguments.runs:
        speed, _, directory = name.partition("=")
        p, expected = measured(pathlib.Path(directory), arguments.after), max(roots(float(speed)), key=lambda p: p.real)
        points.append((float(speed), p))
        print(f"{directory} at {speed}: growth {p.real:.5f}, angular frequency {p.imag:.5f}; theory {expected.real:.5f}, {expected.imag:.5f}")
    for (low, p), (high, q) in zip(points, points[1:]):
        if p.real * q.real > 0.0:
            continue
        part = -p.real / (q.real - p.real)
        speed, frequency = low + part * (high - low), p.imag + part * (q.imag - p.imag)
        apart = [100.0 * (speed / neutral - 1.0), 100.0 * (frequency / omega - 1.0)]
        print(f"flutter at {speed:.4f} ({apart[0]:+.2f} %), angular frequency {frequency:.4f} ({apart[1]:+.2f} %)")


if __name__ == "__main__":
    main()
