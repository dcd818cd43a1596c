"""Integral quantities of boundary layers, and spectra."""

import warnings

import numpy as np

try:
    import tomllib
except ImportError:
    tomllib = None

POINTS = 64


def spectrum(times, values, segments=1):
    """The power spectral density of a signal by Welch's method, as a pair of arrays: frequencies, densities.

    Values at uneven times are interpolated by cubics. Where a step is more than twice the mean step, a warning says so: what is faster than two
    such steps is lost. Segments overlap by a half. Each loses its mean and is multiplied by a Hann window. The integral over the frequency is the
    variance.
    """
    times, values = np.asarray(times, dtype=float), np.asarray(values, dtype=float)
    if times.ndim != 1 or times.shape != values.shape or len(times) < 8 or not (np.diff(times) > 0).all():
        raise ValueError("a spectrum needs at least 8 increasing times, and as many values")
    if not np.isfinite(values).all():
        raise ValueError("a spectrum needs finite values; those of a probe are NaN while its point is outside of the mesh")
    if not 1 <= segments <= len(times) // 8:
        raise ValueError(f"segments = {segments} is not in 1 to {len(times) // 8}: a segment has 8 values or more")
    signal, dt = _at_even_times(times, values)
    length = 2 * (len(signal) // (segments + 1)) if segments > 1 else len(signal)
    window = np.hanning(length + 1)[:-1]
    starts = [number * (length // 2) for number in range(segments)]
    parts = np.stack([signal[start : start + length] for start in starts])
    amplitudes = np.abs(np.fft.rfft((parts - parts.mean(axis=1, keepdims=True)) * window)) ** 2
    density = amplitudes.mean(axis=0) * dt / (window**2).sum()
    # Frequencies between zero and half of the rate stand for their negatives, too.
    density[1 : (length + 1) // 2] *= 2
    return np.fft.rfftfreq(length, dt), density


def _at_even_times(times, values):
    """As many values at even times, and the step. Each is on the cubic through the four points around it."""
    even = np.linspace(times[0], times[-1], len(times))
    step, longest = even[1] - even[0], np.diff(times).max()
    if np.abs(even - times).max() <= 1e-9 * step:
        return values, step
    if longest > 2 * step:
        warnings.warn(
            f"the longest step, {longest:g}, is {longest / step:.1f} times the mean one: variance at frequencies above {0.5 / longest:g} may be missing; "
            "leave out the rows with long steps",
            stacklevel=3,
        )
    first = np.clip(np.searchsorted(times, even, side="right") - 2, 0, len(times) - 4)
    around = first[:, None] + np.arange(4)
    t, signal = times[around], np.zeros(len(times))
    for i in range(4):
        others = [j for j in range(4) if j != i]
        weight = np.prod((even[:, None] - t[:, others]) / (t[:, i, None] - t[:, others]), axis=1)
        signal += weight * values[around[:, i]]
    return signal, step


def boundary_layer(result, wall, thickness, number=-1):
    """Integral quantities of the boundary layer at the points of `result.surface(wall, number)`, a dictionary of arrays.

    From each point a line runs into the gas along the normal of the wall, up to the distance `thickness`. Let u be the velocity relative
    to the wall, along the wall, in the direction of the edge. The edge n_e is where its size is largest, at the end of the line at most;
    u_e and rho_e are the values there:

        displacement_thickness   int_0^n_e (1 - rho u / (rho_e u_e)) dn
        momentum_thickness       int_0^n_e rho u / (rho_e u_e) (1 - u / u_e) dn
        energy_thickness         int_0^n_e rho u / (rho_e u_e) (1 - (u / u_e)^2) dn
        shape_factor             displacement_thickness / momentum_thickness
        thickness                the least distance with u >= 0.99 u_e
        edge_velocity            u_e

    Points whose line leaves the mesh have NaN. (H. Schlichting, K. Gersten: Boundary-Layer Theory.)
    """
    if not thickness > 0:
        raise ValueError(f"thickness = {thickness} is not positive")
    surface, axes = result.surface(wall, number), "xyz"[: result.dimension]
    step = _step_of(result, surface["t"])
    x = np.stack([surface[axis] for axis in axes], axis=-1)
    normal = -np.stack([surface[f"normal_{axis}"] for axis in axes], axis=-1)
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)
    # The velocity may still rise at the end of the line, which no node of the rule reaches.
    n, weights = np.append(0.5 * thickness * (1 + nodes), thickness), np.append(0.5 * thickness * weights, 0.0)
    line = x[:, None, :] + n[None, :, None] * normal[:, None, :]
    # Linear from the first two nodes to the wall.
    to_wall = np.array([n[1], -n[0]]) / (n[1] - n[0]) * _slides(result, wall, surface)[:, None]
    density, u = _along_edge(result, step, line, normal, to_wall)
    return _integrals(density, u, n, weights)


def _step_of(result, time):
    """The step of the result at the time of a distribution, which are written at times of their own."""
    step, times = result.step_at(time), np.asarray(result.times)
    # Only the spacing tells how close two times are: a run may last nanoseconds.
    scale = np.diff(times).min() if len(times) > 1 else abs(times).max()
    if abs(times[step] - time) > 1e-6 * scale:
        raise ValueError(f"the result has no step at t = {time:g}: `output.surfaces.every` must be a multiple of `output.every`")
    return step


def _slides(result, wall, surface):
    """Where gas sticks to a wall that slides along itself: there the gas at the wall has the velocity of the wall."""
    friction = sum(np.abs(values) for name, values in surface.items() if name.startswith("skin_friction"))
    return (friction > 0) & ("slide" in _condition(result.case_text, wall))


def _condition(case_text, wall):
    """The boundary condition of a wall, as text; the whole case before Python 3.11, which has no reader of TOML."""
    if tomllib is None:
        return case_text
    conditions = tomllib.loads(case_text)["flow"]["boundary"]
    return str(conditions.get(wall, conditions.get("others")))


def _along_edge(result, step, line, normal, to_wall):
    """The density, and the velocity along the wall in the direction of the edge: [point][node of the line]."""
    shape = line.shape[:-1]
    state = result.evaluate(line.reshape(-1, result.dimension), step).reshape(*shape, -1)
    velocity = state[..., 1:-1] / state[..., :1]
    if "mesh_velocity" in result.arrays:
        # At the wall the mesh moves with it.
        velocity = velocity - result.evaluate(line[:, 0], step, name="mesh_velocity")[:, None, :]
    velocity = velocity - (to_wall[:, :, None] * velocity[:, :2]).sum(axis=1, keepdims=True)
    along = velocity - (velocity * normal[:, None, :]).sum(axis=-1, keepdims=True) * normal[:, None, :]
    edge = np.argmax(np.nan_to_num(np.linalg.norm(along, axis=-1)), axis=1)
    direction = along[np.arange(len(edge)), edge]
    direction = direction / np.maximum(np.linalg.norm(direction, axis=-1, keepdims=True), 1e-300)
    return state[..., 0], (along * direction[:, None, :]).sum(axis=-1)


def _integrals(density, u, n, weights):
    rows = np.arange(len(u))
    edge = np.argmax(np.nan_to_num(u), axis=1)
    rho_e, u_e = density[rows, edge, None], u[rows, edge, None]
    inside = np.arange(len(n))[None, :] <= edge[:, None]
    flux, ratio = np.where(inside, density * u / (rho_e * u_e), 1.0), np.where(inside, u / u_e, 1.0)
    # By rounding, the end of the line may lie outside of the mesh.
    lost = ~np.isfinite(u[:, :-1]).all(axis=1)
    integral = lambda integrand: np.where(lost, np.nan, (np.where(inside, integrand, 0.0) * weights).sum(axis=1))
    displacement, momentum = integral(1 - flux), integral(flux * (1 - ratio))
    return {
        "displacement_thickness": displacement,
        "momentum_thickness": momentum,
        "energy_thickness": integral(flux * (1 - ratio**2)),
        "shape_factor": displacement / momentum,
        "thickness": np.where(lost, np.nan, _first_crossing(n, ratio, 0.99)),
        "edge_velocity": np.where(lost, np.nan, u_e[:, 0]),
    }


def _first_crossing(n, ratio, level):
    """The least distance with `ratio` at `level`, linear between the nodes."""
    after = np.argmax(ratio >= level, axis=1)
    before, rows = np.maximum(after - 1, 0), np.arange(len(ratio))
    rise = ratio[rows, after] - ratio[rows, before]
    part = np.where(rise > 0, (level - ratio[rows, before]) / np.where(rise > 0, rise, 1.0), 1.0)
    return n[before] + part * (n[after] - n[before])
