//! Choices of a case that are allowed, but likely wrong.

use super::Facts;
use super::resolution::{
    free_flow, layer, longest_slab, passages, poor_cells, quadrature, slab_length, times_of_quadrature,
};
use super::scales::{MotionScales, on_walls, speed_at_start};
use super::{bodies, gas, streams};
use case::expression::Overshoot;
use case::{Flow, Largest, Motion, Preconditioner, Support};
use elasticity::NEARLY_INCOMPRESSIBLE;
use navier_stokes::Riemann;
use simulation::{
    PrescribedNode, jump_of_centrifugal_force, speed_of_bodies_at_start, undetermined, unheld_in_equilibrium,
};

/// A spline that leaves two neighbouring points by more than this part of the range of all values is hardly meant.
const UNMEANT: f64 = 0.5;

/// A far field nearer than this, in reference lengths, influences the flow.
const FAR: f64 = 10.0;

/// The reference length and that of bodies in the mesh differ by at most this factor, unless another unit of length was meant.
const UNLIKE: f64 = 20.0;

/// A wall that is faster than this at the start, relative to the flow, causes a shock.
const SUDDEN: f64 = 0.01;

/// At a larger acoustic CFL number cells alone are a poor preconditioner. On a vortex of order 4 they take 18 iterations per slab at 0.9, 44 at
/// 2.2, 116 at 4.5; blocks take 7, 9 and 12.
const CFL_OF_CELLS_ALONE: f64 = 1.0;

/// From this Mach number on, shocks may form.
const TRANSONIC: f64 = 0.8;

/// A result file above this size causes a warning, in MB.
const LARGE_FILE: f64 = 5000.0;

/// A choice that is likely wrong.
pub(super) struct Warning {
    /// Its subject, in a word or two.
    pub(super) subject: &'static str,
    /// The problem, and the remedy.
    pub(super) text: String,
}

/// A table whose spline is far beyond its points.
fn overshoot<const D: usize>(facts: &Facts<'_, D>) -> Option<Warning> {
    let mut tables = facts.case.about.tables.iter();
    let (name, Overshoot { t, value, between: [before, after] }) =
        tables.find_map(|(name, table)| Some((name, table.overshoot(UNMEANT)?)))?;
    let text = format!(
        "the spline through `tables.{name}` is {value:.3e} at {t:.3e}, between the values {before} and {after}: more points where it bends, or a \
         wider step"
    );
    warning("table", text)
}

/// All warnings about a case.
pub(super) fn warnings<const D: usize>(facts: &Facts<'_, D>) -> Vec<Warning> {
    let of_flow = facts.case.flow.as_ref().map(|flow| {
        let walls = on_walls(facts, flow);
        let of_boundaries = [
            body(facts, flow),
            gas::friction(facts, flow),
            streams::exact(flow),
            streams::rotating_frame(facts, flow),
            streams::unlike(facts, flow),
            streams::unlike_reference(facts, flow),
            streams::other_mach(flow),
            streams::drag_direction(facts, flow),
            jump_of_centrifugal_force(facts.case).and_then(|text| warning("rotating frame", text)),
            far_field(facts, flow),
            reference_length(facts, flow),
        ];
        let of_start = [
            start(facts, flow, &walls),
            sudden_flow(facts, flow),
            gas::sutherland(flow),
            gas::gamma(flow),
            gas::wall_temperature(facts, flow),
            unbalanced_pressure(facts, flow),
            unheld_in_equilibrium(facts.case).and_then(|text| warning("equilibrium", text)),
            fast_walls(facts, flow, &walls),
        ];
        let of_resolution = [
            quadrature(facts, flow),
            times_of_quadrature(facts, flow, &walls),
            passages(facts, flow),
            layer(facts, flow),
            free_flow(facts, flow),
            mach(flow),
            slow_flow(flow),
            lines(facts, flow),
        ];
        let of_bodies = bodies::warnings(facts, flow);
        let of_search = undetermined(facts.case).into_iter().map(|text| warning("steady flow", text));
        of_boundaries.into_iter().chain(of_start).chain(of_resolution).chain(of_bodies).chain(of_search)
    });
    let of_all = [
        overshoot(facts),
        slab_length(facts),
        longest_slab(facts),
        file_size(facts),
        poor_cells(facts),
        incompressible(facts),
    ];
    of_all.into_iter().chain(of_flow.into_iter().flatten()).flatten().collect()
}

/// A pressure at rest above this part of Young's modulus deforms a structure visibly.
const COMPRESSED: f64 = 1e-3;

pub(super) fn warning(subject: &'static str, text: String) -> Option<Warning> {
    Some(Warning { subject, text })
}

