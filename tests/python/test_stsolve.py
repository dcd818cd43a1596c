"""The Python module: a run, its result at points, errors, an interrupted run."""

import os
import signal
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np

import stsolve

CASES = Path(__file__).resolve().parents[2] / "cases"
COARSE = {"flow.order": np.int64(4), "mesh.order": 4, "mesh.generate.box.cells": [6, 6], "time.end": 0.5, "time.step": 0.125}


def run(directory, **more):
    slabs = []
    case = stsolve.Case(CASES / "vortex.toml", COARSE)
    summary = case.run(output=directory, on_slab=slabs.append, **more)
    return slabs, summary


def test_run_and_result(directory):
    slabs, summary = run(directory)
    assert summary["completed"] and [slab["number"] for slab in slabs] == [1, 2, 3, 4]
    result = stsolve.Result(directory)
    assert len(result.times) == 5 and abs(result.times[-1] - 0.5) < 1e-14
    assert result.array("flow").shape == tuple(length for _, length in result.arrays["flow"])
    assert np.allclose(result.history["t"], result.times[1:], atol=1e-14)


def test_values_at_points(directory):
    """At the nodes of the cells the polynomials have their coefficients."""
    run(directory, existing="replace")
    result = stsolve.Result(directory)
    x, u = result.array("position"), result.array("flow")[:, -1]
    # The same nodes, as mesh and flow have the same order; of one cell, without those on its boundary.
    inside = [5, 6, 9, 10]
    points = x[7].T[inside]
    assert np.abs(result.evaluate(points) - u[7].T[inside]).max() < 1e-12
    assert np.isnan(result.evaluate(np.array([[1e6, 0.0]]))).all()


def test_averages_and_surfaces(directory):
    """Averages are arrays of the result; the distribution on a wall integrates to its force."""
    settings = {
        "time.end": 0.2,
        "time.slabs": 2,
        "output.averages.from": 0.05,
        "output.surfaces.walls": ["bottom"],
        "output.surfaces.every": 1,
    }
    stsolve.Case(CASES / "couette.toml", settings).run(output=directory, existing="replace")
    result = stsolve.Result(directory)
    assert np.abs(result.array("mean_pressure") - 0.8).max() < 0.01
    assert result.array("reynolds_stress_xy").shape[1] == 1
    for step in (0, 1):
        wall = result.surface("bottom", step)
        force = (wall["area"] * (wall["pressure"] * wall["normal_x"] + wall["friction_x"])).sum()
        assert abs(force - result.history["bottom_force_x"][step]) < 1e-13
    try:
        result.surface("left")
    except KeyError as error:
        assert "bottom" in str(error)
    else:
        raise AssertionError("a wall without a distribution")


def test_stop_and_resume(directory):
    case = stsolve.Case(CASES / "vortex.toml", COARSE)
    stopped = case.run(output=directory, existing="replace", on_slab=lambda slab: slab["number"] < 2)
    assert not stopped["completed"] and stopped["slabs"] == 2
    assert case.run(output=directory, existing="resume")["slabs"] == 4


def test_errors(directory):
    for settings, part in [({"flow.order": 99}, "flow.order"), ({"flow.riemann": "none"}, "riemann")]:
        try:
            stsolve.Case(CASES / "vortex.toml", settings)
        except stsolve.CaseError as error:
            assert part in str(error), error
        else:
            raise AssertionError(f"{settings} is accepted")
    run(directory, existing="replace")
    for call, kind in [
        (lambda: run(directory), stsolve.CaseError),
        (lambda: stsolve.Result(directory / "nothing"), stsolve.CaseError),
        (lambda: stsolve.Result(directory).array("flow", 99), IndexError),
        (lambda: stsolve.Result(directory).array("wind"), KeyError),
        (lambda: run(directory, existing="perhaps"), stsolve.CaseError),
    ]:
        try:
            call()
        except kind:
            continue
        raise AssertionError(f"no {kind.__name__}")


def test_exception_and_interrupt_stop_the_run(directory):
    def fail(slab):
        raise ZeroDivisionError(slab["number"])

    case = stsolve.Case(CASES / "vortex.toml", {**COARSE, "time.step": 0.00125})
    try:
        case.run(output=directory, existing="replace", on_slab=fail)
    except ZeroDivisionError:
        pass
    else:
        raise AssertionError("the exception is lost")
    # A shell has its background jobs ignore the interrupt.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    started = time.time()
    try:
        case.run(output=directory, existing="replace", on_slab=lambda slab: time.sleep(0.05))
    except KeyboardInterrupt:
        assert time.time() - started < 15
    else:
        raise AssertionError("the interrupt is lost")


def main():
    tests = [(name, test) for name, test in globals().items() if name.startswith("test_")]
    failed = 0
    for name, test in tests:
        with tempfile.TemporaryDirectory() as directory:
            try:
                test(Path(directory) / "run")
            except Exception as error:  # noqa: BLE001
                failed += 1
                print(f"{name}: {type(error).__name__}: {error}")
    print(f"{len(tests) - failed} passed, {failed} failed")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
