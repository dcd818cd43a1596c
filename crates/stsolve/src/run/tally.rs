//! Sums over a run, for summary.json; they go into checkpoints.

use coupled::{MeshQuality, SlabReport};
use std::collections::BTreeMap;

/// What a run has done so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// Attempts at slabs that were rejected.
    pub rejected: u64,
    /// Newton steps.
    pub newton: u64,
    /// Newton steps of the slab with most of them.
    pub newton_max: u64,
    /// Krylov iterations.
    pub krylov: u64,
    /// Krylov iterations of the Newton step with most of them.
    pub krylov_max: u64,
    /// CG iterations of the mesh.
    pub elasticity: u64,
    /// Evaluations of the residual.
    pub residuals: u64,
    /// Jacobian products.
    pub products: u64,
    /// The worst of the mesh.
    pub quality: Option<MeshQuality>,
    /// Where the mesh was invalid first.
    pub first_invalid: Option<FirstInvalid>,
    /// The first time at which a sampled det J was not positive.
    pub first_invalid_sampled: Option<f64>,
    /// Integrals of all components at the start.
    pub totals_at_start: Vec<f64>,
    /// What has left through each boundary, `[boundary][component]`.
    pub through: Vec<Vec<f64>>,
    /// The largest of the mass errors, relative to the mass at the start.
    pub mass_error: f64,
}

/// Where a mesh became invalid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstInvalid {
    /// The first time at which a cell is not proved to be valid.
    pub time: f64,
    /// The worst cell of that slab.
    pub cell: usize,
}

impl Tally {
    /// Adds a slab.
    pub fn add(&mut self, report: &SlabReport) {
        self.rejected += report.rejected as u64;
        let steps = report.newton.steps.len() as u64;
        self.newton += steps;
        self.newton_max = self.newton_max.max(steps);
        self.krylov += report.newton.krylov_iterations as u64;
        let most = report.newton.steps.iter().map(|step| step.krylov_iterations as u64).max().unwrap_or(0);
        self.krylov_max = self.krylov_max.max(most);
        self.elasticity += report.counts.elasticity_iterations as u64;
        self.residuals += report.counts.residuals as u64;
        self.products += (report.counts.products + report.counts.mesh_products) as u64;
        self.add_quality(report.quality);
        self.through.resize(report.through.len(), vec![0.0; report.totals.len()]);
        for (sum, through) in self.through.iter_mut().zip(&report.through) {
            sum.iter_mut().zip(through).for_each(|(sum, through)| *sum += through);
        }
        self.mass_error = self.mass_error.max(self.mass_balance(&report.totals).abs());
    }

    /// Adds the quality of the mesh in a slab.
    pub fn add_quality(&mut self, quality: MeshQuality) {
        self.quality = Some(self.quality.map_or(quality, |worst| worst.worst(quality)));
    }

    /// (mass now + mass that has left - mass at the start) / mass at the start
    pub fn mass_balance(&self, totals: &[f64]) -> f64 {
        let left: f64 = self.through.iter().map(|through| through[0]).sum();
        let start = self.totals_at_start.first().copied().unwrap_or(f64::NAN);
        (totals[0] + left - start) / start
    }

    /// As named numbers.
    pub fn to_arrays(&self) -> BTreeMap<String, Vec<f64>> {
        let counts = [
            self.rejected,
            self.newton,
            self.newton_max,
            self.krylov,
            self.krylov_max,
            self.elasticity,
            self.residuals,
            self.products,
        ];
        let quality = self
            .quality
            .map_or(Vec::new(), |q| vec![q.lower_bound, q.sampled_min, q.scaled_jacobian, q.cell as f64, q.time]);
        BTreeMap::from([
            ("tally.counts".into(), counts.map(|n| n as f64).to_vec()),
            ("tally.quality".into(), quality),
            (
                "tally.first_invalid".into(),
                self.first_invalid.map_or(Vec::new(), |first| vec![first.time, first.cell as f64]),
            ),
            ("tally.first_invalid_sampled".into(), self.first_invalid_sampled.into_iter().collect()),
            ("tally.totals_at_start".into(), self.totals_at_start.clone()),
            ("tally.through".into(), self.through.concat()),
            ("tally.mass_error".into(), vec![self.mass_error]),
        ])
    }

    /// Back from named numbers; `None` if some are missing.
    pub fn from_arrays(arrays: &BTreeMap<String, Vec<f64>>, boundaries: usize) -> Option<Self> {
        let get = |name: &str| arrays.get(&format!("tally.{name}"));
        let &[rejected, newton, newton_max, krylov, krylov_max, elasticity, residuals, products] = &get("counts")?[..]
        else {
            return None;
        };
        let quality = match get("quality")?[..] {
            [lower_bound, sampled_min, scaled_jacobian, cell, time] => {
                Some(MeshQuality { lower_bound, sampled_min, scaled_jacobian, cell: cell as usize, time })
            }
            _ => None,
        };
        let through = get("through")?;
        let components = through.len().checked_div(boundaries).unwrap_or(0).max(1);
        Some(Tally {
            rejected: rejected as u64,
            newton: newton as u64,
            newton_max: newton_max as u64,
            krylov: krylov as u64,
            krylov_max: krylov_max as u64,
            elasticity: elasticity as u64,
            residuals: residuals as u64,
            products: products as u64,
            quality,
            first_invalid: match get("first_invalid")?[..] {
                [time, cell] => Some(FirstInvalid { time, cell: cell as usize }),
                _ => None,
            },
            first_invalid_sampled: get("first_invalid_sampled")?.first().copied(),
            totals_at_start: get("totals_at_start")?.clone(),
            through: through.chunks(components).map(<[f64]>::to_vec).collect(),
            mass_error: *get("mass_error")?.first()?,
        })
    }
}
