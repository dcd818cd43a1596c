//! The flow through inflows and outflows, and whether their conditions are suited to it.
//!
//! Measured at the start and at the end of every slab, at points of the facets of inflows and outflows.

use super::failure::{Grid, Mismatch, Then, mismatch_at};
use case::{Case, Flow};
use mesh::{BoundaryFacet, Mesh, NodeNumbering, face_nodes, outward_area};
use navier_stokes::{Boundary, ExactState, Primitive};
use serde::Serialize;
use std::fmt;
use tensor::{dot, norm};

/// Gas slower than this fraction of the reference speed counts as resting: at the edge of a wall its direction is
/// round-off.
const RESTING: f64 = 0.01;

/// Less than this fraction of a boundary is a point or two, for a moment: it is recorded, but not reported during the
/// run.
const TOLD: f64 = 0.05;

/// Flow that a condition is not made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Misuse {
    /// Gas enters a subsonic inflow faster than sound.
    Supersonic,
    /// Gas leaves through an inflow.
    Leaving,
    /// Gas comes back through an outflow.
    Backflow,
    /// Gas at a supersonic inflow is subsonic.
    Subsonic,
    /// An inflow of a moving mesh is faster than the gas that enters there.
    Overtaking,
}

const ALL: [Misuse; 5] = [Misuse::Supersonic, Misuse::Leaving, Misuse::Backflow, Misuse::Subsonic, Misuse::Overtaking];

/// An observation at one time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Seen {
    /// The boundary.
    pub boundary: usize,
    /// The kind of misuse.
    pub misuse: Misuse,
    /// The fraction of the area.
    pub share: f64,
    /// The largest normal Mach number there relative to the facet; for [`Misuse::Subsonic`] the smallest.
    pub mach: f64,
}

/// A misuse over a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Record {
    /// The time of the first observation.
    pub since: f64,
    /// The present observation, with a share of 0 if it is over.
    pub now: Seen,
    /// The largest share so far.
    pub largest_share: f64,
}

/// Whether the condition of a boundary assumes that gas crosses it in one direction only.
pub fn is_opening<const D: usize>(condition: &Boundary<D>) -> bool {
    matches!(
        condition,
        Boundary::Inflow(_) | Boundary::VelocityInflow(_) | Boundary::SupersonicInflow(_) | Boundary::Outflow(_)
    )
}

/// The misuse of `condition` by gas of sound speed `c` that leaves with `w_n` relative to the facet, which moves with `v_n` along its normal,
/// if any.
fn misuse<const D: usize>(condition: &Boundary<D>, [w_n, v_n]: [f64; 2], c: f64, resting: f64) -> Option<Misuse> {
    let found = match condition {
        Boundary::Inflow(_) | Boundary::VelocityInflow(_) if -w_n >= c => Misuse::Supersonic,
        Boundary::Inflow(_) if w_n > resting && w_n + v_n <= 0.0 => Misuse::Overtaking,
        Boundary::Inflow(_) | Boundary::SupersonicInflow(_) if w_n > resting => Misuse::Leaving,
        Boundary::Outflow(_) if w_n < -resting => Misuse::Backflow,
        Boundary::SupersonicInflow(_) if -w_n < c => Misuse::Subsonic,
        _ => return None,
    };
    Some(found)
}

/// All observations at the openings of `flow` at one time.
pub fn measure<const D: usize, const M: usize>(
    flow: &Flow<D>,
    mesh: &Mesh<D>,
    grid: &Grid<D>,
    then: &Then<D, M>,
) -> Vec<Seen> {
    let mut sums = vec![Sums::default(); flow.boundary.len()];
    for facet in mesh.boundary_facets() {
        if is_opening(&flow.boundary[facet.boundary].condition) {
            add(flow, grid, then, facet, &mut sums[facet.boundary]);
        }
    }
    let seen = |(boundary, sums): (usize, Sums)| {
        let part = move |(misuse, part): (Misuse, Part)| Seen {
            boundary,
            misuse,
            share: (part.area / sums.area).min(1.0),
            mach: part.mach,
        };
        ALL.into_iter().zip(sums.parts).filter(|(_, part)| part.area > 0.0).map(part)
    };
    sums.into_iter().enumerate().flat_map(seen).collect()
}

