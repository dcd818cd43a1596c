//! One coordinate of a rigid body.

use super::Vec3;
use crate::clock::is_before;
use std::sync::Arc;
use tensor::Transcendental;

/// How a coordinate moves a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Freedom {
    /// Along e_k.
    Translation(Vec3),
    /// As a rotation: q_k is the part of the rotation vector along the unit vector a_k.
    Rotation(Vec3),
}

impl Freedom {
    /// Whether it turns the body.
    pub fn rotates(&self) -> bool {
        matches!(self, Freedom::Rotation(_))
    }
}

/// Springs that act on a coordinate outside of a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stops {
    /// No force above this.
    pub lower: f64,
    /// No force below this.
    pub upper: f64,
    /// Force per distance beyond.
    pub stiffness: f64,
}

/// The drive of a coordinate.
#[derive(Clone)]
pub struct Drive {
    /// The coordinate as a function of time.
    pub position: Arc<dyn Fn(f64) -> f64 + Send + Sync>,
    /// Its rate.
    pub rate: Arc<dyn Fn(f64) -> f64 + Send + Sync>,
    /// The time when the drive ends and the coordinate becomes free, if it does.
    pub release: Option<f64>,
}

/// A translation or a rotation, free on springs or driven.
#[derive(Clone)]
pub struct Coordinate {
    /// How it moves the body.
    pub freedom: Freedom,
    /// Force or moment per displacement or angle.
    pub stiffness: f64,
    /// The same per cube of it.
    pub cubic_stiffness: f64,
    /// Force or moment per rate.
    pub damping: f64,
    /// Springs outside of a range.
    pub stops: Option<Stops>,
    /// The value where the springs are at rest.
    pub rest: f64,
    /// The rate at the start.
    pub rate_at_start: f64,
    /// Its drive, if it has one.
    pub drive: Option<Drive>,
}

impl Coordinate {
    /// f(q), the force of the springs.
    pub fn spring_force<T: Transcendental>(&self, q: T) -> T {
        let x = q - self.rest;
        x * self.stiffness + x * x * x * self.cubic_stiffness + self.beyond(q) * self.stop_stiffness()
    }

    /// The energy in the springs.
    pub fn spring_energy(&self, q: f64) -> f64 {
        let (x, beyond) = (q - self.rest, self.beyond(q));
        0.5 * self.stiffness * x * x
            + 0.25 * self.cubic_stiffness * x.powi(4)
            + 0.5 * self.stop_stiffness() * beyond * beyond
    }

    /// Whether it is driven in the slab that begins at `start`. Most slabs have the length `step`.
    pub fn is_driven(&self, start: f64, step: f64) -> bool {
        // A drive ends at the beginning of a slab, up to rounding.
        self.drive.as_ref().is_some_and(|drive| drive.release.is_none_or(|release| is_before(start, release, step)))
    }

    /// Whether q is beyond a stop.
    pub fn meets_stop(&self, q: f64) -> bool {
        self.beyond(q) != 0.0
    }

    fn stop_stiffness(&self) -> f64 {
        self.stops.map_or(0.0, |stops| stops.stiffness)
    }

    /// How far q lies outside of the range of the stops.
    fn beyond<T: Transcendental>(&self, q: T) -> T {
        let zero = q.zero();
        self.stops.map_or(zero, |stops| zero.max(q - stops.upper) + zero.min(q - stops.lower))
    }
}
