//! The legal numbers of keys, from their meaning and not from the checks of the program.

use crate::leaves::last_name;

/// Whether `value` makes sense at `path`. All numbers of a case are finite; for the keys below more is known.
pub fn is_legal_number(path: &str, value: &toml::Value) -> bool {
    let in_quotes = || value.as_str().and_then(|text| text.trim().parse().ok());
    let Some(number) = value.as_float().or_else(|| value.as_integer().map(|n| n as f64)).or_else(in_quotes) else {
        return true;
    };
    let domain = match last_name(path) {
        _ if path.starts_with("constants.") => Domain::Finite,
        "order" if path == "time.order" => Domain::Whole(1.0, 16.0),
        "order" => Domain::Whole(2.0, 16.0),
        "cells" | "slabs" | "every" | "checkpoint_every" | "core_cells" | "radial_cells" | "surface_cells"
        | "wake_cells" | "normal_cells" | "cells_per_side" | "layers" | "newton_steps" | "krylov_iterations"
        | "krylov_restart" | "steps" => Domain::Whole(1.0, f64::INFINITY),
        "seed" | "scramble" | "natural_modes" | "slab_halvings" => Domain::Whole(0.0, f64::INFINITY),
        "gamma" => Domain::Above(1.0, f64::INFINITY),
        "poisson_ratio" => Domain::Above(-1.0, 0.5),
        "newton_tolerance" => Domain::Above(0.0, 0.1_f64.next_up()),
        "krylov_tolerance" => Domain::Above(0.0, 1.0),
        "density" if path.contains(".expression.") => Domain::Finite,
        "mach" | "prandtl" | "viscosity" | "gas_constant" | "density" | "pressure" | "temperature" | "radius"
        | "height" | "lower_temperature" | "upper_temperature" | "length" | "step" | "tolerance" | "young_modulus"
        | "total_pressure" | "total_temperature" | "size_ratio" | "wall_ratio" | "first_cell" | "pitch" | "depth"
        | "thickness" | "far_field" | "hole" | "side" | "area" | "extent" | "inner_radius" | "outer_radius" => {
            Domain::Above(0.0, f64::INFINITY)
        }
        "constant" if path.ends_with("viscosity.constant") => Domain::Above(0.0, f64::INFINITY),
        "amplitude" if path.contains(".waves.") => Domain::Above(-f64::MIN_POSITIVE, 1.0),
        _ => Domain::Finite,
    };
    number.is_finite() && domain.contains(number)
}

enum Domain {
    /// Any number.
    Finite,
    /// Whole numbers from the first to the last.
    Whole(f64, f64),
    /// Numbers between the two, without them.
    Above(f64, f64),
}

impl Domain {
    fn contains(&self, number: f64) -> bool {
        match *self {
            Domain::Finite => true,
            Domain::Whole(first, last) => number.fract() == 0.0 && (first..=last).contains(&number),
            Domain::Above(lower, upper) => lower < number && number < upper,
        }
    }
}