/// The observations for the initial state of `flow`, on the mesh at rest. If the run starts from a steady flow, that state is a guess,
/// and only whether it is supersonic counts.
pub fn at_start<const D: usize, const M: usize>(case: &Case<D>, flow: &Flow<D>) -> Vec<Record> {
    let mut records = Vec::new();
    let mut seen = with_start::<D, M, _>(case, flow, |grid, then| measure(flow, &case.mesh, grid, then));
    seen.retain(|seen| case.solver.steady.is_none() || seen.misuse == Misuse::Supersonic);
    enter(&mut records, &seen, case.time.start);
    records
}

/// Subsonic inflows and outflows, far fields, and walls with slip, at which the flow starts with a jump. That is a pressure or a temperature 1.5
/// times the other one, or a velocity of a Mach number of one. Gas at rest that a far field sets into motion is a choice.
pub fn jumps_at_start<const D: usize, const M: usize>(case: &Case<D>, flow: &Flow<D>) -> Vec<Mismatch> {
    let is_far = |boundary: &usize| matches!(flow.boundary[*boundary].condition, Boundary::FarField(_));
    let may_jump = |boundary: &usize| {
        let condition = &flow.boundary[*boundary].condition;
        let is_subsonic = is_opening(condition) && !matches!(condition, Boundary::SupersonicInflow(_));
        // A wall that moves may go with the gas.
        is_subsonic || is_far(boundary) || condition.is_slip() && case.motion.is_none()
    };
    let is_jump = |boundary: usize, found: &Mismatch| match found.quantity.contains("velocity") {
        true => found.size > 1.0 && !is_far(&boundary),
        false => found.size > 1.5_f64.ln(),
    };
    let boundaries = (0..flow.boundary.len()).filter(may_jump);
    with_start::<D, M, _>(case, flow, |grid, then| {
        boundaries
            .filter_map(|boundary| {
                mismatch_at(flow, &case.mesh, (grid, then), boundary).filter(|found| is_jump(boundary, found))
            })
            .collect()
    })
}

/// What `of` tells of the initial state of `flow`, on the mesh at rest.
fn with_start<const D: usize, const M: usize, R>(
    case: &Case<D>,
    flow: &Flow<D>,
    of: impl FnOnce(&Grid<D>, &Then<D, M>) -> R,
) -> R {
    let numbering = NodeNumbering::new(&case.mesh, case.mesh.order());
    let grid = Grid::new(&case.mesh, &numbering, flow.order);
    let (still, time) = (vec![0.0; grid.field_len()], case.time.start);
    let state = |_: usize, x: &[[f64; D]]| -> Vec<[f64; M]> { x.iter().map(|x| flow.initial.state(x, time)).collect() };
    of(&grid, &Then { time, displacement: &still, velocity: &still, state: &state })
}

/// The area of a boundary, and of the parts with each misuse.
#[derive(Clone, Copy, Default)]
struct Sums {
    area: f64,
    parts: [Part; ALL.len()],
}

#[derive(Clone, Copy, Default)]
struct Part {
    area: f64,
    mach: f64,
}

impl Part {
    fn add(&mut self, misuse: Misuse, area: f64, mach: f64) {
        let first = self.area == 0.0;
        self.area += area;
        self.mach = match misuse {
            _ if first => mach,
            Misuse::Subsonic => self.mach.min(mach),
            _ => self.mach.max(mach),
        };
    }
}

