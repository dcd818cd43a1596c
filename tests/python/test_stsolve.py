"""The Python module: a run, its slabs while it goes on, its result at points, errors, an interrupted run."""

import ast
import contextlib
import gc
import importlib.util
import inspect
import io
import json
import os
import pickle
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import warnings
from pathlib import Path

import numpy as np

import stsolve
from coarse import CASES, VORTEX
from stsolve import _analysis, _progress

LONG = {**VORTEX, "time.step": 0.00125}


def run(directory, **more):
    slabs = []
    case = stsolve.Case(CASES / "vortex.toml", {**VORTEX, "flow.order": np.int64(4)})
    summary = case.run(output=directory, on_slab=slabs.append, **more)
    return slabs, summary


def raised(kind, call):
    """The exception of this kind that `call` raises."""
    try:
        call()
    except kind as error:
        return error
    raise AssertionError(f"no {kind.__name__}")


def test_run_and_result(directory):
    slabs, summary = run(directory)
    assert summary["completed"] and [slab.number for slab in slabs] == [1, 2, 3, 4]
    result = stsolve.Result(directory)
    assert len(result.times) == 5 and abs(result.times[-1] - 0.5) < 1e-14
    assert result.array("flow").shape == tuple(length for _, length in result.arrays["flow"])
    assert np.allclose(result.history["t"], result.times[1:], atol=1e-14)
    assert [result.step_at(time) for time in (-1, 0.13, 0.3, 9)] == [0, 1, 2, 4]


def test_slabs_have_the_rows_of_the_history(directory):
    slabs, _ = run(directory)
    history = stsolve.Result(directory).history
    for row, slab in enumerate(slabs):
        assert slab.keys() == list(slab) == list(history) and len(slab) == len(history)
        assert dict(slab) == {name: column[row] for name, column in history.items()}
        assert (slab.time, slab.dt) == (slab["t"], slab["dt"]) and "newton" in slab and "wind" not in slab
    assert "newton" in str(raised(KeyError, lambda: slabs[0]["wind"]))
    assert repr(slabs[0]) == "stsolve.Slab(1, time = 0.125, dt = 0.125)"


def test_any_number_of_threads_gives_the_same_bits(directory):
    results = []
    for threads in (1, 2):
        case, output = stsolve.Case(CASES / "vortex.toml", VORTEX), directory / str(threads)
        case.run(output=output, threads=threads)
        results.append(stsolve.Result(output).array("flow"))
    assert (results[0] == results[1]).all()
    for threads in (0, -1, 10**6):
        error = raised(ValueError, lambda threads=threads: case.run(output=directory / "none", threads=threads))
        assert "1 to 1024" in str(error)


def test_messages_speak_python(directory):
    """Remedies name parameters of Case.run, and not those of the command or of Rust."""
    run(directory)
    refused = str(raised(stsolve.CaseError, lambda: run(directory)))
    assert 'existing="resume"' in refused and 'existing="replace"' in refused and "Existing::" not in refused, refused
    case = stsolve.Case(CASES / "vortex.toml", LONG)
    stopped = case.run(output=directory, existing="replace", on_slab=lambda slab: False)
    assert "--resume" not in stopped["reason"] and "request" in stopped["reason"], stopped["reason"]


def test_command_by_the_module(directory):
    shown = subprocess.run([sys.executable, "-m", "stsolve", "--version"], capture_output=True, text=True)
    assert shown.returncode == 0 and stsolve.__version__ in shown.stdout


def test_history_is_written_before_the_slab_is_told(directory):
    """What on_slab reads in the directory includes its slab."""
    rows = []
    case = stsolve.Case(CASES / "vortex.toml", VORTEX)
    case.run(output=directory, on_slab=lambda slab: rows.append((directory / "history.csv").read_text().count("\n")))
    assert rows == [2, 3, 4, 5]


