//! Distributions along walls: series in the result file, and files `surface_NAME.csv` and `surface_NAME.vtkhdf` for each wall that the case
//! names.
//!
//! | module | holds |
//! |---|---|
//! | `distribution` | pressure, friction and heat at the points of a wall |
//! | `curve` | the facets of a wall in the plane, one after the other |
//! | `section` | the points of a wall in the plane, or of the cross-section of an extruded one |
//! | `columns` | the numbers of a point, and their names |
//! | `files` | the files of a wall |
//! | `added` | walls whose distributions begin later than the run |
//! | `mean` | means over time and span, and where the flow separates |

mod added;
mod columns;
mod curve;
mod distribution;
mod files;
mod mean;
mod section;

pub use added::{added, begun_anew, interrupted, late_means, listed};
pub use case::surface_name;
pub use columns::{Column, columns};
pub use distribution::{FlowAt, SurfaceFlow, physical};
pub use files::write;
pub use mean::{MeansOf, write_means};
pub use section::Section;
