//! [`RunStatistics`] as named numbers, in checkpoints.

use super::{BODIES, EnergyBalance, FirstInvalid, RunStatistics, Steady};
use crate::body_record::BodyRecord;
use crate::fallback;
use crate::openings::Record;
use coupled::{MeshQuality, Reliability, Stability};
use output::Arrays;

impl RunStatistics {
    /// As named numbers.
    pub fn to_arrays(&self) -> Arrays {
        let steady = self.steady.as_ref();
        let numbers = [
            ("counts", self.counts().map(|count| count as f64).to_vec()),
            ("quality", self.quality.as_ref().map_or_else(Vec::new, of_quality)),
            ("first_invalid", self.first_invalid.map_or_else(Vec::new, |first| vec![first.time, first.cell as f64])),
            ("first_invalid_sampled", self.first_invalid_sampled.into_iter().collect()),
            ("totals_at_start", self.totals_at_start.clone()),
            ("start_layer", self.start_layer.into_iter().collect()),
            ("left", self.left.clone()),
            ("controls", self.controls.clone()),
            ("controls_of_preconditioner", self.controls_of_preconditioner.clone()),
            ("impulses", self.impulses.concat()),
            ("forces", self.forces.concat()),
            ("steady", steady.map_or_else(Vec::new, of_steady)),
            ("reliability", steady.map_or_else(Vec::new, |steady| of_reliability(&steady.reliability))),
            ("errors", vec![self.mass_error, self.energy_error, self.coupled_energy_error]),
            ("structure", of_structure(&self.structure)),
            ("mass_flows", self.mass_flows.clone()),
            ("openings", self.openings.iter().flat_map(|record| record.to_numbers()).collect()),
        ];
        let named = numbers.into_iter().map(|(name, values)| (format!("statistics.{name}"), values));
        let others = [
            (fallback::SINCE.to_owned(), self.split_form_since.into_iter().collect()),
            (BODIES.to_owned(), self.bodies.iter().flat_map(BodyRecord::numbers).collect::<Vec<f64>>()),
        ];
        named.chain(others).map(|(name, values)| (name, values.into())).collect()
    }

    /// Whether the named numbers are those of a mesh that has become invalid.
    pub fn has_invalid_mesh(arrays: &Arrays) -> bool {
        arrays.get("statistics.first_invalid").is_some_and(|first| !first.is_empty())
    }

    /// Back from named numbers, for a run with a number of `walls`; `None` if some are missing.
    pub fn from_arrays(arrays: &Arrays, walls: usize) -> Option<Self> {
        let get = |name: &str| arrays.get(&format!("statistics.{name}")).map(|values| &values[..]);
        // Earlier versions did not have all of them.
        let list = |name: &str| get(name).unwrap_or_default().to_vec();
        let &[mass_error, energy_error, coupled_energy_error, ..] = get("errors")? else { return None };
        Some(RunStatistics {
            quality: to_quality(get("quality")?),
            first_invalid: to_first_invalid(get("first_invalid")?),
            first_invalid_sampled: get("first_invalid_sampled")?.first().copied(),
            totals_at_start: get("totals_at_start")?.to_vec(),
            start_layer: list("start_layer").first().copied(),
            split_form_since: fallback::since(arrays),
            left: get("left")?.to_vec(),
            impulses: by_wall(get("impulses")?, walls),
            forces: by_wall(get("forces")?, walls),
            steady: to_steady(get("steady")?, &list("reliability"), walls),
            mass_error,
            energy_error,
            coupled_energy_error,
            bodies: BodyRecord::read_all(get("bodies")?)?,
            structure: to_structure(get("structure")?)?,
            mass_flows: get("mass_flows")?.to_vec(),
            openings: get("openings")?.as_chunks().0.iter().map(Record::from_numbers).collect::<Option<_>>()?,
            controls: list("controls"),
            controls_of_preconditioner: list("controls_of_preconditioner"),
            ..Self::of_counts(get("counts")?)?
        })
    }