def test_checkpoints_are_written_before_the_slab_is_told(directory):
    """The file was one slab behind."""
    times = []
    case = stsolve.Case(CASES / "vortex.toml", {**VORTEX, "output.checkpoint_every": 1})
    case.run(output=directory, on_slab=lambda slab: times.append((slab.time, stsolve.Result(directory).times[-1])))
    assert len(times) == 4 and all(told == stored for told, stored in times), times


def test_fields_of_slabs_are_those_of_the_result(directory):
    """They stay as they were when the run has gone on, also without the slab."""
    slabs, _ = run(directory)
    result, fields = stsolve.Result(directory), [(slab.flow, slab.position) for slab in slabs]
    moved = np.abs(result.array("position", 1) - result.array("position", 0)).max()
    assert moved > 1e-3, "the mesh moves"
    velocities = [slab.velocity for slab in slabs]
    del slabs
    gc.collect()
    for step, (flow, position) in enumerate(fields, 1):
        assert (flow == result.array("flow", step)).all() and (position == result.array("position", step)).all()
    speeds = result.array("mesh_velocity")
    assert set(np.unique(velocities[-1])) == set(np.unique(speeds)) and velocities[-1].shape[::2] == (speeds.shape[1], 2)


def test_fields_of_slabs_are_no_copies_and_cannot_be_written(directory):
    (slab, *_), _ = run(directory)
    for field in ("flow", "velocity", "position", "displacement"):
        array, again = getattr(slab, field), getattr(slab, field)
        assert np.shares_memory(array, again) and not array.flags.owndata, field
        raised(ValueError, lambda: array.fill(0.0))
        raised(ValueError, lambda: array.setflags(write=True))


def test_only_false_stops_a_run(directory):
    """A callback that ended in a count, an empty text or an array stopped the run, or failed."""
    case = stsolve.Case(CASES / "vortex.toml", VORTEX)
    for answer in (None, 0, 0.0, "", [], np.zeros(2), np.True_):
        assert case.run(output=directory, existing="replace", on_slab=lambda slab, answer=answer: answer)["completed"], answer
    for answer in (False, np.False_):
        summary = case.run(output=directory, existing="replace", on_slab=lambda slab, answer=answer: answer)
        assert not summary["completed"], answer


def test_slabs_of_a_mesh_and_of_a_structure(directory):
    box = {"mesh.generate.rotating_box.cells_per_side": 5, "time.end": 5, "time.slabs": 2}
    for name, settings in [("rotating_box", box), ("cantilever", {"output.every": 1})]:
        slabs = []
        case = stsolve.Case(CASES / f"{name}.toml", settings)
        case.run(output=directory, existing="replace", on_slab=lambda slab: slabs.append(slab) or len(slabs) < 2)
        result = stsolve.Result(directory)
        assert len(slabs) == 2 and slabs[1].flow is None
        assert (slabs[1].position == result.array("position")).all() and result.times[-1] == slabs[1].time
        assert dict(slabs[0]) == {column: values[0] for column, values in result.history.items()}
        assert slabs[1].velocity.shape[1:] == slabs[1].displacement.shape and slabs[1].displacement.any()


def test_progress(directory):
    """Nothing in a pipe; a line that is written over on a terminal; an output of the cell in a notebook."""
    with contextlib.redirect_stderr(io.StringIO()) as pipe:
        run(directory, progress=True)
    assert pipe.getvalue() == ""

    class Terminal(io.StringIO):
        def isatty(self):
            return True

    with contextlib.redirect_stderr(Terminal()) as terminal:
        run(directory, existing="replace", progress=True)
    shown = terminal.getvalue()
    assert shown.startswith("\r[") and shown.endswith("\n") and shown.count("\n") == 1, shown
    assert "100 %  slab 4  t = 0.5 of 0.5" in shown.split("\r")[-1], shown


def test_line_of_progress():
    line = _progress.line(12, 0.24, 8, 0.25, 60)
    assert line == "[======                  ]  25 %  slab 12  t = 0.24 of 8  1:00 min elapsed, 3:00 min left", line
    assert [_progress._time(seconds) for seconds in (0.4, 59.4, 125, 7265)] == ["0 s", "59 s", "2:05 min", "2:01 h"]
    assert "left" not in _progress.line(0, 0, 8, 0, 5)