/// A boundary that moves while others rest is usually a body.
fn body<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Option<Warning> {
    let Some(Motion::Elastic { boundary, .. }) = &facts.case.motion else { return None };
    let rests = boundary.iter().any(Option::is_none);
    let open = |index: &usize| boundary[*index].is_some() && !flow.boundary[*index].condition.is_solid();
    let name = &facts.case.mesh.boundary_names()[(0..boundary.len()).find(open).filter(|_| rests)?];
    let text = format!(
        "`{name}` moves while other boundaries rest, and is no wall: gas passes through it; `flow.boundary.{name} = {{ adiabatic_wall = {{}} }}`, or \
         \"slip_wall\" for a gas without viscosity"
    );
    warning("moving boundary", text)
}

/// The preconditioner by lines neglects neighbours.
fn lines<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Option<Warning> {
    let cfl = facts.acoustic_cfl(flow);
    if facts.case.preconditioner() != Preconditioner::Lines || cfl <= CFL_OF_CELLS_ALONE {
        return None;
    }
    let text = format!(
        "the acoustic CFL number is {cfl:.1}, and `solver.preconditioner = \"lines\"` takes cells alone: \"blocks\", or a `time.step` of {:.2e} or less",
        facts.case.time.step * CFL_OF_CELLS_ALONE / cfl
    );
    warning("preconditioner", text)
}

fn far_field<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Option<Warning> {
    let distance = facts.walls?.far_field / flow.reference_length;
    // Faster than sound, nothing outside hears of the walls.
    if distance >= FAR || flow.law.reference.mach() > 1.0 {
        return None;
    }
    let text = format!(
        "{distance:.2} reference lengths from the walls: forces will feel it; a larger mesh (`far_field` or `outer_radius` of a generator), {FAR} or more, or \
         `flow.reference.length` if that is not the size of the body"
    );
    warning("far field", text)
}

/// Coefficients, the Reynolds number and scales of time belong to a length of the flow, not to a unit of length.
fn reference_length<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Option<Warning> {
    let (reference, [length, largest]) = (flow.reference_length, flow.lengths_in(&facts.case.mesh));
    if flow.walls.is_empty() || (length / UNLIKE..=largest * UNLIKE).contains(&reference) {
        return None;
    }
    let of_time = if flow.time_length == reference {
        ", and scales of time such as the first step of a steady start"
    } else {
        ""
    };
    let text = format!(
        "`flow.reference.length` is {reference}, and what the flow passes in the mesh has a length of {length}: coefficients, the Reynolds number \
         and numbers of this table refer to the former{of_time}; `flow.reference = {{ ..., length = {length} }}` if that is not meant; `Mesh.ScalingFactor = 0.001` in Gmsh if the mesh is in millimetres"
    );
    warning("reference length", text)
}

/// A wall that has a speed at the start pushes the gas suddenly, for any motion of the interior mesh. A restart compares the motions of both runs.
fn start<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>, walls: &[PrescribedNode<D>]) -> Option<Warning> {
    let speed = speed_at_start(facts.case, walls).unwrap_or(0.0).max(speed_of_bodies_at_start(facts.case));
    let relative = speed / flow.reference_speed;
    if relative <= SUDDEN || facts.case.restart.is_some() {
        return None;
    }
    let text = format!(
        "walls start with a speed of {speed:.2e}, {relative:.2e} of that of the flow, which sends a pressure wave into it: a motion that starts from \
         rest, for instance multiplied by (1 - exp(-(t/T)^2)), or a table with `ends = \"at_rest\"`"
    );
    warning("start of the motion", text)
}

/// A uniform stream does not satisfy no-slip walls: as the initial state it makes boundary layers form suddenly.
fn sudden_flow<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Option<Warning> {
    let (case, moves) = (facts.case, flow.uniform_velocity?.iter().any(|w| *w != 0.0));
    let begins_with_it = case.restart.is_none() && case.solver.steady.is_none();
    if !moves || !begins_with_it || facts.walls?.cell_height.is_none() || flow.exact.is_some() {
        return None;
    }
    let text = "the flow starts uniform, and walls without slip stop it at once: an empty section `[solver.steady]`, which starts from the steady \
                flow, if there is one; otherwise the first time units are those of that start";
    warning("start of the flow", text.to_owned())
}

/// Walls nearly as fast as sound cause shocks in a gas at rest. Often the amplitude or the period has another unit than meant.
fn fast_walls<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>, walls: &[PrescribedNode<D>]) -> Option<Warning> {
    let sound = flow.reference_speed / flow.law.reference.mach();
    let relative = MotionScales::new(facts.case, walls)?.speed / sound;
    if relative <= TRANSONIC || flow.law.shock_capturing.is_some() {
        return None;
    }
    let text = format!(
        "walls move with up to {relative:.2} of the speed of sound, {sound:.3e}: shocks may form, and nothing captures them: \
         `shock_capturing = {{}}` in `[flow]`; or another amplitude or period, if that is not what was meant"
    );
    warning("speed of walls", text)
}

