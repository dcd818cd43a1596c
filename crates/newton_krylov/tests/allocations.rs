//! Solvers keep their memory. From the second solve on a linear solver does not allocate, and Newton's method allocates only
//! its report.
#![allow(clippy::unwrap_used)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use newton_krylov::inner_product::{Euclidean, InnerProduct, axpy, copy};
use newton_krylov::operator::{Identity, LinearOperator, Preconditioned};
use newton_krylov::problem::{Field, Inadmissible, NonlinearProblem};
use newton_krylov::{cg, fgmres, newton};

/// Counts the calls and their bytes, on all threads.
struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);
static BYTES: AtomicUsize = AtomicUsize::new(0);

// SAFETY: both functions pass their arguments to the system's allocator, which has the same contract.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        BYTES.fetch_add(layout.size(), Ordering::Relaxed);
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

/// z_i^3 + z_i - 1 = 0 for each i.
struct Cubic {
    fields: [Field; 1],
    z: Vec<f64>,
}

impl NonlinearProblem for Cubic {
    fn len(&self) -> usize {
        self.z.len()
    }

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn inner_product(&self) -> &dyn InnerProduct {
        &Euclidean
    }

    fn residual(&mut self, z: &[f64], r: &mut [f64]) -> Result<(), Inadmissible> {
        z.iter().zip(r).for_each(|(z_i, r_i)| *r_i = z_i.powi(3) + z_i - 1.0);
        Ok(())
    }

    fn linearise(&mut self, z: &[f64], _: &[f64]) -> Result<(), Inadmissible> {
        self.z.copy_from_slice(z);
        Ok(())
    }

    fn jacobian_product(&mut self, direction: &[f64], out: &mut [f64]) {
        self.z.iter().zip(direction).zip(out).for_each(|((z, d), o)| *o = (3.0 * z * z + 1.0) * d);
    }

    fn add_pseudo_time(&mut self, _: &[f64], _: &mut [f64]) {}

    fn precondition(&mut self, r: &[f64], out: &mut [f64]) {
        copy(r, out);
    }

    fn largest_step(&mut self, _: &[f64], _: &[f64]) -> f64 {
        1.0
    }
}

/// The number of allocations, and of their bytes, of a piece of work that has been done before. It is the least of several trials,
/// since a thread that goes to sleep or wakes up may allocate for itself.
fn allocations_of_second(mut work: impl FnMut()) -> (usize, usize) {
    let now = || (ALLOCATIONS.load(Ordering::Relaxed), BYTES.load(Ordering::Relaxed));
    work();
    let again = |_| {
        let (calls, bytes) = now();
        work();
        (now().0 - calls, now().1 - bytes)
    };
    (0..5).map(again).min().unwrap_or_default()
}

const LENGTH: usize = 20_000;

fn linear_solvers() {
    let (b, mut x) = (vec![1.0; LENGTH], vec![0.0; LENGTH]);
    let mut system = Preconditioned { operator: &mut Spread, preconditioner: &mut Identity, inner_product: &Euclidean };
    let mut workspace = fgmres::Workspace::default();
    let count = allocations_of_second(|| {
        x.fill(0.0);
        let report = fgmres::solve(&mut system, &b, &mut x, &fgmres::Settings::default(), &mut workspace).unwrap();
        assert!(report.iterations > 3);
    });
    assert_eq!(count, (0, 0), "FGMRES");
    let mut workspace = cg::Workspace::default();
    let count = allocations_of_second(|| {
        x.fill(0.0);
        let report = cg::solve(&mut system, &b, &mut x, &cg::Settings::default(), &mut workspace).unwrap();
        assert!(report.iterations > 3);
    });
    assert_eq!(count, (0, 0), "CG");
}

fn newton_solver() {
    let mut problem = Cubic { fields: [Field { name: "z", range: 0..LENGTH }], z: vec![0.0; LENGTH] };
    let mut z: Vec<f64> = vec![0.0; LENGTH];
    let mut workspace = newton::Workspace::default();
    let (_, bytes) = allocations_of_second(|| {
        (0..LENGTH).for_each(|i| z[i] = i as f64 / LENGTH as f64);
        let report = newton::solve(&mut problem, &mut z, None, &newton::Settings::default(), &mut workspace).unwrap();
        assert!(report.steps.len() > 2);
    });
    assert!(bytes < LENGTH, "Newton allocated {bytes} bytes, a vector has eight times {LENGTH}");
}

// One test, so that no other thread allocates meanwhile; within the pool, because entering it may allocate.
#[test]
fn the_second_solve_does_not_allocate() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    pool.install(|| {
        linear_solvers();
        newton_solver();
    });
}