def test_values_at_points(directory):
    """At the nodes of the cells the polynomials have their coefficients."""
    run(directory)
    result = stsolve.Result(directory)
    x, u, v = result.array("position"), result.array("flow")[:, -1], result.array("mesh_velocity")[:, -1]
    # The same nodes, as mesh and flow have the same order; of one cell, without those on its boundary.
    inside = [5, 6, 9, 10]
    points = x[7].T[inside]
    assert np.abs(result.evaluate(points) - u[7].T[inside]).max() < 1e-12
    assert np.abs(result.evaluate(points.tolist(), name="mesh_velocity") - v[7].T[inside]).max() < 1e-12
    assert np.abs(result.evaluate(points, name="position") - points).max() < 1e-10
    assert np.isnan(result.evaluate([[1e6, 0.0]])).all()
    assert result.evaluate(np.empty((0, 2))).shape == (0, 4)
    for wrong in ([5.0, 5.0], [[1.0, 2.0, 3.0]], 1.0):
        assert "[point][axis] with 2" in str(raised(ValueError, lambda: result.evaluate(wrong)))
    raised(KeyError, lambda: result.evaluate(points, name="wind"))
    raised(IndexError, lambda: result.evaluate(points, 99))


def test_values_in_cells(directory):
    """Values at the nodes are the coefficients; determinants integrate to the area; facets are on their boundary."""
    run(directory)
    result = stsolve.Result(directory)
    x = result.array("position")
    nodes = np.array([-1, -np.sqrt(0.2), np.sqrt(0.2), 1])
    lattice = [(a, b) for b in nodes for a in nodes]
    assert np.abs(np.swapaxes(result.values("position", -1, lattice), 1, 2) - x).max() < 1e-13
    assert np.abs(np.swapaxes(result.values("flow", 2, lattice), 1, 2) - result.array("flow", 2)[:, -1]).max() < 1e-12
    gauss, weights = np.polynomial.legendre.leggauss(6)
    determinants = result.determinants(-1, [(a, b) for b in gauss for a in gauss])
    area = (determinants @ np.outer(weights, weights).ravel()).sum()
    assert abs(area / result.determinants(0, [(0, 0)]).sum() / 4 - 1) < 0.1 and result.dimension == 2
    rest = result.array("position", 0)
    for boundary in result.boundaries:
        facets = result.facets(boundary)
        assert facets.shape[1] == 2 and len(facets)
        side = [rest[cell].reshape(2, 4, 4)[(slice(None), *(slice(None),) * int(face < 2), -(face % 2))] for cell, face in facets]
        spread = np.ptp(np.array(side), axis=(0, 2))
        assert spread.min() < 1e-12 < spread.max(), "the box has straight sides at rest"
    assert "there is no boundary 'wind'" in str(raised(KeyError, lambda: result.facets("wind"))).replace('\\"', "'").replace('"', "'")
    raised(ValueError, lambda: result.determinants(-1, [(0, 0)], name="flow"))


def test_averages_and_surfaces(directory):
    """Averages are arrays of the result; the distribution on a wall integrates to its force."""
    settings = {
        "time.end": 0.2,
        "time.slabs": 2,
        "output.averages.from": 0.05,
        "output.surfaces.walls": ["bottom"],
        "output.surfaces.every": 1,
    }
    stsolve.Case(CASES / "couette.toml", settings).run(output=directory)
    result = stsolve.Result(directory)
    assert np.abs(result.array("mean_pressure") - 0.8).max() < 0.01
    assert result.array("reynolds_stress_xy").shape[1] == 1
    middle = result.values("position", -1, [(0.1, -0.2)])[:, 0]
    mean = result.values("mean_velocity", -1, [(0.1, -0.2)])[:, 0]
    assert np.abs(result.evaluate(middle, name="mean_velocity") - mean).max() < 1e-12 and np.ptp(mean[:, 0]) > 0.1
    for step in (0, 1):
        wall = result.surface("bottom", step)
        force = (wall["area"] * (wall["pressure"] * wall["normal_x"] + wall["friction_x"])).sum()
        assert abs(force - result.history["bottom_force_x"][step]) < 1e-13
    assert "bottom" in str(raised(KeyError, lambda: result.surface("left")))


