//! `[mesh.generate]`

mod boxes;
mod channels;
mod profiles;
mod round;

pub use boxes::*;
pub use channels::*;
pub use profiles::*;
pub use round::*;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A generated mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum Generate {
    /// A box of quadrilaterals or hexahedra. Its boundaries are left, right (x), bottom, top (y), front, back (z).
    Box(BoxGenerator),
    /// A square around the origin with a centred square hole, in square cells. Its boundaries are inner and outer.
    RotatingBox(RotatingBoxGenerator),
    /// A box between two walls. Its boundaries are bottom and top, and inflow and outflow if it is not periodic.
    Channel(ChannelGenerator),
    /// A channel along x with a cylinder across it. Its boundaries are inflow, outflow, bottom, top and cylinder.
    ChannelCylinder(ChannelCylinderGenerator),
    /// A channel along x with a flag behind a cylinder, as of Turek & Hron. Its boundaries are inflow, outflow, bottom, top and cylinder, its
    /// regions fluid and flag.
    ChannelFlag(ChannelFlagGenerator),
    /// Cells between two circles around the origin. Its boundaries are wall, the inner one, and far.
    Annulus(AnnulusGenerator),
    /// Cells between a closed blunt body and a circle around it. Its boundaries are wall and far.
    ClosedBody(ClosedBodyGenerator),
    /// Cells between an ellipsoid around the origin and the far field, in three dimensions. Its boundaries are wall and far.
    Ellipsoid(EllipsoidGenerator),
    /// The inside of a circle around the origin. Its boundary is wall.
    Disc(DiscGenerator),
    /// A C-mesh around an airfoil from x = 0 to its trailing edge at (1, 0). Its boundaries are airfoil and far.
    Airfoil(AirfoilGenerator),
    /// A passage of a row of turbine blades, periodic in the pitch. Its boundaries are blade, inflow and outflow.
    TurbineBlade(TurbineBladeGenerator),
}

fn one() -> f64 {
    1.0
}

fn fifth() -> f64 {
    0.2
}