/// Adds the points of a facet, in a fixed order.
fn add<const D: usize, const M: usize>(
    flow: &Flow<D>,
    grid: &Grid<D>,
    then: &Then<D, M>,
    facet: &BoundaryFacet,
    sums: &mut Sums,
) {
    let (cell, face) = (facet.side.cell, facet.side.face);
    let (condition, gas) = (&flow.boundary[facet.boundary].condition, &flow.law.gas);
    let states: Vec<Primitive<f64, D>> = then.gas(gas, grid, cell);
    let velocities = grid.vectors(cell, then.velocity);
    let jacobians = grid.jacobians(cell, then.displacement);
    for (index, p) in face_nodes(D, grid.points, face).into_iter().enumerate() {
        let normal = outward_area(&jacobians[p], face);
        let size = norm(&normal);
        let area = size * trapezoid::<D>(grid.points, index);
        let v_n = dot(&velocities[p], &normal) / size;
        let w_n = (dot(&states[p].velocity, &normal) - dot(&velocities[p], &normal)) / size;
        let c = gas.sound_speed(states[p].density, states[p].pressure);
        sums.area += area;
        if let Some(found) = misuse(condition, [w_n, v_n], c, RESTING * flow.reference_speed) {
            sums.parts[found as usize].add(found, area, w_n.abs() / c);
        }
    }
}

/// The weight of a point of an equidistant grid on a face: a factor of one half for every line of which it is an end.
fn trapezoid<const D: usize>(points: usize, index: usize) -> f64 {
    let digit = |axis: usize| index / points.pow(axis as u32) % points;
    (0..D - 1).map(|axis| if digit(axis) == 0 || digit(axis) == points - 1 { 0.5 } else { 1.0 }).product()
}

/// Adds the observations at a `time` to the `records` of a run; returns those that reach [`TOLD`] now for the first time.
pub fn enter(records: &mut Vec<Record>, seen: &[Seen], time: f64) -> Vec<Record> {
    records.iter_mut().for_each(|record| record.now.share = 0.0);
    let mut reached = Vec::new();
    for &now in seen {
        let same = |record: &&mut Record| record.now.boundary == now.boundary && record.now.misuse == now.misuse;
        match records.iter_mut().find(same) {
            Some(record) => {
                let before = record.largest_share;
                (record.now, record.largest_share) = (now, before.max(now.share));
                if before < TOLD && now.share >= TOLD {
                    reached.push(*record);
                }
            }
            None => {
                let record = Record { since: time, now, largest_share: now.share };
                records.push(record);
                reached.extend((now.share >= TOLD).then_some(record));
            }
        }
    }
    reached
}

impl Record {
    /// Numbers of a record, for a checkpoint.
    pub fn to_numbers(self) -> [f64; 6] {
        let Seen { boundary, misuse, share, mach } = self.now;
        [boundary as f64, misuse as usize as f64, share, mach, self.since, self.largest_share]
    }

    /// Back from numbers; `None` if they are invalid.
    pub fn from_numbers(numbers: &[f64; 6]) -> Option<Self> {
        let &[boundary, misuse, share, mach, since, largest_share] = numbers;
        let misuse = *ALL.get(misuse as usize)?;
        Some(Record { since, now: Seen { boundary: boundary as usize, misuse, share, mach }, largest_share })
    }

    /// In words, with the name of the boundary.
    pub fn told<'a>(&'a self, boundary: &'a str) -> Told<'a> {
        Told { record: self, boundary }
    }
}

/// A record in words: the kind, the boundary, the share, the start.
pub struct Told<'a> {
    record: &'a Record,
    boundary: &'a str,
}

impl fmt::Display for Told<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (boundary, Seen { misuse, mach, .. }) = (self.boundary, self.record.now);
        match misuse {
            Misuse::Supersonic => write!(f, "gas enters through the subsonic inflow `{boundary}` faster than sound")?,
            Misuse::Leaving => write!(f, "gas leaves through the inflow `{boundary}`")?,
            Misuse::Backflow => write!(f, "gas comes back through the outflow `{boundary}`")?,
            Misuse::Subsonic => write!(f, "gas at the supersonic inflow `{boundary}` is subsonic")?,
            Misuse::Overtaking => {
                write!(f, "the inflow `{boundary}` moves into the domain faster than the gas, which is left outside")?;
            }
        }
        let percent = (100.0 * self.record.largest_share).max(0.1);
        let digits = if percent < 10.0 { 1 } else { 0 };
        let since = case::rounded_time(self.record.since);
        write!(f, " (normal Mach number {mach:.3}), on {percent:.digits$} % of it, since t = {since}")
    }
}