def test_stop_and_resume(directory):
    case = stsolve.Case(CASES / "vortex.toml", VORTEX)
    stopped = case.run(output=directory, on_slab=lambda slab: slab.number < 2)
    assert not stopped["completed"] and stopped["slabs"] == 2
    assert case.run(output=directory, existing="resume")["slabs"] == 4


def test_errors(directory):
    for settings, part in [({"flow.order": 99}, "flow.order"), ({"flow.riemann": "none"}, "riemann")]:
        assert part in str(raised(stsolve.CaseError, lambda: stsolve.Case(CASES / "vortex.toml", settings)))
    run(directory)
    endless = []
    endless.append(endless)
    for call, kind in [
        (lambda: run(directory), stsolve.CaseError),
        (lambda: stsolve.Result(directory / "nothing"), stsolve.CaseError),
        (lambda: stsolve.Result(directory).array("flow", 99), IndexError),
        (lambda: stsolve.Result(directory).array("wind"), KeyError),
        (lambda: run(directory, existing="perhaps"), stsolve.CaseError),
        (lambda: run(directory, existing="replace", on_slab=5), TypeError),
        (lambda: stsolve.Case(CASES / "vortex.toml", {"time.end": np.longdouble(1)}), TypeError),
        (lambda: stsolve.Case(CASES / "vortex.toml", {"time.end": endless}), TypeError),
    ]:
        raised(kind, call)


def command(*arguments):
    """What the command says on stderr, as one line of words, and its exit code."""
    program = "import stsolve; stsolve.main()"
    done = subprocess.run([sys.executable, "-c", program, *map(str, arguments)], capture_output=True, text=True)
    return " ".join(done.stderr.split()), done.returncode


def test_messages_are_those_of_the_command(directory):
    wrong = str(raised(stsolve.CaseError, lambda: stsolve.Case(CASES / "vortex.toml", {"flow.order": 99, "mesh.order": 1})))
    said, code = command("check", CASES / "vortex.toml", "--set", "flow.order=99", "--set", "mesh.order=1")
    assert code == 2 and " ".join(wrong.split()) in said and wrong.count("order") > 1, (wrong, said)
    hopeless = {**VORTEX, "solver.newton_steps": 1, "solver.slab_halvings": 0}
    failed = raised(stsolve.SolveError, lambda: stsolve.Case(CASES / "vortex.toml", hopeless).run(output=directory))
    settings = [word for key, value in hopeless.items() for word in ("--set", f"{key}={value}")]
    said, code = command("run", CASES / "vortex.toml", "--output", directory, "--force", "--quiet", *settings)
    first = str(failed).splitlines()[0]
    assert code == 1 and " ".join(first.split()) in said, (first, said)


def test_exception_stops_the_run(directory):
    def fail(slab):
        raise ZeroDivisionError(slab.number)

    case = stsolve.Case(CASES / "vortex.toml", LONG)
    assert raised(ZeroDivisionError, lambda: case.run(output=directory, on_slab=fail)).args == (1,)


def test_cases_slabs_and_results_say_what_to_pickle_instead(directory):
    slabs, _ = run(directory)
    case = stsolve.Case(CASES / "vortex.toml", VORTEX)
    for value, part in [(case, "settings"), (slabs[0], "dict(slab)"), (stsolve.Result(directory), "path")]:
        assert part in str(raised(TypeError, lambda: pickle.dumps(value))), value


def test_what_is_no_text_is_no_column(directory):
    """`0 in slab` raised a TypeError."""
    slabs, _ = run(directory)
    assert 0 not in slabs[0] and None not in slabs[0] and "t" in slabs[0]