    fn counts(&self) -> [u64; 8] {
        let RunStatistics { rejected, newton, newton_max, krylov, krylov_max, elasticity, residuals, products, .. } =
            *self;
        [rejected, newton, newton_max, krylov, krylov_max, elasticity, residuals, products]
    }

    /// Back from the numbers of [`Self::counts`]; everything else is empty.
    fn of_counts(numbers: &[f64]) -> Option<Self> {
        let counts: [f64; 8] = numbers.try_into().ok()?;
        let [rejected, newton, newton_max, krylov, krylov_max, elasticity, residuals, products] =
            counts.map(|n| n as u64);
        let none = RunStatistics::default();
        Some(RunStatistics {
            rejected,
            newton,
            newton_max,
            krylov,
            krylov_max,
            elasticity,
            residuals,
            products,
            ..none
        })
    }
}

fn to_first_invalid(numbers: &[f64]) -> Option<FirstInvalid> {
    let [time, cell] = *numbers else { return None };
    Some(FirstInvalid { time, cell: cell as usize })
}

fn of_structure(balance: &EnergyBalance) -> Vec<f64> {
    let EnergyBalance { energy_at_start, load_work, support_work, dissipation, damped } = *balance;
    vec![energy_at_start, load_work, support_work, dissipation, damped]
}

fn to_structure(numbers: &[f64]) -> Option<EnergyBalance> {
    let [energy_at_start, load_work, support_work, dissipation, damped] = *numbers else { return None };
    Some(EnergyBalance { energy_at_start, load_work, support_work, dissipation, damped })
}

fn of_quality(quality: &MeshQuality) -> Vec<f64> {
    let MeshQuality { lower_bound, sampled_min, scaled_jacobian, cell, time } = *quality;
    vec![lower_bound, sampled_min, scaled_jacobian, cell as f64, time]
}

/// As numbers: the residual, or NaN, and the march where there was one.
fn of_reliability(reliability: &Reliability) -> Vec<f64> {
    let march = |s: Stability| [s.growth, s.duration, f64::from(u8::from(s.completed))];
    let residual = reliability.next_order_residual.unwrap_or(f64::NAN);
    std::iter::once(residual).chain(reliability.stability.into_iter().flat_map(march)).collect()
}

/// Back from numbers.
fn to_reliability(numbers: &[f64]) -> Reliability {
    let stability = match *numbers {
        [_, growth, duration, completed] => Some(Stability { growth, duration, completed: completed == 1.0 }),
        _ => None,
    };
    Reliability { next_order_residual: numbers.first().copied().filter(|r| !r.is_nan()), stability }
}

/// Numbers of `walls`, one after the other, by wall.
fn by_wall(numbers: &[f64], walls: usize) -> Vec<Vec<f64>> {
    let each = numbers.len().checked_div(walls).unwrap_or(0).max(1);
    numbers.chunks(each).map(<[f64]>::to_vec).collect()
}

/// The quality of the mesh; None unless there are five numbers.
fn to_quality(numbers: &[f64]) -> Option<MeshQuality> {
    let [lower_bound, sampled_min, scaled_jacobian, cell, time] = *numbers else { return None };
    Some(MeshQuality { lower_bound, sampled_min, scaled_jacobian, cell: cell as usize, time })
}

/// The steady start of a run with a number of `walls`, and its reliability; None if there was none.
fn to_steady(numbers: &[f64], reliability: &[f64], walls: usize) -> Option<Steady> {
    let [newton, krylov, residual, forces @ ..] = numbers else { return None };
    Some(Steady {
        newton: *newton as u64,
        krylov: *krylov as u64,
        residual: *residual,
        forces: by_wall(forces, walls),
        reliability: to_reliability(reliability),
    })
}

fn of_steady(steady: &Steady) -> Vec<f64> {
    [vec![steady.newton as f64, steady.krylov as f64, steady.residual], steady.forces.concat()].concat()
}