/// Where no gas crosses the cells' faces, the waves of sound alone damp what the products of polynomials add.
fn slow_flow<const D: usize>(flow: &Flow<D>) -> Option<Warning> {
    let is_slow = matches!(flow.law.riemann, Riemann::LowMachRoe { .. });
    (is_slow && !flow.law.volume_flux.is_split()).then(|| Warning {
        subject: "shear",
        text: "with `flow.riemann = \"low_mach_roe\"` shear layers along the mesh grow without a cause: `quadrature = \"collocated_lobatto\"` with \
               `volume_flux = \"kinetic_energy\"` in `[flow]` keeps them; or `riemann = \"roe\"`"
            .to_owned(),
    })
}

fn mach<const D: usize>(flow: &Flow<D>) -> Option<Warning> {
    let mach = flow.law.reference.mach();
    match mach {
        _ if mach > TRANSONIC && flow.law.shock_capturing.is_none() => warning(
            "Mach number",
            format!("{mach:.2}: shocks may form, and nothing captures them: `shock_capturing = {{}}` in `[flow]`"),
        ),
        _ if mach < 0.02 => {
            let remedy = match flow.law.riemann {
                Riemann::LowMachRoe { .. } => "",
                _ => {
                    ", and `flow.riemann = \"low_mach_roe\"` loses less, with `quadrature = \"collocated_lobatto\"` and \
                      `volume_flux = \"kinetic_energy\"`"
                }
            };
            let text = format!(
                "{mach:.1e}: fluxes for compressible flow lose accuracy in flow so slow: 0.02 to 0.2 differs little from 0{remedy}"
            );
            warning("Mach number", text)
        }
        _ if mach < 0.1 && flow.law.riemann == Riemann::LaxFriedrichs => {
            let text = format!(
                "{mach:.1e} with `flow.riemann = \"lax_friedrichs\"`, which damps every difference with the speed of sound: a steady flow \
                 takes 2 to 8 times the Krylov iterations at a Mach number of 0.05 and up to 23 times at 0.02, and low orders lose accuracy; \
                 cheaper: `flow.riemann = \"roe\"`"
            );
            warning("Mach number", text)
        }
        _ => None,
    }
}

/// Nearly incompressible structures lock at low orders. At 0.49999 a beam of order 3 bends by 14 % too little.
fn incompressible<const D: usize>(facts: &Facts<'_, D>) -> Option<Warning> {
    let ratio = facts.case.structure.as_ref()?.largest.poisson_ratio;
    if ratio <= NEARLY_INCOMPRESSIBLE {
        return None;
    }
    let text = format!(
        "`structure.poisson_ratio` of {ratio} is nearly that of an incompressible material: low orders are too stiff, and Newton's method may \
         fail; {NEARLY_INCOMPRESSIBLE} or less, or a mesh of order 6 or more"
    );
    warning("Poisson's ratio", text)
}

/// A structure that the pressure of the gas at rest compresses at once.
fn unbalanced_pressure<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Option<Warning> {
    let structure = facts.case.structure.as_ref()?;
    let part = structure.part.as_ref()?;
    let Largest { shear_modulus, poisson_ratio, .. } = structure.largest;
    let pressure = flow.reference_pressure();
    let strain = pressure / (2.0 * shear_modulus * (1.0 + poisson_ratio));
    let is_balanced = |wall: &usize| match &structure.boundary[*wall] {
        Support::Free => false,
        // The pressure of the gas pushes as a load of the same sign would.
        Support::Pressure(load) | Support::FollowerPressure(load) => {
            load.as_constant().is_none_or(|load| (load + pressure).abs() < 0.5 * pressure)
        }
        _ => true,
    };
    if strain <= COMPRESSED || part.wet.iter().all(is_balanced) {
        return None;
    }
    let text = format!(
        "the pressure of the gas at rest is {strain:.1e} of Young's modulus, and compresses the structure at once: a load on its walls to the flow \
         that balances it, `structure.boundary.NAME = {{ follower_pressure = \"-pressure\" }}` with the minus, if that is not meant"
    );
    warning("pressure on the structure", text)
}

fn file_size<const D: usize>(facts: &Facts<'_, D>) -> Option<Warning> {
    let size = facts.result_megabytes;
    if size <= LARGE_FILE {
        return None;
    }
    warning(
        "result file",
        format!("about {:.0} GB: `output.every` of more than {}", size / 1e3, facts.case.output.every),
    )
}