impl Misuse {
    /// The remedy, for the boundary of that name.
    pub fn remedy(self, boundary: &str) -> String {
        match self {
            Misuse::Supersonic => {
                format!(
                    "give the whole state: `flow.boundary.{boundary} = {{ supersonic_inflow = ... }}`, or `far_field` where the stream is oblique to \
                     the boundary"
                )
            }
            Misuse::Leaving => format!(
                "raise `total_pressure` of `{boundary}` above the pressure inside, or, at a supersonic inflow, let `velocity` point into the domain; \
                 or let the flow start from a state that fits it; where it shall go on both ways, take `far_field`"
            ),
            Misuse::Backflow => format!(
                "move `{boundary}` downstream, out of vortices and wakes, or take `far_field` where the flow outside is known"
            ),
            Misuse::Subsonic => format!(
                "take `inflow` or `velocity_inflow` for `{boundary}` if the gas is slower than sound, and `far_field` if only the part across the \
                 boundary is; if a shock has run into it, lower the pressure downstream"
            ),
            Misuse::Overtaking => format!(
                "let `{boundary}` move more slowly than the gas, or rest (`motion`); `far_field` lets gas pass both ways"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use navier_stokes::{Inflow, Outflow, SupersonicInflow, VelocityInflow};

    #[test]
    fn a_condition_is_made_for_one_direction_and_one_side_of_the_speed_of_sound() {
        let inflow = Boundary::<2>::Inflow(Inflow::new(1.0, 1.0, [1.0, 0.0]).unwrap());
        let outflow = Boundary::Outflow(Outflow::new(1.0, 1.0).unwrap());
        let [velocity, fast] =
            [Boundary::VelocityInflow(VelocityInflow::OfVelocity), Boundary::SupersonicInflow(SupersonicInflow)];
        let of = |condition, w_n| misuse(condition, [w_n, 0.0], 1.0, 0.01);
        assert_eq!(
            [of(&inflow, -2.0), of(&inflow, -0.5), of(&inflow, 0.5)],
            [Some(Misuse::Supersonic), None, Some(Misuse::Leaving)]
        );
        assert_eq!([of(&outflow, -0.5), of(&outflow, -0.001), of(&outflow, 2.0)], [Some(Misuse::Backflow), None, None]);
        assert_eq!([of(&velocity, -1.5), of(&velocity, 0.5)], [Some(Misuse::Supersonic), None]);
        assert_eq!([of(&fast, -1.5), of(&fast, -0.5)], [None, Some(Misuse::Subsonic)]);
        // Gas enters with 0.2 and the boundary follows it with 0.5: a higher total pressure was advised.
        assert_eq!(misuse(&inflow, [0.3, -0.5], 1.0, 0.01), Some(Misuse::Overtaking));
        assert_eq!(misuse(&inflow, [0.3, -0.1], 1.0, 0.01), Some(Misuse::Leaving));
    }

    #[test]
    fn records_keep_the_first_time_and_the_largest_share() {
        let seen = |share| Seen { boundary: 3, misuse: Misuse::Backflow, share, mach: 0.25 };
        let mut records = Vec::new();
        assert_eq!(enter(&mut records, &[seen(0.01)], 1.0), []);
        assert_eq!(
            enter(&mut records, &[seen(0.125)], 1.5),
            [Record { since: 1.0, now: seen(0.125), largest_share: 0.125 }]
        );
        assert_eq!(enter(&mut records, &[seen(0.5)], 2.0), []);
        assert_eq!(enter(&mut records, &[], 3.0), []);
        assert_eq!(records, [Record { since: 1.0, now: seen(0.0), largest_share: 0.5 }]);
        assert_eq!(Record::from_numbers(&records[0].to_numbers()), Some(records[0]));
        assert_eq!(Record::from_numbers(&[0.0, 9.0, 0.0, 0.0, 0.0, 0.0]), None);
        let text = records[0].told("outlet").to_string();
        assert_eq!(
            text,
            "gas comes back through the outflow `outlet` (normal Mach number 0.250), on 50 % of it, since t = 1"
        );
    }
}
