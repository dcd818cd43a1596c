//! One-dimensional nodes, quadrature and polynomials, and their tensor products by sum factorisation.
//!
//! Space uses the reference line [-1, 1], time the slab [0, 1]. A space of **order** N has N functions of degree N - 1.
//! A basis provides small dense matrices ([`Matrix`]) of values or derivatives at points. The kernels use only those
//! matrices, and [`contract`] applies them, axis by axis, to batches of cells.
//!
//! | module | mathematics |
//! |---|---|
//! | `jacobi` | Jacobi polynomials and their roots |
//! | `quadrature` | Gauss, Gauss-Lobatto and right-Radau rules |
//! | `lagrange` | nodal basis |
//! | `modified` | hierarchical C0 basis |
//! | `time` | basis of a slab: Lagrange polynomials at right-Radau nodes |
//! | `temporal_modes` | eigenvectors of its time matrix |
//! | `sum_factorisation` | one matrix along one axis of a tensor, in SIMD lanes |
//! | `tensor_product` | one matrix along each axis |
//! | `matrix` | small dense matrices |
//!
//! Four Gauss-Lobatto nodes interpolate and differentiate a cubic polynomial exactly, and integrate degree 5:
//!
//! ```
//! use basis::{Lagrange, gauss_lobatto};
//!
//! let (cubic, slope) = (|x: f64| x.powi(3) - 2.0 * x, |x: f64| 3.0 * x * x - 2.0);
//! let basis = Lagrange::gauss_lobatto(4);
//! let values: Vec<f64> = basis.nodes().iter().map(|x| cubic(*x)).collect();
//! let at = |functions: Vec<f64>| functions.iter().zip(&values).map(|(l, value)| l * value).sum::<f64>();
//! assert!((at(basis.values(0.3)) - cubic(0.3)).abs() < 1e-14);
//! assert!((at(basis.derivatives(0.3)) - slope(0.3)).abs() < 1e-13);
//!
//! let rule = gauss_lobatto(4);
//! let moment = |degree| rule.points.iter().zip(&rule.weights).map(|(x, w)| w * x.powi(degree)).sum::<f64>();
//! assert!((moment(4) - 2.0 / 5.0).abs() < 1e-15);
//! assert!((moment(6) - 2.0 / 7.0).abs() > 1e-2, "degree 6 is too high");
//! ```

mod jacobi;
mod lagrange;
mod matrix;
mod modified;
mod quadrature;
mod sum_factorisation;
mod temporal_modes;
mod tensor_product;
mod time;

pub use lagrange::{Lagrange, equidistant_points};
pub use matrix::Matrix;
pub use modified::{ModifiedBasis, reversal_sign};
pub use quadrature::{Rule, gauss, gauss_lobatto, right_radau};
pub use sum_factorisation::{AlongAxis, contract};
pub use temporal_modes::{TemporalModes, is_real};
pub use tensor_product::{AllAxes, apply_all_axes, scratch_length};
pub use time::RadauTime;

#[cfg(test)]
mod testing;
