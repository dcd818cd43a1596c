//! What ranks exchange between the stages of an elimination.

use super::blocks::Link;
use super::ordering::{Ordering, Stage};
use fem::Share;

/// A coupling across a cut between ranks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crossing {
    /// The number of the coupling.
    pub coupling: usize,
    /// The own cell, and its face.
    pub own: usize,
    pub own_face: usize,
    /// The ghost, and its face.
    pub ghost: usize,
    pub ghost_face: usize,
}

/// The messages after a stage.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Exchange {
    /// From own cells of the stage to ghosts.
    pub outgoing: Vec<Crossing>,
    /// From ghosts of the stage to own cells.
    pub incoming: Vec<Crossing>,
    /// The ghost and the number of every outgoing crossing.
    sends: Vec<(usize, usize)>,
    /// The ghost of every incoming crossing.
    receives: Vec<usize>,
}

/// The messages after every stage.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cuts {
    /// On the way forward: earlier cells send to later ones.
    pub forward: Vec<Exchange>,
    /// On the way back: later cells send to earlier ones.
    pub backward: Vec<Exchange>,
    /// All crossings.
    pub crossings: Vec<Crossing>,
}

impl Cuts {
    /// Of a rank with so many `own` cells.
    pub fn new(links: &[Vec<Link>], ordering: &Ordering, own: usize) -> Self {
        let mut crossings = Vec::new();
        for (cell, links) in links.iter().enumerate().take(own) {
            let across = links.iter().filter(|link| link.cell >= own);
            crossings.extend(across.map(|link| Crossing {
                coupling: link.coupling,
                own: cell,
                own_face: link.face,
                ghost: link.cell,
                ghost_face: link.other_face,
            }));
        }
        // In this order the other rank has them, too.
        crossings.sort_by_key(|crossing| crossing.coupling);
        let exchanges = |is_forward: bool| -> Vec<Exchange> {
            ordering.stages.iter().map(|stage| exchange(&crossings, ordering, stage, is_forward)).collect()
        };
        Cuts { forward: exchanges(true), backward: exchanges(false), crossings }
    }
}

fn exchange(crossings: &[Crossing], ordering: &Ordering, stage: &Stage, is_forward: bool) -> Exchange {
    let position = |cell: usize| ordering.positions[cell];
    let sends = |from: usize, to: usize| (position(from) < position(to)) == is_forward;
    let leaves =
        |crossing: &&Crossing| stage.own.contains(&position(crossing.own)) && sends(crossing.own, crossing.ghost);
    let arrives =
        |crossing: &&Crossing| stage.ghosts.contains(&position(crossing.ghost)) && sends(crossing.ghost, crossing.own);
    Exchange::new(
        crossings.iter().filter(leaves).copied().collect(),
        crossings.iter().filter(arrives).copied().collect(),
    )
}

impl Exchange {
    /// Of these crossings.
    fn new(outgoing: Vec<Crossing>, incoming: Vec<Crossing>) -> Self {
        let sends = outgoing.iter().enumerate().map(|(number, crossing)| (crossing.ghost, number)).collect();
        let receives = incoming.iter().map(|crossing| crossing.ghost).collect();
        Exchange { outgoing, incoming, sends, receives }
    }

    /// Sends `len` numbers along every outgoing crossing, and passes those of the incoming ones to `put`. A collective call.
    pub fn run(
        &self,
        share: &Share,
        len: usize,
        pack: impl Fn(&Crossing, &mut Vec<f64>),
        mut put: impl FnMut(&Crossing, &[f64]),
    ) {
        let pack = |_, item: usize, out: &mut Vec<f64>| pack(&self.outgoing[item], out);
        share.exchange_across(&self.sends, &self.receives, len, pack, |item, numbers| {
            put(&self.incoming[item], numbers)
        });
    }
}
