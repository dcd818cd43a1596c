//! The coordinates of a rigid body.

use super::{Direction, Freedom, Given, size_of};
use crate::checked::Time;
use crate::checked::displacement::check_rate;
use crate::checked::inertia::{self, COMPONENTS};
use crate::checked::unit_axis;
use crate::checker::Checked;
use crate::expression::Program;
use crate::key::Key;
use crate::magnitude::is_round_off;
use crate::raw;
use coupled::blocks::rigid_body::Stops;
use coupled::rounded_time;
use tensor::Dual;

impl<const D: usize> Given<'_, D> {
    pub(super) fn freedoms(&self, key: &Key, raw: &raw::Body) -> Checked<Vec<Freedom>> {
        let axis = self.axis(key, raw)?;
        let along = |i: usize| std::array::from_fn(|j| f64::from(u8::from(i == j)));
        let translations = [0, 1, 2].map(|i| Direction::Translation(along(i)));
        let rotations = [axis, along(0), along(1), along(2)].map(Direction::Rotation);
        let mut freedoms = Vec::new();
        for ((name, freedom), direction) in raw.coordinates().into_iter().zip(translations.into_iter().chain(rotations))
        {
            let Some(freedom) = freedom else { continue };
            let key = key.child(name);
            if D == 2 && !["x", "y", "rotation"].contains(&name) {
                return Err(self.checker.dimension(&key, "the mesh is two-dimensional", "`x`, `y`, `rotation`"));
            }
            freedoms.push(self.freedom(&key, (name, direction), freedom)?);
        }
        if freedoms.is_empty() {
            let accepted = "a section for each coordinate that it has: `x`, `y`, `z`, `rotation`, or in three dimensions \
                            `rotation_x`, `rotation_y`, `rotation_z`; empty where it is free";
            return Err(self.checker.combination(key, "a body that cannot move", accepted));
        }
        inertia::check_turns(self.checker, key, raw)?;
        Ok(freedoms)
    }

    /// The axis of `rotation`, which excludes rotations about the axes of space.
    fn axis(&self, key: &Key, raw: &raw::Body) -> Checked<[f64; 3]> {
        if let Some(name) = inertia::component(raw) {
            let accepted = format!("`rotation` about `axis`, or some of {COMPONENTS}");
            if raw.rotation.is_some() {
                let problem = format!("`rotation` and `{name}` both turn the body");
                return Err(self.checker.combination(&key.child("rotation"), &problem, &accepted));
            }
            if raw.axis.is_some() {
                let problem = format!("`{name}` is about an axis of space, not about this one");
                return Err(self.checker.combination(&key.child("axis"), &problem, &accepted));
            }
        }
        let axis = raw.axis.map(|axis| unit_axis::<D>(self.checker, &key.child("axis"), axis, "a rotation"));
        axis.unwrap_or(Ok([0.0, 0.0, 1.0]))
    }

    fn freedom(&self, key: &Key, (name, direction): (&'static str, Direction), raw: &raw::Freedom) -> Checked<Freedom> {
        let checker = self.checker;
        let number = |name: &str, formula: &raw::Formula| -> Checked<f64> {
            let (key, quantity) = (key.child(name), format!("the {}", name.replace('_', " ")));
            let value = checker.number(&key, formula)?;
            checker.require(&key, &quantity, value.is_finite(), "a finite number")?;
            Ok(value)
        };
        self.check_stops(key, raw)?;
        let motion = raw
            .motion
            .as_ref()
            .map(|motion| self.drive(&key.child("motion"), &direction, motion, raw.release))
            .transpose()?;
        let rate = number("rate", &raw.rate)?;
        self.check_drive(key, raw, rate)?;
        let (spring, cubic_spring) = (number("spring", &raw.spring)?, number("cubic_spring", &raw.cubic_spring)?);
        let rest = number("rest", &raw.rest)?;
        if rest != 0.0 && spring == 0.0 && cubic_spring == 0.0 {
            let problem = "`rest` has no effect: the coordinate has no spring";
            return Err(checker.combination(
                &key.child("rest"),
                problem,
                "this key together with `spring` or `cubic_spring`",
            ));
        }
        let stops = raw.stops.map(|raw::Stops { lower, upper, stiffness }| Stops { lower, upper, stiffness });
        Ok(Freedom {
            name,
            direction,
            spring,
            cubic_spring,
            rest,
            damping: number("damping", &raw.damping)?,
            rate,
            stops,
            motion,
            release: raw.release,
        })
    }

    fn check_stops(&self, key: &Key, raw: &raw::Freedom) -> Checked<()> {
        let Some(raw::Stops { lower, upper, stiffness }) = raw.stops else { return Ok(()) };
        let (checker, key) = (self.checker, key.child("stops"));
        let is_above = upper > lower && lower.is_finite();
        checker.require(&key.child("upper"), "the upper stop", is_above, "a number above `lower`")?;
        checker.positive(&key.child("stiffness"), "the stiffness of the stops", stiffness).map(drop)
    }

    /// Checks what belongs to a prescribed motion: its release, and the `rate` at the start.
    fn check_drive(&self, key: &Key, raw: &raw::Freedom, rate: f64) -> Checked<()> {
        let (checker, is_driven) = (self.checker, raw.motion.is_some());
        if raw.release.is_some() && !is_driven {
            let problem = "a coordinate that nothing drives is free already";
            return Err(checker.combination(&key.child("release"), problem, "this key together with `motion`"));
        }
        if is_driven && rate != 0.0 {
            let problem = "`rate` has no effect: the motion of the coordinate tells its rate at the start";
            return Err(checker.combination(&key.child("rate"), problem, "one of the two: remove the other"));
        }
        raw.release.map_or(Ok(()), |release| self.check_release(&key.child("release"), release))
    }

    /// A slab begins where a drive ends. Adapted slabs are cut there.
    fn check_release(&self, key: &Key, release: f64) -> Checked<()> {
        let Time { start, step, control, .. } = *self.time;
        let slabs = (release - start) / step;
        if release <= start {
            let problem = format!("a release at t = {release} comes before the run, so that `motion` has no effect");
            return Err(self.checker.combination(
                key,
                &problem,
                &format!("a time after {start}, or neither of the two keys"),
            ));
        }
        let meets = control.is_some() || !slabs.is_finite() || (slabs - slabs.round()).abs() <= 1e-6;
        let step = rounded_time(step);
        let accepted = format!("a time at which a slab begins: one of every {step} from {start} on");
        self.checker.require(key, &format!("the release at t = {release}"), meets, &accepted)
    }

    /// A coordinate prescribed along `direction` starts at zero, and has a value and a rate until its `release`, if there is one.
    fn drive(&self, key: &Key, direction: &Direction, raw: &raw::Formula, release: Option<f64>) -> Checked<Program> {
        let motion = self.checker.formula_of_time(key, raw)?;
        let start = motion.evaluate::<f64>(&[], self.time.start);
        let at_rest = is_round_off(start, size_of(direction, self.mesh));
        self.checker.require_of_formula(
            key,
            &format!("the motion at the start, {start},"),
            at_rest,
            "a formula that is zero at the start",
        )?;
        for t in self.time.check_times().into_iter().filter(|t| release.is_none_or(|release| *t <= release)) {
            let Dual { value, derivative } = motion.evaluate(&[], Dual::new(t, 1.0));
            let quantity = format!("the motion at t = {t}, {value},");
            self.checker.require_of_formula(
                key,
                &quantity,
                value.is_finite(),
                "a formula that is finite over the whole run",
            )?;
            check_rate(self.checker, key, format_args!("the motion"), t, derivative)?;
        }
        Ok(motion)
    }
}
