//! A function of one variable given by a table: the cubic spline through its points.
//!
//! Between t_k and t_k+1 = t_k + h_k, with the slopes m of the spline at the points, Delta_k = (y_k+1 - y_k) / h_k and
//! s = (t - t_k) / h_k,
//!
//! ```text
//! y(t) = y_k + h_k s (m_k + s (3 Delta_k - 2 m_k - m_k+1 + s (m_k + m_k+1 - 2 Delta_k)))                   (spline)
//! ```
//!
//! The second derivative is continuous, y''(t_k-) = y''(t_k+), where
//!
//! ```text
//! h_k m_k-1 + 2 (h_k-1 + h_k) m_k + h_k-1 m_k+1 = 3 (h_k Delta_k-1 + h_k-1 Delta_k)                         (smooth)
//! ```
//!
//! Source: C. de Boor, A Practical Guide to Splines, chapter IV.

use tensor::Transcendental;

/// The parts of the time between two points at whose ends an overshoot is looked for.
const PARTS: usize = 16;

/// The ends of the table, and the values beyond them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// The first two cubics are identical, and so are the last two ("not a knot"). There is no value beyond the ends.
    Free,
    /// The slope is zero at the ends, and beyond them the value is constant.
    AtRest,
    /// The table is repeated periodically.
    Periodic,
}

/// A table and its cubic spline: two derivatives are continuous, and the error decreases with the fourth power of the distance
/// of the points.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// t_k, increasing.
    t: Vec<f64>,
    /// y_k.
    y: Vec<f64>,
    /// m_k.
    slopes: Vec<f64>,
    ends: Ends,
}

/// The place where a spline is farthest beyond the two points beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overshoot {
    /// The time.
    pub t: f64,
    /// The value there.
    pub value: f64,
    /// The values of the two points.
    pub between: [f64; 2],
}

/// Errors of a table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TableError {
    /// Different numbers of values and times.
    #[error("{times} times, but {values} values")]
    Lengths {
        /// The number of times.
        times: usize,
        /// The number of values.
        values: usize,
    },
    /// Too few points for the conditions at the ends.
    #[error("{found} points, where a spline with these ends needs {needed}")]
    TooFew {
        /// The number of points.
        found: usize,
        /// The required number.
        needed: usize,
    },
    /// A number that is not finite.
    #[error("point {0} is not finite")]
    NotFinite(usize),
    /// Times that do not increase.
    #[error("times must increase, but {later} follows {earlier}")]
    NotIncreasing {
        /// A time.
        earlier: f64,
        /// The next one.
        later: f64,
    },
    /// A periodic table whose last value differs from the first.
    #[error("the first value is {first} and the last one {last}: a periodic table ends as it begins")]
    NotPeriodic {
        /// The first value.
        first: f64,
        /// The last one.
        last: f64,
    },
}

impl Table {
    /// The spline through the points (t_k, y_k).
    ///
    /// # Errors
    /// Points that do not define such a function: see [`TableError`].
    pub fn new(t: Vec<f64>, y: Vec<f64>, ends: Ends) -> Result<Self, TableError> {
        check(&t, &y, ends)?;
        let slopes = match ends {
            Ends::Periodic => periodic_slopes(&t, &y),
            _ => slopes(&t, &y, ends),
        };
        Ok(Table { t, y, slopes, ends })
    }

    /// t_k and y_k.
    pub fn points(&self) -> (&[f64], &[f64]) {
        (&self.t, &self.y)
    }

    /// The first and the last time.
    pub fn range(&self) -> (f64, f64) {
        (self.t[0], self.t[self.t.len() - 1])
    }

