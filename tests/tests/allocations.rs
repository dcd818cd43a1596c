//! Evaluations of the residual after the first allocate nothing.
#![allow(clippy::unwrap_used)]

use fem::Orders;
use navier_stokes::{Riemann, Viscosity};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use verification::{curved_box, free_stream, law, operator, prescribed};

struct Counting;

thread_local! {
    /// Of this thread: the harness of tests has threads of its own, which allocate when they like.
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: as required of our caller.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as required of our caller.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The only test of this program, because others would allocate at the same time.
#[test]
fn residual_and_products_allocate_nothing_after_the_first() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let counts = pool.install(|| {
        let law = law::<2>(Viscosity::Constant(0.01), Riemann::Roe);
        let orders = Orders { flow: 4, mesh: 4, time: 2 };
        let data = free_stream::<2, 4>(&law);
        let state = data.value(&[0.0; 2], 0.0);
        let mut operator = operator(&curved_box::<2>(4, 4), law, orders, prescribed(), data);
        let layout = operator.layout;
        let u: Vec<f64> = (0..layout.len()).map(|i| state[i / layout.nodes % 4]).collect();
        let still = vec![0.0; operator.mesh.field_len()];
        let velocities = vec![0.01; 2 * still.len()];
        operator.begin_slab(0.0, 0.1, fem::Bottom::new(&u[..layout.at_one_time().len()], &still));
        operator.set_mesh(&velocities);
        let mut out = vec![0.0; u.len()];
        let mut counts = Vec::new();
        for _ in 0..2 {
            let before = ALLOCATIONS.get();
            operator.residual(&u, &mut out).unwrap();
            let residual = ALLOCATIONS.get();
            operator.product(&u, &mut out);
            operator.product_with_mesh(&u, &velocities, &mut out);
            counts.push([residual - before, ALLOCATIONS.get() - residual]);
        }
        counts
    });
    assert_eq!(counts[1], [0, 0], "allocations of the second residual and of the second products");
}
