//! What ranks send each other for a flow, counted beside a model.
//!
//! The model sends one message to every neighbour, with these bytes in all:
//!
//! ```text
//! residual             8 M N_t N^D          for every cell at a cut and neighbour
//! product              8 2 M N_t N^(D-1)    for every facet at a cut: values and derivatives
//! application          4 2 M N_t N^(D-1)    for every facet at a cut: "blocks" sends traces in one of its two sweeps
//! maximum of a vector  8                    for every rank, to all
//! ```
//!
//! In an application a facet is sent by one of its two ranks in each sweep.
//!
//! Messages do not depend on the machine, so ranks are threads of this process.

use super::flow::{DT, Flow, periodic_box};
use super::subject::{Size, Subject};
use coupled::preconditioner::{BlockIlu, TimeScales};
use fem::{Blocks, Share};
use mesh::Mesh;
use navier_stokes::{Boundary, Compiled, NavierStokes};
use newton_krylov::inner_product::largest_size;
use newton_krylov::operator::Preconditioner;
use ranks::{Communicator, Counting, Sums, Threads};
use rayon::ThreadPoolBuilder;
use serde::Serialize;
use std::fmt;
use std::sync::Arc;

/// Ranks, with one block each.
const RANKS: usize = 8;

/// Cells per direction in 2-D and in 3-D.
const CELLS: [usize; 2] = [16, 6];

/// Messages and bytes, of a rank on average.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
struct Sent {
    messages: f64,
    bytes: f64,
}

/// One kernel at one order.
#[derive(Clone, Debug, Serialize)]
pub struct MessageCount {
    dimension: usize,
    order: usize,
    kernel: &'static str,
    counted: Sent,
    model: Sent,
}

impl MessageCount {
    /// The names of the columns.
    pub const HEADING: &str =
        "D   N  sent by each of 8 ranks     messages        model        bytes        model  bytes/model";
}

impl fmt::Display for MessageCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let MessageCount { dimension, order, kernel, counted, model } = self;
        let ratio = counted.bytes / model.bytes;
        write!(f, "{dimension}  {order:2}  {kernel:26} {:9.2} {:12.2}", counted.messages, model.messages)?;
        write!(f, " {:12.0} {:12.0} {ratio:12.3}", counted.bytes, model.bytes)
    }
}

/// The kernels, in the order of [`counted`] and [`model`].
const KERNELS: [&str; 4] = ["residual", "product", "application, blocks", "maximum of a vector"];

/// Counts the messages of all kernels at the order of `size`.
///
/// # Errors
/// Those of the mesh.
pub fn count<const D: usize, const M: usize>(size: Size) -> anyhow::Result<Vec<MessageCount>>
where
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let mesh = periodic_box::<D>(CELLS[D - 2], size.mesh_order)?;
    let blocks = Blocks { of_cell: mesh::blocks(&mesh, RANKS)?, groups: 1 };
    let of_ranks = Threads::run(RANKS, |communicator| {
        // A pool for each rank: in a common one, ranks that wait would keep others from sending.
        let pool = ThreadPoolBuilder::new().num_threads(1).build()?;
        pool.install(|| of_rank::<D, M>(&mesh, &blocks, size, communicator))
    });
    let of_ranks = of_ranks.into_iter().collect::<anyhow::Result<Vec<_>>>()?;
    let mean = |which: usize, kernel: usize| {
        let mean =
            |get: fn(&Sent) -> f64| of_ranks.iter().map(|rank| get(&rank[which][kernel])).sum::<f64>() / RANKS as f64;
        Sent { messages: mean(|sent| sent.messages), bytes: mean(|sent| sent.bytes) }
    };
    let row = |(number, kernel)| MessageCount {
        dimension: D,
        order: size.order,
        kernel,
        counted: mean(0, number),
        model: mean(1, number),
    };
    Ok(KERNELS.into_iter().enumerate().map(row).collect())
}

/// What one rank sends, and what it should send.
fn of_rank<const D: usize, const M: usize>(
    mesh: &Mesh<D>,
    blocks: &Blocks,
    size: Size,
    communicator: Arc<dyn Communicator>,
) -> anyhow::Result<[[Sent; KERNELS.len()]; 2]>
where
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let counting = Arc::new(Counting::new(communicator));
    let share = Share::new(mesh, blocks, Arc::new(Sums::new(counting.clone(), RANKS)));
    let mut flow = Flow::<D, M>::of_share(mesh, size, share)?;
    let expected = model(&flow, size.order);
    Ok([counted(&mut flow, &counting), expected])
}

/// The messages of this rank. A collective call.
fn counted<const D: usize, const M: usize>(
    flow: &mut Flow<D, M>,
    counting: &Counting<Arc<dyn Communicator>>,
) -> [Sent; KERNELS.len()]
where
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let mut preconditioner = BlockIlu::<f32>::new(&flow.operator, TimeScales { dt: DT, damping: 0.0 }, None);
    let sent = |run: &mut dyn FnMut()| {
        counting.reset();
        run();
        let traffic = counting.reset();
        Sent { messages: traffic.messages as f64, bytes: traffic.bytes as f64 }
    };
    let residual = sent(&mut || flow.run(0));
    let product = sent(&mut || flow.run(1));
    let mut out = vec![0.0; flow.state.len()];
    let application = sent(&mut || preconditioner.apply(&flow.state, &mut out));
    let maximum = sent(&mut || {
        largest_size(&flow.state, &flow.operator.share.sums);
    });
    [residual, product, application, maximum]
}

/// The model of the messages of this rank.
fn model<const D: usize, const M: usize>(flow: &Flow<D, M>, order: usize) -> [Sent; KERNELS.len()] {
    let (layout, share) = (flow.operator.layout, &flow.operator.share);
    let (cells, neighbours): (usize, usize) = (share.sent().map(|(_, cells)| cells).sum(), share.sent().count());
    let facets: usize = share.cut_facets().map(|(_, facets)| facets).sum();
    let sent = |messages: usize, bytes: usize| Sent { messages: messages as f64, bytes: bytes as f64 };
    [
        sent(neighbours, 8 * layout.cell_len() * cells),
        sent(neighbours, 8 * 2 * layout.cell_len() / order * facets),
        sent(2 * neighbours, 4 * 2 * layout.cell_len() / order * facets),
        sent(0, 8),
    ]
}