def test_a_case_with_controls_has_one_run_at_a_time(directory):
    """Two runs at the same time changed the same controls."""
    control = {"controls.force.measure": "mass", "controls.force.rate": "0"}
    case, refused = stsolve.Case(CASES / "vortex.toml", {**VORTEX, **control}), []

    def again(slab):
        refused.append(str(raised(RuntimeError, lambda: case.run(output=directory / "again"))))

    assert case.run(output=directory / "first", on_slab=again)["completed"]
    assert len(refused) == 4 and "load it again" in refused[0]
    assert case.run(output=directory / "again")["completed"]


def test_a_case_without_controls_may_run_twice_at_the_same_time(directory):
    case = stsolve.Case(CASES / "vortex.toml", VORTEX)
    runs = [threading.Thread(target=case.run, kwargs={"output": directory / name}) for name in "ab"]
    for thread in runs:
        thread.start()
    for thread in runs:
        thread.join()
    one, other = (stsolve.Result(directory / name).array("flow") for name in "ab")
    assert (one == other).all()


def test_python_goes_on_while_a_result_is_evaluated(directory):
    """Rust kept Python while it waited for its threads, which may be waiting for Python."""
    run(directory)
    result, points = stsolve.Result(directory), np.random.default_rng(1).uniform(1, 9, (300_000, 2))
    times, is_done = [], threading.Event()

    def watch():
        while not is_done.wait(0.001):
            times.append(time.time())

    watcher = threading.Thread(target=watch)
    watcher.start()
    begun = time.time()
    result.evaluate(points)
    ended = time.time()
    is_done.set()
    watcher.join()
    # Python's threads take turns of 5 ms.
    inside = sum(begun + 0.01 < at < ended - 0.01 for at in times)
    assert inside > 5, (inside, ended - begun)


def test_interrupt_stops_the_run_with_a_checkpoint(directory):
    # A shell has its background jobs ignore the interrupt.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    case, started = stsolve.Case(CASES / "vortex.toml", LONG), time.time()
    raised(KeyboardInterrupt, lambda: case.run(output=directory, on_slab=lambda slab: time.sleep(0.05)))
    assert time.time() - started < 15
    done = stsolve.Result(directory).history["t"][-1]
    more = []
    case.run(output=directory, existing="resume", on_slab=lambda slab: more.append(slab.time) or False)
    assert 0 < done < more[0] <= done + 0.002


def test_boundary_layer_of_a_known_profile(directory):
    """u = sin(pi y / 2) up to y = 1 has the thicknesses 1 - 2 / pi, 2 / pi - 1 / 2, and that of energy 2 / (3 pi)."""
    settings = {
        "mesh": {"order": 6, "generate": {"box": {"lower": [0, 0], "upper": [1, 1], "cells": [1, 3], "periodic": ["x"]}}},
        "flow": {
            "order": 6,
            "gas": {"viscosity": {"constant": 1e-3}},
            "reference": {"density": 1, "speed": 1, "pressure": 20},
            "initial": {"expression": {"density": "1", "velocity": ["sin(pi * y / 2)", "0"], "pressure": "20"}},
            "boundary": {"bottom": {"adiabatic_wall": {}}, "top": "slip_wall"},
        },
        "time": {"order": 1, "end": 1e-9, "slabs": 1},
        "output": {"surfaces": {"walls": ["bottom"]}},
    }
    case = directory.parent / "layer.toml"
    case.write_text("".join(f"{key} = {inline(value)}\n" for key, value in settings.items()))
    stsolve.Case(case).run(output=directory)
    layer = stsolve.boundary_layer(stsolve.Result(directory), "bottom", 1.0)
    exact = {
        "displacement_thickness": 1 - 2 / np.pi,
        "momentum_thickness": 2 / np.pi - 0.5,
        "energy_thickness": 2 / (3 * np.pi),
        "edge_velocity": 1.0,
        "thickness": 2 / np.pi * np.arcsin(0.99),
    }
    for name, value in exact.items():
        error = np.abs(layer[name] / value - 1).max()
        assert error < 1e-3, (name, error)
    assert np.allclose(layer["shape_factor"], layer["displacement_thickness"] / layer["momentum_thickness"])
    flow = settings["flow"]
    flow["boundary"]["bottom"] = {"adiabatic_wall": {"slide": [0.5, 0]}}
    flow["initial"]["expression"]["velocity"][0] = "0.5 + sin(pi * y / 2)"
    case.write_text("".join(f"{key} = {inline(value)}\n" for key, value in settings.items()))
    stsolve.Case(case).run(output=directory, existing="replace")
    sliding = stsolve.boundary_layer(stsolve.Result(directory), "bottom", 1.0)
    for name in exact:
        assert np.abs(sliding[name] / layer[name] - 1).max() < 1e-3, name
    beyond = stsolve.boundary_layer(stsolve.Result(directory), "bottom", 1.5)
    assert all(np.isnan(values).all() for values in beyond.values()), "the lines leave the mesh"


