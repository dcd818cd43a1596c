//! The sums of averages over a run; they go into checkpoints.

use super::moments::{Averaged, Moments};
use case::Averages;
use output::Arrays;

/// The beginning of the names of the arrays.
const NAME: &str = "statistics.averages";
/// The array of the offsets, which has numbers of every cell.
pub const OFFSETS: &str = "statistics.averages.offsets";
/// The array of the sums, which has numbers of every cell.
pub const MOMENTS: &str = "statistics.averages.moments";

/// Whether the array `name` of a checkpoint is of averages.
pub fn is_of_averages(name: &str) -> bool {
    name.starts_with(NAME)
}

/// The sums of a run over the cells of a rank; empty before the first slab that is averaged.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AverageSums {
    /// What is averaged, as numbers, see `plan`.
    plan: Vec<f64>,
    /// The averaged time of every phase; of the whole time without phases.
    pub durations: Vec<f64>,
    /// The offset that is subtracted from each quantity, `[cell][quantity][node]`.
    pub offsets: Vec<f64>,
    /// `[cell][phase][sum][node]`, see [`Moments`].
    pub moments: Vec<f64>,
    /// Integrals of the displacement, `[phase][C0 node][component]`.
    pub displacements: Vec<f64>,
}

/// The sums of a cell over some time.
pub struct OfCell<'a> {
    /// The time.
    pub duration: f64,
    /// The offset that is subtracted from each quantity, `[quantity][node]`.
    pub offsets: &'a [f64],
    /// `[sum][node]`, see [`Moments`].
    pub sums: Vec<f64>,
}

/// The start, the period, the number of phases and the fields of averages: sums of the same plan can be continued.
fn plan(wanted: &Averages) -> Vec<f64> {
    let (period, count) = wanted.phases.map_or((0.0, 1), |phases| (phases.period, phases.count));
    let fields = wanted.fields.iter().map(|field| f64::from(*field as u8));
    [wanted.from, wanted.to.unwrap_or(f64::INFINITY), period, count as f64].into_iter().chain(fields).collect()
}

impl AverageSums {
    /// Nothing yet, for numbers of cells, sums and nodes, and a `displacement` of so many numbers, 0 if its mean is not needed.
    pub fn new(wanted: &Averages, [cells, moments, nodes]: [usize; 3], displacement: usize) -> Self {
        let phases = wanted.phases.map_or(1, |phases| phases.count);
        AverageSums {
            plan: plan(wanted),
            durations: vec![0.0; phases],
            offsets: Vec::new(),
            moments: vec![0.0; phases * cells * moments * nodes],
            displacements: vec![0.0; phases * displacement],
        }
    }

    /// Whether nothing has been averaged.
    pub fn is_empty(&self) -> bool {
        self.durations.is_empty()
    }

    /// Whether a case that asks for averages can continue these: they are the same, and it has as many `cells` and `nodes`.
    pub fn fits<const D: usize>(&self, wanted: &Averages, cells: usize, nodes: usize) -> bool {
        let length = Moments::new::<D>(&wanted.fields).quantities.len() * cells * nodes;
        self.is_empty() || self.plan == plan(wanted) && self.offsets.len() == length
    }

    /// An average at the nodes of `cell`, `[component][node]`: over a phase, or over the whole time. NaN before the first time.
    pub fn of_cell(
        &self,
        moments: &Moments,
        average: &Averaged,
        cell: usize,
        nodes: usize,
        phase: Option<usize>,
    ) -> Vec<f64> {
        if self.is_empty() {
            return vec![f64::NAN; average.components() * nodes];
        }
        let OfCell { duration, offsets, sums } = self.sums_of_cell(moments, cell, nodes, phase);
        moments.average(average, duration, offsets, &sums)
    }

    /// The sums of a cell over a phase, or over the whole time.
    ///
    /// # Panics
    /// Before the first slab that is averaged.
    pub fn sums_of_cell(&self, moments: &Moments, cell: usize, nodes: usize, phase: Option<usize>) -> OfCell<'_> {
        let (count, length) = (self.durations.len(), moments.len() * nodes);
        let of_cell = &self.moments[cell * count * length..][..count * length];
        let chosen = |k: &usize| phase.is_none_or(|phase| phase == *k);
        let duration = (0..count).filter(chosen).map(|k| self.durations[k]).sum();
        let mut sums = vec![0.0; length];
        for k in (0..count).filter(chosen) {
            sums.iter_mut().zip(&of_cell[k * length..]).for_each(|(sum, of_phase)| *sum += of_phase);
        }
        let first = moments.quantities.len() * nodes;
        OfCell { duration, offsets: &self.offsets[cell * first..][..first], sums }
    }

    /// The mean displacement of the mesh in a phase, `[C0 node][component]`.
    pub fn mean_displacement(&self, phase: usize) -> Vec<f64> {
        let length = self.displacements.len() / self.durations.len();
        self.displacements[phase * length..][..length].iter().map(|sum| sum / self.durations[phase]).collect()
    }

    /// Numbers in every cell: offsets and sums, with so many `nodes`.
    pub fn cell_len<const D: usize>(wanted: &Averages, nodes: usize) -> usize {
        let (moments, phases) = (Moments::new::<D>(&wanted.fields), wanted.phases.map_or(1, |phases| phases.count));
        (moments.quantities.len() + phases * moments.len()) * nodes
    }

    /// The same averages, with the offsets and the sums of other cells.
    pub fn with_cells(&self, offsets: Vec<f64>, moments: Vec<f64>) -> Self {
        let AverageSums { plan, durations, displacements, .. } = self;
        let (plan, durations, displacements) = (plan.clone(), durations.clone(), displacements.clone());
        AverageSums { plan, durations, offsets, moments, displacements }
    }

    /// As named numbers, without those of cells; none before the first slab that is averaged.
    pub fn to_arrays(&self) -> Arrays {
        if self.is_empty() {
            return Arrays::new();
        }
        let arrays = [("plan", &self.plan), ("durations", &self.durations), ("displacements", &self.displacements)];
        arrays.map(|(name, values)| (format!("{NAME}.{name}"), values.clone().into())).into()
    }

    /// Back from named numbers; empty if there are none, `None` if they are incomplete.
    pub fn from_arrays(arrays: &Arrays) -> Option<Self> {
        let get = |name: &str| arrays.get(&format!("{NAME}.{name}")).map(|values| values.to_vec());
        let Some(plan) = get("plan") else { return Some(AverageSums::default()) };
        let durations = get("durations").filter(|durations| !durations.is_empty())?;
        Some(AverageSums {
            plan,
            durations,
            offsets: get("offsets")?,
            moments: get("moments")?,
            displacements: get("displacements")?,
        })
    }
}
