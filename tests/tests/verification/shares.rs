//! The share of a rank: the residual, products and fluxes of the whole mesh, to the bit, and what is sent for them.

use crate::slab_operator::uniform_coefficients;
use fem::{Blocks, Bottom, Orders, Problem, Quadrature, Share, SlabOperator, StateField};
use mesh::{Mesh, NodeNumbering};
use navier_stokes::exact::FreeStream;
use navier_stokes::{AdiabaticWall, Boundary, Compiled, Exact, NavierStokes, Riemann, Viscosity};
use ranks::{Communicator, Counting, Sums, Threads, Traffic};
use std::sync::Arc;
use verification::{Noise, RULES, Rule, curved_box, free_stream, law, own_part};

const BLOCKS: usize = 5;

/// What is the same on all cells and on a share.
struct Setting<'a, const D: usize> {
    mesh: &'a Mesh<D>,
    law: NavierStokes<D>,
    orders: Orders,
    quadrature: Quadrature,
    /// State at the bottom and in the slab, and a direction, of all cells.
    cells: [Vec<f64>; 3],
    /// Displacement, velocities and a direction of the mesh.
    nodes: [Vec<f64>; 3],
}

/// Residual, product along state and mesh, and boundary fluxes.
type Found = (Vec<u64>, Vec<u64>, String);

/// The operator of a flow between walls at rest, on a share of `mesh`.
pub(crate) fn between_walls<const D: usize, const M: usize>(
    mesh: &Mesh<D>,
    law: &NavierStokes<D>,
    orders: Orders,
    quadrature: Quadrature,
    share: Share,
) -> SlabOperator<D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let names = mesh.boundary_names().len();
    let problem = Problem {
        kernels: law.kernels(vec![Boundary::AdiabaticWall(AdiabaticWall::new([0.0; D]).unwrap()); names]),
        data: vec![None; names],
        source: None,
    };
    SlabOperator::of_share(problem, mesh, &NodeNumbering::new(mesh, orders.mesh), orders, quadrature, share)
}

impl<const D: usize> Setting<'_, D> {
    fn operator<const M: usize>(&self, share: Share) -> SlabOperator<D, M>
    where
        Exact<FreeStream<D>>: StateField<D, M>,
        NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
    {
        between_walls(self.mesh, &self.law, self.orders, self.quadrature, share)
    }

    /// Evaluates everything on a share; `evaluated` is called before and after the product.
    fn evaluate<const M: usize>(&self, share: Share, evaluated: impl Fn()) -> Found
    where
        Exact<FreeStream<D>>: StateField<D, M>,
        NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
    {
        let mut operator = self.operator::<M>(share);
        let [bottom, state, direction] = self.cells.each_ref().map(|whole| own_part(&operator.share, whole));
        let [displacement, velocities, along] = &self.nodes;
        operator.begin_slab(0.3, 0.1, Bottom::new(&bottom, displacement));
        operator.set_mesh(velocities);
        let (mut residual, mut product) = (vec![0.0; state.len()], vec![0.0; state.len()]);
        operator.residual(&state, &mut residual).unwrap();
        evaluated();
        operator.product_with_mesh(&direction, along, &mut product);
        evaluated();
        let bits = |own: &[f64]| operator.share.join(own).iter().map(|x| x.to_bits()).collect();
        (bits(&residual), bits(&product), format!("{:?}", operator.boundary_fluxes(None)))
    }
}

fn setting<'a, const D: usize, const M: usize>(mesh: &'a Mesh<D>, (quadrature, volume_flux): Rule) -> Setting<'a, D>
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let orders = Orders { flow: 3, mesh: 3, time: 2 };
    let law = NavierStokes { volume_flux, ..law(Viscosity::Constant(0.01), Riemann::Hllc) };
    let [cells, nodes] = [Default::default(), Default::default()];
    let mut setting = Setting { mesh, law, orders, quadrature, cells, nodes };
    let operator = setting.operator::<M>(Share::whole(mesh));
    let uniform = free_stream::<D, M>(&setting.law).value(&[0.0; D], 0.0);
    let mut noise = Noise::new(11);
    let mut about = |slots: usize, amplitude: f64| -> Vec<f64> {
        uniform_coefficients(&operator, &uniform, slots).iter().map(|u| u + amplitude * noise.number()).collect()
    };
    setting.cells = [about(1, 0.01), about(2, 0.01), about(2, 1.0)];
    let field = operator.mesh.field_len();
    setting.nodes = [noise.vector(field, 1e-3), noise.vector(2 * field, 0.01), noise.vector(2 * field, 1.0)];
    setting
}