def test_boundary_layer_reaches_the_end_of_its_line(directory):
    """The edge was sought at nodes up to 0.99965 of the line alone: in u = y its velocity was 3.5e-4 too small."""
    case = directory.parent / "linear.toml"
    settings = {
        "mesh": {"order": 2, "generate": {"box": {"lower": [0, 0], "upper": [1, 1], "cells": [1, 2], "periodic": ["x"]}}},
        "flow": {
            "order": 3,
            "gas": {"viscosity": {"constant": 1e-3}},
            "reference": {"density": 1, "speed": 1, "pressure": 20},
            "initial": {"expression": {"density": "1", "velocity": ["y", "0"], "pressure": "20"}},
            "boundary": {"bottom": {"adiabatic_wall": {}}, "top": {"adiabatic_wall": {"slide": [1, 0]}}},
        },
        "time": {"order": 1, "end": 1e-9, "slabs": 1},
        "output": {"surfaces": {"walls": ["bottom"]}},
    }
    case.write_text("".join(f"{key} = {inline(value)}\n" for key, value in settings.items()))
    stsolve.Case(case).run(output=directory)
    layer = stsolve.boundary_layer(stsolve.Result(directory), "bottom", 1.0)
    exact = {"displacement_thickness": 1 / 2, "momentum_thickness": 1 / 6, "energy_thickness": 1 / 4}
    for name, value in {**exact, "edge_velocity": 1.0, "thickness": 0.99}.items():
        assert np.abs(layer[name] - value).max() < 1e-6, (name, layer[name])


def test_steps_of_distributions_are_found_in_runs_of_nanoseconds():
    """The tolerance was a nanosecond: any step was at the time of the distribution."""

    class Short:
        times = np.array([0.0, 1e-9, 2e-9, 3e-9])

        def step_at(self, time):
            return int(abs(self.times - time).argmin())

    assert _analysis._step_of(Short(), 3 * 1e-9) == 3
    assert "multiple" in str(raised(ValueError, lambda: _analysis._step_of(Short(), 1.4e-9)))


def inline(value):
    """A value of a case as TOML: JSON's lists, texts and numbers are TOML's."""
    if isinstance(value, dict):
        return "{%s}" % ", ".join(f"{key} = {inline(entry)}" for key, entry in value.items())
    return json.dumps(value)


def test_spectrum_has_the_variance_and_the_frequency():
    rng = np.random.default_rng(1)
    times = np.sort(rng.uniform(0, 40, 4000))
    values = 3 + 0.5 * np.sin(2 * np.pi * 1.25 * times)
    for segments in (1, 3, 4):
        frequencies, density = stsolve.spectrum(times, values, segments)
        assert abs(frequencies[density.argmax()] - 1.25) < frequencies[1]
        variance = density.sum() * frequencies[1]
        assert abs(variance / 0.125 - 1) < 0.02, (segments, variance)
    assert "increasing" in str(raised(ValueError, lambda: stsolve.spectrum(times[::-1], values)))
    assert "segments" in str(raised(ValueError, lambda: stsolve.spectrum(times, values, 1000)))
    outside = np.where(times < times[5], np.nan, values)
    assert "outside of the mesh" in str(raised(ValueError, lambda: stsolve.spectrum(times, outside)))


