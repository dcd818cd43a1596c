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
pub use sum_factorisation::contract;
pub use temporal_modes::{TemporalModes, is_real};
pub use tensor_product::{apply_all_axes, apply_axis, scratch_length};
pub use time::RadauTime;

#[cfg(test)]
mod testing;