    /// The largest overshoot beyond two neighbouring points, if it is larger than the range of all values times `part`.
    pub fn overshoot(&self, part: f64) -> Option<Overshoot> {
        let fold = |pick: fn(f64, f64) -> f64| self.y.iter().copied().reduce(pick).unwrap_or(0.0);
        let range = fold(f64::max) - fold(f64::min);
        let beyond = |at: &Overshoot| {
            let [low, high] = [at.between[0].min(at.between[1]), at.between[0].max(at.between[1])];
            (low - at.value).max(at.value - high)
        };
        let parts = (1..PARTS).map(|part| part as f64 / PARTS as f64);
        let places = self.t.windows(2).zip(self.y.windows(2)).flat_map(|(t, y)| {
            let at = move |s: f64| (t[0] + s * (t[1] - t[0]), [y[0], y[1]]);
            parts.clone().map(at)
        });
        let worst = places
            .map(|(t, between)| Overshoot { t, value: self.evaluate(t), between })
            .max_by(|a, b| beyond(a).total_cmp(&beyond(b)))?;
        (beyond(&worst) > part * range).then_some(worst)
    }

    /// y(t), by (spline). NaN beyond free ends.
    pub fn evaluate<T: Transcendental>(&self, t: T) -> T {
        let (first, last) = self.range();
        let periods = if self.ends == Ends::Periodic { ((t.value() - first) / (last - first)).floor() } else { 0.0 };
        let t = t - T::from(periods * (last - first));
        // A run meets its last time only up to round-off.
        let margin = 1e-9 * (last - first);
        match self.ends {
            Ends::AtRest if t.value() <= first => return T::from(self.y[0]),
            Ends::AtRest if t.value() >= last => return T::from(self.y[self.y.len() - 1]),
            _ if (first - margin..=last + margin).contains(&t.value()) => {}
            _ => return T::from(f64::NAN),
        }
        let k = self.t.partition_point(|knot| *knot <= t.value()).clamp(1, self.t.len() - 1) - 1;
        let (h, m, m1) = (self.t[k + 1] - self.t[k], self.slopes[k], self.slopes[k + 1]);
        let delta = (self.y[k + 1] - self.y[k]) / h;
        let sigma = (t - T::from(self.t[k])) * h.recip();
        let (quadratic, cubic) = (T::from(3.0 * delta - 2.0 * m - m1), T::from(m + m1 - 2.0 * delta));
        T::from(self.y[k]) + sigma * h * (T::from(m) + sigma * (quadratic + sigma * cubic))
    }
}

fn check(t: &[f64], y: &[f64], ends: Ends) -> Result<(), TableError> {
    let (times, values) = (t.len(), y.len());
    let needed = match ends {
        Ends::Free => 4,
        Ends::AtRest => 2,
        Ends::Periodic => 4,
    };
    if times != values {
        return Err(TableError::Lengths { times, values });
    }
    if times < needed {
        return Err(TableError::TooFew { found: times, needed });
    }
    if let Some(point) = (0..times).find(|&k| !(t[k].is_finite() && y[k].is_finite())) {
        return Err(TableError::NotFinite(point + 1));
    }
    if let Some(pair) = t.windows(2).find(|pair| pair[1] <= pair[0]) {
        return Err(TableError::NotIncreasing { earlier: pair[0], later: pair[1] });
    }
    let (first, last) = (y[0], y[values - 1]);
    let size = y.iter().fold(0.0, |size: f64, y| size.max(y.abs()));
    if ends == Ends::Periodic && (last - first).abs() > 1e-9 * size {
        return Err(TableError::NotPeriodic { first, last });
    }
    Ok(())
}

/// A row of a tridiagonal system: below, on and above the diagonal, right-hand side.
type Row = [f64; 4];