def test_spectrum_of_uneven_times_keeps_the_variance():
    """Straight lines between values lost 4 % of it, and long steps were not told of."""
    rng = np.random.default_rng(1)
    steps = 0.05 * (1 + 0.6 * rng.uniform(-1, 1, 4000))
    signal = lambda times: 3 + np.sin(2 * np.pi * 1.37 * times)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        frequencies, density = stsolve.spectrum(np.cumsum(steps), signal(np.cumsum(steps)))
    assert not told and abs(density.sum() * frequencies[1] / 0.5 - 1) < 5e-3, density.sum() * frequencies[1]
    steps[-100:] *= 5
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        stsolve.spectrum(np.cumsum(steps), signal(np.cumsum(steps)))
    assert len(told) == 1 and "the longest step" in str(told[0].message)


def test_the_shedding_script_finds_more_than_fifty_periods():
    """The search ended at fifty periods in the time, and the largest value below was printed."""
    spec = importlib.util.spec_from_file_location("shedding", CASES.parent / "scripts" / "shedding.py")
    shedding = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(shedding)
    for frequency in (0.07, 0.9, 3.3, 8.0):
        step = 0.05 * (1 + 0.5 * np.random.default_rng(1).uniform(-1, 1, 2000))
        time = 30 + np.cumsum(step)
        drag = 0.6 + 0.01 * np.sin(2 * np.pi * frequency * time)
        found = shedding.peak(time.tolist(), step.tolist(), drag.tolist())
        assert abs(found - frequency) < 2e-3, (frequency, found)


def test_stubs_describe_the_module():
    """Every member has a docstring in the stubs, and the parameters of the module."""
    stubs = ast.parse((Path(stsolve.__file__).parent / "__init__.pyi").read_text())
    classes = {node.name: node for node in stubs.body if isinstance(node, ast.ClassDef)}
    assert set(classes) == {name for name in stsolve.__all__ if inspect.isclass(getattr(stsolve, name))}
    functions = {node.name: node for node in stubs.body if isinstance(node, ast.FunctionDef)}
    assert set(functions) == {name for name in stsolve.__all__ if inspect.isfunction(getattr(stsolve, name))}
    for name, stub in functions.items():
        assert ast.get_docstring(stub) and getattr(stsolve, name).__doc__, name
        assert [argument.arg for argument in stub.args.args] == list(inspect.signature(getattr(stsolve, name)).parameters)
    for name, stub in classes.items():
        members = {node.name: node for node in stub.body if isinstance(node, ast.FunctionDef)}
        assert ast.get_docstring(stub) and all(ast.get_docstring(member) for member in members.values()), name
        public = {member for member in vars(getattr(stsolve, name)) if not member.startswith("_")}
        assert public == {member for member in members if not member.startswith("_")}, name
        for member in public:
            real = getattr(getattr(stsolve, name), member)
            assert real.__doc__, member
            if callable(real):
                parameters = [argument.arg for argument in members[member].args.args]
                assert parameters == list(inspect.signature(real).parameters), member


def test_version():
    assert re.fullmatch(r"\d+\.\d+\.\d+.*", stsolve.__version__)


def main():
    wanted = sys.argv[1:]
    tests = [(name, test) for name, test in globals().items() if name.startswith("test_")]
    tests = [(name, test) for name, test in tests if not wanted or name in wanted]
    failed = 0
    for name, test in tests:
        with tempfile.TemporaryDirectory() as directory:
            try:
                test(*[Path(directory) / "run"] if inspect.signature(test).parameters else [])
            except Exception as error:  # noqa: BLE001
                failed += 1
                print(f"{name}: {type(error).__name__}: {error}")
    print(f"{len(tests) - failed} passed, {failed} failed")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
