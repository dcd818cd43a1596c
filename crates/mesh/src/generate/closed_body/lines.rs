//! The two families of lines of the mesh around a closed body.

use super::outline::Outline;
use std::array::from_fn;
use std::f64::consts::{PI, TAU};

/// Candidates of L of (body), as fractions of the largest distance of the wall from its centroid.
const CANDIDATES: [f64; 10] = [2.0, 1.4, 1.0, 0.7, 0.5, 0.35, 0.25, 0.18, 0.12, 0.08];

/// Lines around and outwards at which their quality is measured.
const SAMPLES: [usize; 2] = [256, 48];

/// (body)
pub(super) struct BodyLines<'a> {
    outline: &'a Outline<'a>,
    /// D.
    width: f64,
    /// The angle of e(0).
    start: f64,
    /// L.
    blending: f64,
}

/// A point of the wall with its terms of (body).
struct Foot {
    position: [f64; 2],
    normal: [f64; 2],
    /// e.
    direction: [f64; 2],
}

impl<'a> BodyLines<'a> {
    pub(super) fn new(outline: &'a Outline<'a>, outer_radius: f64) -> Self {
        let parameters = outline.divided(SAMPLES[0]);
        let start = mean_angle(outline, &parameters);
        let with = |share: f64| BodyLines {
            outline,
            width: outer_radius - outline.reach,
            start,
            blending: share * outline.reach,
        };
        let rated = CANDIDATES.map(|share| (with(share).worst_quality(&parameters), share));
        let best = rated.into_iter().fold(rated[0], |best, other| if other.0 > best.0 { other } else { best });
        with(best.1)
    }

    /// The point at the distance d from the wall, at the parameter u of the curve and the fraction s of its length.
    pub(super) fn position(&self, u: f64, s: f64, d: f64) -> [f64; 2] {
        let Foot { position, normal, direction } = self.foot(u, s);
        let (w, Outline { centre, reach, .. }) = (self.weight(d)[0], self.outline);
        from_fn(|i| (1.0 - w) * (position[i] + d * normal[i]) + w * (centre[i] + (reach + d) * direction[i]))
    }

    fn foot(&self, u: f64, s: f64) -> Foot {
        let (sine, cosine) = (self.start - TAU * s).sin_cos();
        let curve = self.outline.curve;
        Foot { position: curve.position(u), normal: curve.normal(u), direction: [cosine, sine] }
    }

    /// w and dw/dd.
    fn weight(&self, d: f64) -> [f64; 2] {
        let square = self.blending * self.blending;
        let v = |d: f64| d * d / (square + d * d);
        let slope = 2.0 * d * square / (square + d * d).powi(2);
        let whole = v(self.width);
        // At the far field 1 to the last bit: the width there is subject to rounding.
        [(v(d) / whole).min(1.0), slope / whole]
    }

    /// The lowest quality at samples of all distances.
    fn worst_quality(&self, parameters: &[f64]) -> f64 {
        let [around, outwards] = SAMPLES;
        let distance = |k: usize| self.width * 1e-4_f64.powf(1.0 - k as f64 / outwards as f64);
        let qualities = (0..around).flat_map(|i| {
            let (u, s) = (parameters[i], i as f64 / around as f64);
            (1..=outwards).map(move |k| self.quality(u, s, distance(k)))
        });
        qualities.fold(1.0, f64::min)
    }

    /// The sine of the angle from dx/ds to dx/dd, times the smaller one of |dx/dd|^(1/2) and |dx/dd|^(-1/2). It is 1 where lines are at
    /// right angles and d is the distance along them.
    fn quality(&self, u: f64, s: f64, d: f64) -> f64 {
        let ([a, b], [w, slope]) = (self.derivatives(u, s, d), self.weight(d));
        let (foot, Outline { centre, reach, .. }) = (self.foot(u, s), self.outline);
        let apart = |i: usize| centre[i] + (reach + d) * foot.direction[i] - foot.position[i] - d * foot.normal[i];
        let along: [f64; 2] = from_fn(|i| (1.0 - w) * a[i] + w * b[i]);
        let outwards: [f64; 2] = from_fn(|i| (1.0 - w) * foot.normal[i] + w * foot.direction[i] + slope * apart(i));
        let stretch = outwards[0].hypot(outwards[1]);
        cross(along, outwards) / (along[0].hypot(along[1]) * stretch) * stretch.min(1.0 / stretch).sqrt()
    }

    /// The derivatives of c + d n and of (r + d) e with respect to s. With theta the angle of the tangent, n' = -theta' c' / |c'|.
    fn derivatives(&self, u: f64, s: f64, d: f64) -> [[f64; 2]; 2] {
        let (curve, Outline { reach, .. }) = (self.outline.curve, self.outline);
        let (t, b) = (curve.tangent(u), curve.bend(u));
        let speed = t[0].hypot(t[1]);
        let stretch = self.outline.length() / speed * (1.0 - d * cross(t, b) / speed.powi(3));
        let [cosine, sine] = self.foot(u, s).direction;
        [t.map(|t| t * stretch), [sine, -cosine].map(|x| TAU * (reach + d) * x)]
    }
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The mean over the arc length of the angle of the normal plus TAU s.
fn mean_angle(outline: &Outline<'_>, parameters: &[f64]) -> f64 {
    let cells = parameters.len() - 1;
    let mut sum = 0.0;
    let mut before: Option<f64> = None;
    for (k, &u) in parameters[..cells].iter().enumerate() {
        let [x, y] = outline.curve.normal(u);
        let angle = y.atan2(x) + TAU * k as f64 / cells as f64;
        // Continuous along the curve.
        let angle = before.map_or(angle, |before| before + (angle - before + PI).rem_euclid(TAU) - PI);
        before = Some(angle);
        sum += angle;
    }
    sum / cells as f64
}