/// The slopes if the ends have conditions of their own.
fn slopes(t: &[f64], y: &[f64], ends: Ends) -> Vec<f64> {
    let last = t.len() - 1;
    let intervals = intervals(t, y);
    let [first_end, last_end] = match ends {
        Ends::AtRest => [[0.0, 1.0, 0.0, 0.0]; 2],
        _ => [
            not_a_knot(intervals[0], intervals[1]),
            // The mirror image: entries above the diagonal become entries below it.
            mirrored(not_a_knot(intervals[last - 1], intervals[last - 2])),
        ],
    };
    let inner = (1..last).map(|k| smooth(intervals[k - 1], intervals[k]));
    tridiagonal(&std::iter::once(first_end).chain(inner).chain([last_end]).collect::<Vec<_>>())
}

/// h_k and Delta_k.
fn intervals(t: &[f64], y: &[f64]) -> Vec<[f64; 2]> {
    (0..t.len() - 1).map(|k| [t[k + 1] - t[k], (y[k + 1] - y[k]) / (t[k + 1] - t[k])]).collect()
}

/// (smooth) at the point between two intervals.
fn smooth([h0, delta0]: [f64; 2], [h1, delta1]: [f64; 2]) -> Row {
    [h1, 2.0 * (h0 + h1), h0, 3.0 * (h1 * delta0 + h0 * delta1)]
}

/// The third derivative is continuous at the second point: with (smooth) there, and m_2 eliminated,
/// h_1 m_0 + (h_0 + h_1) m_1 = ((3 h_0 + 2 h_1) h_1 Delta_0 + h_0^2 Delta_1) / (h_0 + h_1).
fn not_a_knot([h0, delta0]: [f64; 2], [h1, delta1]: [f64; 2]) -> Row {
    let sum = h0 + h1;
    [0.0, h1, sum, ((3.0 * h0 + 2.0 * h1) * h1 * delta0 + h0 * h0 * delta1) / sum]
}

fn mirrored([below, diagonal, above, right]: Row) -> Row {
    [above, diagonal, below, right]
}

/// The slopes of a periodic table: (smooth) at every point; the last point is the first one again. The corner entries are c = a_0
/// (below the first row) and b (above the last). They give A = T + u w^T with u = (g, 0, ..., b), w = (1, 0, ..., c / g), g = -d_0.
/// Then A^-1 r = T^-1 r - T^-1 u (w . T^-1 r) / (1 + w . T^-1 u) (Sherman and Morrison).
fn periodic_slopes(t: &[f64], y: &[f64]) -> Vec<f64> {
    let intervals = intervals(t, y);
    let n = intervals.len();
    let mut rows: Vec<Row> = (0..n).map(|k| smooth(intervals[(k + n - 1) % n], intervals[k])).collect();
    let (corner_first, corner_last, g) = (rows[0][0], rows[n - 1][2], -rows[0][1]);
    rows[0][1] -= g;
    rows[n - 1][1] -= corner_last * corner_first / g;
    let particular = tridiagonal(&rows);
    (0..n).for_each(|k| rows[k][3] = if k == 0 { g } else { 0.0 } + if k == n - 1 { corner_last } else { 0.0 });
    let correction = tridiagonal(&rows);
    let along = |z: &[f64]| z[0] + corner_first / g * z[n - 1];
    let factor = along(&particular) / (1.0 + along(&correction));
    (0..=n).map(|k| particular[k % n] - factor * correction[k % n]).collect()
}

/// Elimination without pivoting, which is stable here because the pivots stay positive.
fn tridiagonal(rows: &[Row]) -> Vec<f64> {
    let mut above_and_right: Vec<[f64; 2]> = Vec::with_capacity(rows.len());
    for [below, diagonal, above, right] in rows {
        let [previous_above, previous_right] = above_and_right.last().copied().unwrap_or([0.0; 2]);
        let pivot = diagonal - below * previous_above;
        above_and_right.push([above / pivot, (right - below * previous_right) / pivot]);
    }
    let mut next = 0.0;
    let mut solution: Vec<f64> = above_and_right
        .iter()
        .rev()
        .map(|[above, right]| {
            next = right - above * next;
            next
        })
        .collect();
    solution.reverse();
    solution
}

#[cfg(test)]
mod tests;
