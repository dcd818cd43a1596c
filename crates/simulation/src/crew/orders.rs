//! Orders of rank 0 to the others.

use output::SolverState;
use ranks::Communicator;
use std::sync::Arc;

/// What all ranks do next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Make the march of their share.
    Build,
    /// Take their part of a state; what all ranks need of it follows, and then each receives its own cells.
    Restore,
    /// Search the steady flow, and let bodies go from it until all are in equilibrium.
    SearchSteadyFlow,
    /// Solve a slab.
    Advance,
    /// Send numbers of cells, which are listed.
    Send,
    /// Send the positions of their cells in the order of elimination.
    SendPlaces,
    /// Send the integrals over each of their cells.
    Integrate,
    /// Drop averages that the run does not continue.
    BeginAverages,
    /// Add up the components of the flow.
    AddUp,
    /// Send the errors of each of their cells.
    Measure,
    /// Write their cells of a step to a file.
    WriteStep,
    /// Write their cells of a state to a file.
    WriteState,
    /// Tell their largest memory.
    TellMemory,
    /// End.
    Finish,
}

const ORDERS: [Order; 14] = [
    Order::Build,
    Order::Restore,
    Order::SearchSteadyFlow,
    Order::Advance,
    Order::Send,
    Order::SendPlaces,
    Order::Integrate,
    Order::BeginAverages,
    Order::AddUp,
    Order::Measure,
    Order::WriteStep,
    Order::WriteState,
    Order::TellMemory,
    Order::Finish,
];

/// Sends the orders of rank 0. When it is dropped, it orders the others to finish.
pub struct Orders(Arc<dyn Communicator>);

impl Orders {
    /// Orders to the other ranks of `communicator`.
    pub fn new(communicator: Arc<dyn Communicator>) -> Self {
        Orders(communicator)
    }

    /// The ranks.
    pub fn communicator(&self) -> &Arc<dyn Communicator> {
        &self.0
    }

    /// Gives an order; a state may go with it.
    pub(super) fn give(&self, order: Order, state: Option<&SolverState>) {
        if self.0.size() > 1 {
            let mut bytes = vec![order as u8];
            state.into_iter().for_each(|state| bytes.extend(encode(state)));
            self.0.broadcast(&mut bytes);
        }
    }
}

impl Drop for Orders {
    fn drop(&mut self) {
        self.give(Order::Finish, None);
    }
}

/// Waits for the next order and its data.
pub(super) fn receive(communicator: &dyn Communicator) -> (Order, Vec<u8>) {
    let mut bytes = Vec::new();
    communicator.broadcast(&mut bytes);
    let number = bytes.first().map_or(usize::MAX, |&number| number as usize);
    (ORDERS.get(number).copied().unwrap_or(Order::Finish), bytes.split_off(1.min(bytes.len())))
}

/// A state as bytes: integers and texts, each with their number first, then arrays, each as its name, its length and its numbers. Names and texts
/// have their length first.
fn encode(state: &SolverState) -> Vec<u8> {
    let mut bytes = (state.integers.len() as u64).to_le_bytes().to_vec();
    let name = |bytes: &mut Vec<u8>, name: &str| {
        bytes.extend((name.len() as u64).to_le_bytes());
        bytes.extend(name.bytes());
    };
    for (key, value) in &state.integers {
        name(&mut bytes, key);
        bytes.extend(value.to_le_bytes());
    }
    bytes.extend((state.texts.len() as u64).to_le_bytes());
    for (key, text) in &state.texts {
        name(&mut bytes, key);
        name(&mut bytes, text);
    }
    for (key, values) in &state.arrays {
        name(&mut bytes, key);
        bytes.extend((values.len() as u64).to_le_bytes());
        values.iter().for_each(|value| bytes.extend(value.to_le_bytes()));
    }
    bytes
}

/// The state behind [`encode`].
pub(super) fn decode(bytes: &[u8]) -> SolverState {
    let (mut state, mut rest) = (SolverState::default(), bytes);
    let integers = number(&mut rest).map_or(0, u64::from_le_bytes);
    for _ in 0..integers {
        let Some(key) = name(&mut rest) else { break };
        let value = number(&mut rest).map_or(0, i64::from_le_bytes);
        state.integers.insert(key, value);
    }
    let texts = number(&mut rest).map_or(0, u64::from_le_bytes);
    for _ in 0..texts {
        let (Some(key), Some(text)) = (name(&mut rest), name(&mut rest)) else { break };
        state.texts.insert(key, text);
    }
    while let Some(key) = name(&mut rest) {
        let length = number(&mut rest).map_or(0, u64::from_le_bytes);
        let values: Vec<f64> = (0..length).map_while(|_| number(&mut rest).map(f64::from_le_bytes)).collect();
        state.arrays.insert(key, values.into());
    }
    state
}

fn number(rest: &mut &[u8]) -> Option<[u8; 8]> {
    let (bytes, others) = rest.split_first_chunk()?;
    *rest = others;
    Some(*bytes)
}

fn name(rest: &mut &[u8]) -> Option<String> {
    let length = u64::from_le_bytes(number(rest)?) as usize;
    let (bytes, others) = rest.split_at_checked(length)?;
    *rest = others;
    Some(String::from_utf8_lossy(bytes).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_goes_through_bytes() {
        let mut state = SolverState::default();
        state.integers.extend([("slab".to_owned(), 7), ("stale".to_owned(), -1)]);
        state.texts.extend([("path".to_owned(), "runs/größer".to_owned()), ("none".to_owned(), String::new())]);
        state
            .arrays
            .extend([("flow".to_owned(), vec![0.1, -0.0, 1e300].into()), ("empty".to_owned(), Vec::new().into())]);
        let again = decode(&encode(&state));
        assert_eq!(again, state);
    }
}
