//! Evaluations after the first allocate nothing.
#![allow(clippy::unwrap_used)]

use basis::RadauTime;
use elasticity::{ElasticMesh, ElasticSlab, Material, SlabMotion, Stiffness};
use mesh::{BoxMesh, Curving, NodeNumbering};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// The system's allocator, with a counter of its calls.
struct Counting;

thread_local! {
    /// Of this thread: the harness of tests has threads of its own, which allocate when they like.
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

// Safety: every call is handed on to the system's allocator as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Allocations of the second to the eleventh call.
fn allocations(mut call: impl FnMut()) -> usize {
    call();
    let before = ALLOCATIONS.get();
    (0..10).for_each(|_| call());
    ALLOCATIONS.get() - before
}

#[test]
fn operator_and_slab_residual_allocate_nothing() {
    let curving = Curving::Wavy { amplitude: 0.03 };
    let mesh = BoxMesh { lower: [0.0; 2], upper: [1.0; 2], cells: [8, 8], order: 4, curving, periodic: [false; 2] }
        .build()
        .unwrap();
    let numbering = NodeNumbering::new(&mesh, 4);
    let mut constrained = vec![[false; 2]; numbering.count];
    numbering.on_boundary(&mesh, 0).into_iter().for_each(|node| constrained[node] = [true; 2]);
    let stiffness = Stiffness::InverseJacobian { power: 1.0 };
    let elastic =
        ElasticMesh::new(&mesh, &numbering, Material::new(1.0, 0.4).unwrap(), stiffness, &constrained).unwrap();
    let motion = SlabMotion::new(RadauTime::new(2));
    let slab = ElasticSlab { mesh: &elastic, motion: &motion, dt: 0.1 };
    let (bottom, field) = (vec![0.1; elastic.length()], vec![0.2; 2 * elastic.length()]);
    let (mut one, mut two) = (bottom.clone(), field.clone());
    // Within a pool of one thread: a pool of several threads allocates now and then in its own queues.
    rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(|| {
        assert_eq!(allocations(|| elastic.apply(&bottom, &mut one)), 0, "operator");
        assert_eq!(allocations(|| elastic.precondition(&bottom, &mut one)), 0, "preconditioner");
        assert_eq!(allocations(|| slab.residual(&bottom, &field, &field, &mut two).unwrap()), 0, "residual");
        assert_eq!(allocations(|| slab.jacobian_product(&bottom, &field, &field, &mut two)), 0, "Jacobian product");
    });
}