/// On three ranks everything has the bits of the whole mesh. A product sends one message to every neighbour: the traces at the cut.
fn assert_shares_make_the_whole<const D: usize, const M: usize>(cells: usize)
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let mesh = curved_box::<D>(cells, 3);
    let of_cell = mesh::blocks(&mesh, BLOCKS).unwrap();
    let blocks = Blocks { of_cell, groups: 1 };
    for rule in RULES {
        let setting = setting::<D, M>(&mesh, rule);
        let whole = setting.evaluate::<M>(Share::whole(&mesh), || ());
        let mut found = Threads::run(3, |communicator| {
            let counting = Arc::new(Counting::new(communicator));
            let sums = Arc::new(Sums::new(counting.clone() as Arc<dyn Communicator>, BLOCKS));
            let share = Share::new(&mesh, &blocks, sums);
            let sent: Vec<(usize, usize)> = share.cut_facets().collect();
            let traffic = std::sync::Mutex::new(Traffic::default());
            let found = setting.evaluate::<M>(share, || *traffic.lock().unwrap() = counting.reset());
            // Values and derivatives, at two times, of all components at the nodes of a face.
            let (traffic, face_len) = (traffic.into_inner().unwrap(), 2 * 2 * M * 3_usize.pow(D as u32 - 1));
            let bytes: usize = sent.iter().map(|(_, facets)| 8 * facets * face_len).sum();
            assert_eq!((traffic.messages, traffic.bytes), (sent.len() as u64, bytes as u64));
            assert_eq!((traffic.exchanges, traffic.collectives), (1, 0));
            found
        });
        assert!(found[0] == whole, "{D}-D, {rule:?}");
        found.drain(1..).for_each(|(.., fluxes)| assert_eq!(fluxes, whole.2));
    }
}

/// Rank 0 receives the numbers of the cells that it asks for, in its order, and gives every rank those of its own cells. No number goes to another
/// rank than these.
#[test]
fn cells_are_gathered_and_scattered() {
    let mesh = curved_box::<2>(4, 2);
    let blocks = Blocks { of_cell: mesh::blocks(&mesh, BLOCKS).unwrap(), groups: 1 };
    let number = |cell: usize, i: usize| (10 * cell + i) as f64;
    let wanted = [7, 0, 15, 3, 8];
    Threads::run(3, |communicator| {
        let counting = Arc::new(Counting::new(communicator));
        let sums = Arc::new(Sums::new(counting.clone() as Arc<dyn Communicator>, BLOCKS));
        let share = Share::new(&mesh, &blocks, sums);
        let is_first = counting.rank() == 0;
        let whole: Vec<f64> = (0..16).flat_map(|cell| [number(cell, 0), number(cell, 1)]).collect();
        // Parts of three cells; only rank 0 is asked for them.
        let parts = || (0..16).step_by(3).map(|start| start..16.min(start + 3));
        let own = share.scatter(2, parts(), |cells| {
            assert!(is_first && cells.len() <= 3);
            whole[2 * cells.start..2 * cells.end].to_vec()
        });
        assert_eq!(own, share.own.iter().flat_map(|&cell| [number(cell, 0), number(cell, 1)]).collect::<Vec<f64>>());
        let all = share.join(&own);
        assert_eq!(all, if is_first { whole } else { Vec::new() });
        counting.reset();
        let expected: Vec<f64> = wanted.iter().flat_map(|&cell| [number(cell, 0), number(cell, 1)]).collect();
        assert_eq!(share.gather(&own, &wanted), if is_first { expected } else { Vec::new() });
        let sent = if is_first { 0 } else { 16 * share.own.iter().filter(|cell| wanted.contains(cell)).count() };
        assert_eq!(counting.reset().bytes, sent as u64);
        assert!(share.gather(&own, &[]).is_empty() && share.scatter(0, parts(), |_| Vec::new()).is_empty());
    });
}

#[test]
fn shares_make_the_whole() {
    assert_shares_make_the_whole::<2, 4>(5);
    assert_shares_make_the_whole::<3, 5>(3);
}
