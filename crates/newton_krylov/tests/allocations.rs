//! A solver keeps its memory: from the second solve on it does not allocate.
#![allow(clippy::unwrap_used)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use newton_krylov::inner_product::{Euclidean, axpy, copy};
use newton_krylov::operator::{Identity, LinearOperator, Preconditioned};
use newton_krylov::{cg, fgmres};

/// Counts the calls, on all threads.
struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

// SAFETY: both functions pass their arguments on to the system's allocator, whose contract is the same.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// y_i = (2 + i / n) x_i: symmetric, positive definite, all eigenvalues different.
struct Spread;

impl LinearOperator for Spread {
    fn apply(&mut self, x: &[f64], y: &mut [f64]) {
        let n = x.len() as f64;
        copy(x, y);
        axpy(1.0, x, y);
        for (i, (y_i, x_i)) in y.iter_mut().zip(x).enumerate() {
            *y_i += i as f64 / n * x_i;
        }
    }
}

/// The number of allocations of the second of two equal pieces of work.
fn allocations_of_second(mut work: impl FnMut()) -> usize {
    work();
    let before = ALLOCATIONS.load(Ordering::Relaxed);
    work();
    ALLOCATIONS.load(Ordering::Relaxed) - before
}

// One test, so that no other thread allocates meanwhile; within the pool, as entering it may allocate.
#[test]
fn the_second_solve_does_not_allocate() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    let n = 20_000;
    let (b, mut x) = (vec![1.0; n], vec![0.0; n]);
    let (mut krylov, mut conjugate) = (fgmres::Workspace::default(), cg::Workspace::default());
    let counts = pool.install(|| {
        let mut system =
            Preconditioned { operator: &mut Spread, preconditioner: &mut Identity, inner_product: &Euclidean };
        let with_fgmres = allocations_of_second(|| {
            x.fill(0.0);
            let report = fgmres::solve(&mut system, &b, &mut x, &fgmres::Settings::default(), &mut krylov).unwrap();
            assert!(report.iterations > 3);
        });
        let with_cg = allocations_of_second(|| {
            x.fill(0.0);
            let report = cg::solve(&mut system, &b, &mut x, &cg::Settings::default(), &mut conjugate).unwrap();
            assert!(report.iterations > 3);
        });
        (with_fgmres, with_cg)
    });
    assert_eq!(counts, (0, 0));
}
