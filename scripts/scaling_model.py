#!/usr/bin/env python3
"""What messages, files and the mesh cost on many cores, as a table for docs/src/clusters.md: a model, not a measurement.

    scripts/scaling_model.py

Three dimensions, order N = 4, N_t = 2, "low_order", 20,000 nodes per rank; latency 1.5 us, 10 GB/s per rank, 1 GB/s to the disk. The rates of a core are those of
docs/src/speed.md: a product, and what an application of the preconditioner costs beside it.
"""
import math

NODES, ORDER, TIME, COMPONENTS = 20_000, 4, 2, 5
LATENCY, BANDWIDTH, DISK = 1.5e-6, 10e9, 1e9
PRODUCT = 12.6e6  # unknowns per second of a product
PRECONDITIONER = 4.0  # times of a product
VECTORS, STEPS, ITERATIONS = 20, 3, 20

cells = NODES / ORDER**3
unknowns = NODES * TIME * COMPONENTS
ghosts = min(6 * cells ** (2 / 3), 6 * cells)
of_ghosts = 8 * unknowns / cells * ghosts
mesh = cells * ORDER**3 * (3 * 8 * 2 + 8)

print("| ranks | unknowns | work of an iteration, ms | ghosts | sums | efficiency | checkpoint | mesh on each rank |")
print("|---|---|---|---|---|---|---|---|")
for ranks in (10, 100, 1_000, 10_000, 100_000):
    work = unknowns / PRODUCT * (1 + PRECONDITIONER)
    # One exchange in the product and one in every step of the preconditioner, with six neighbours.
    exchange = (1 + STEPS) * (6 * LATENCY + of_ghosts / BANDWIDTH)
    # An all-gather brings one part of every sum from every rank to every rank.
    def gather(numbers):
        return math.log2(ranks) * LATENCY + 8 * numbers * ranks / BANDWIDTH
    sums = gather(VECTORS / 2) + gather(1) + gather(1) + STEPS * 3 * gather(2)
    efficiency = work / (work + exchange + sums)
    # The state, the slab before, that of the preconditioner, and the determinants.
    checkpoint = 8 * unknowns * ranks * (2 + (COMPONENTS + 1) / (TIME * COMPONENTS))
    print(f"| {ranks:,} | {unknowns * ranks:.1e} | {1e3 * work:.0f} | {1e3 * exchange:.2f} ms | {1e3 * sums:.2f} ms | {efficiency:.2f} "
          f"| {checkpoint / DISK:.2g} s, a slab {ITERATIONS * work:.1f} s | {mesh * ranks / 1e9:.2g} GB |")
