//! Conditions on boundaries over the whole run, at the places where the boundaries are then.

use super::boundary_data::BoundaryData;
use super::mesh_crate::{BoundaryFacet, Mesh, NodeNumbering};
use super::openings::{self, NodeAndNormal, nodes_of_facets};
use super::{Flow, Motion, Time, slide};
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw;
use coupled::BoundaryField;
use std::cell::OnceCell;

/// The largest number of facets of a boundary that are checked, so that a check stays cheap.
const MOST_FACETS: usize = 500;

/// The displacement of a node of a boundary, for (cell, node of the cell, position at rest, time).
type Displacement<'a, const D: usize> = Box<dyn Fn(usize, usize, &[f64; D], f64) -> [f64; D] + 'a>;

/// Boundaries of a flow whose motion is known before the run.
pub(super) struct OverRun<'a, const D: usize> {
    /// The source of errors.
    pub(super) checker: &'a Checker<'a>,
    /// The flow.
    pub(super) flow: &'a Flow<D>,
    /// Its mesh.
    pub(super) mesh: &'a Mesh<D>,
    /// The motion of the mesh.
    pub(super) motion: Option<&'a Motion<D>>,
    /// Whether a body or a structure moves a boundary.
    pub(super) moved: &'a [bool],
    /// The time that the run covers.
    pub(super) time: &'a Time,
    /// The C0 nodes, computed at first use.
    pub(super) numbering: OnceCell<NodeNumbering>,
}

impl<const D: usize> OverRun<'_, D> {
    /// Checks the conditions given in `raw`. Each of them is correct at the start.
    pub(super) fn check(&self, raw: &raw::Flow) -> Checked<()> {
        let key = Key::new("flow").child("boundary");
        let entries = self.checker.entries_of_boundaries(&key, &raw.boundary, self.mesh.boundary_names());
        entries.into_iter().try_for_each(|(boundary, key, raw)| self.check_boundary(boundary, &key, raw))
    }

    fn check_boundary(&self, boundary: usize, key: &Key, raw: &raw::Condition) -> Checked<()> {
        let data = &self.flow.boundary[boundary];
        let Some(displacement) = self.displacement(boundary).filter(|_| self.varies(data)) else { return Ok(()) };
        let facets = self.facets(boundary);
        let nodes_at =
            |t: f64| nodes_of_facets(self.mesh, facets.iter().copied(), |cell, k, x| displacement(cell, k, x, t));
        let at_start = nodes_at(self.time.start);
        for t in self.time.check_times() {
            let nodes = nodes_at(t);
            openings::check_at(self.checker, key, data, &nodes, t)?;
            slide::check(self.checker, key, raw, &nodes, t)?;
            self.check_direction(key, data, [&at_start, &nodes], t)?;
        }
        Ok(())
    }

    /// Whether the condition may change: its values do, or its boundary moves.
    fn varies(&self, data: &BoundaryData<D>) -> bool {
        data.data.is_some() || self.motion.is_some()
    }

    /// The displacement of a boundary; None if only the run finds it.
    fn displacement(&self, boundary: usize) -> Option<Displacement<'_, D>> {
        match self.motion {
            _ if self.moved[boundary] => None,
            None => Some(Box::new(|_, _, _, _| [0.0; D])),
            Some(Motion::Followed) => None,
            Some(Motion::Prescribed(displacement)) => Some(Box::new(|_, _, x, t| displacement.evaluate(x, t))),
            Some(Motion::Elastic { boundary: motions, slides, .. }) => match &motions[boundary] {
                Some(motion) => Some(Box::new(|cell, k, x, t| motion.displacement(self.node(cell, k), x, t))),
                None if slides[boundary].is_some() => None,
                None => Some(Box::new(|_, _, _, _| [0.0; D])),
            },
        }
    }

    /// The C0 node that is node `k` of a cell.
    fn node(&self, cell: usize, k: usize) -> usize {
        self.numbering.get_or_init(|| NodeNumbering::new(self.mesh, self.mesh.order())).cell(cell)[k]
    }

    /// Facets of a boundary, evenly spread if there are many.
    fn facets(&self, boundary: usize) -> Vec<&BoundaryFacet> {
        let all = self.mesh.boundary_facets().iter().filter(|facet| facet.boundary == boundary);
        let step = all.clone().count().div_ceil(MOST_FACETS).max(1);
        all.step_by(step).collect()
    }

    /// The velocity outside of an outflow with a relaxation is along the normal at the start, so that its boundary must not turn.
    fn check_direction(
        &self,
        key: &Key,
        data: &BoundaryData<D>,
        [at_start, nodes]: [&[NodeAndNormal<D>]; 2],
        t: f64,
    ) -> Checked<()> {
        if data.control.is_none() {
            return Ok(());
        }
        let mut pairs = at_start.iter().zip(nodes);
        let turned = pairs.find(|((_, normal), (_, then))| !openings::is_parallel(normal, then));
        let Some(((_, normal), (x, then))) = turned else { return Ok(()) };
        let problem = format!(
            "the boundary turns: at {x:.6?} and t = {t} its normal is {then:.6?}, and at the start it was {normal:.6?}"
        );
        let accepted = "a boundary that keeps its direction; for one that turns `velocity` alone";
        Err(self.checker.combination(&key.child("outflow").child("relaxation"), &problem, accepted))
    }
}
