//! Means over time of the distribution along a wall, and where the mean flow separates from it.
//!
//! ```text
//! <q>(s) = sum_k w_k q(t_k) / sum_k w_k,    q = sum_j area_j q_j / sum_j area_j over the rows j at the same point                     (mean)
//! w_k = int h_k dt,    h_k the piecewise linear function that is 1 at t_k and 0 at the other times, over the interval of the averages
//! c_s = c_f . t,    t along increasing s, with the gas on the right                                                (skin friction)
//! error = 2.36 sd(<q>_1, ..., <q>_8) / 8^1/2,    <q>_b the means over eight parts of the interval                                     (error)
//! ```
//!
//! A wall that consists of curves extruded along z has many rows at the same point: the mean is also one over the span. The flow
//! separates where <c_s> changes from plus to minus with increasing s. It attaches where <c_s> changes from minus to plus, as at a stagnation
//! point. The error is half of a 95 % confidence interval, if the parts are longer than the
//! correlation time of the flow.
//!
//! A wall may consist of several curves. Each has zeros of its own: none lies between the end of a curve and the start of another.

#[cfg(test)]
mod tests;
mod weights;

use super::columns::{Column, columns};
use super::curve::Curve;
use super::section::Section;
use output::{OutputError, Series, write_atomically};
use std::array::from_fn;
use std::fmt::Write;
use std::path::Path;
use weights::TimeWeights;

/// The parts of the times for (error), and Student's factor of 95 % for so many.
const PARTS: usize = 8;
const STUDENT: f64 = 2.365;

/// The columns of the file after the position, by the names of the distribution.
const QUANTITIES: [&str; 6] =
    ["pressure", "pressure_coefficient", "skin_friction", "friction_coefficient", "heat_flux", "y_plus"];

/// The number of the skin friction in [`QUANTITIES`].
const SKIN_FRICTION: usize = 2;

/// The mean at a point of a wall.
#[derive(Clone, Debug, PartialEq)]
struct Row {
    /// s, or the length along a wall that is no closed curve.
    place: f64,
    /// Mean x and y.
    position: [f64; 2],
    /// Its part of the wall; of an extruded one, its part of the curve at rest.
    area: f64,
    means: [f64; QUANTITIES.len()],
    errors: [f64; QUANTITIES.len()],
}

/// A zero of the mean skin friction.
#[derive(Clone, Debug, PartialEq)]
struct Zero {
    kind: &'static str,
    place: f64,
    position: [f64; 2],
}

/// A wall whose means are written.
pub struct MeansOf<'a> {
    /// Its distributions.
    pub series: &'a Series,
    /// Its points.
    pub section: &'a Section,
    /// Whether the gas slips along it: the friction is round-off, and nothing separates.
    pub slips: bool,
}

/// Writes `surface_NAME_mean.csv` and `surface_NAME_separation.csv` of a wall over the times in `interval`. Returns whether the
/// interval and the time from the first to the last distribution overlap: otherwise there is no mean.
///
/// # Errors
/// A file that cannot be written.
pub fn write_means(
    directory: &Path,
    dimension: usize,
    wall: &MeansOf<'_>,
    interval: [f64; 2],
) -> Result<bool, OutputError> {
    let MeansOf { series, section, slips } = *wall;
    let values: Vec<&[f64]> = series.values.chunks_exact(series.array.len()).collect();
    let Some(weights) = TimeWeights::new(&series.times, interval) else { return Ok(false) };
    let is_closed = is_closed(&values);
    let rows = Snapshots::new(dimension, &values, weights).rows(section);
    let file = |end: &str| directory.join(format!("{}_{end}.csv", series.array.name));
    let place = if is_closed { "s" } else { "arc_length" };
    write_atomically(&file("mean"), table(place, &rows).as_bytes())?;
    if slips {
        return Ok(true);
    }
    let zeros: Vec<Zero> = parts(&rows, &section.curves, is_closed).iter().flat_map(Part::zeros).collect();
    write_atomically(&file("separation"), list(place, &zeros).as_bytes()).map(|()| true)
}

/// Whether the wall has s.
fn is_closed(snapshots: &[&[f64]]) -> bool {
    snapshots.first().is_some_and(|values| !values[0].is_nan())
}

/// The snapshots of a wall, and where the numbers of a row stand.
struct Snapshots<'a> {
    values: &'a [&'a [f64]],
    weights: TimeWeights,
    /// Numbers in a row.
    width: usize,
    /// The first numbers of area, position, normal and [`QUANTITIES`].
    area: usize,
    position: usize,
    normal: usize,
    quantities: [usize; QUANTITIES.len()],
    /// That of the place along the wall, if rows have it.
    place: Option<usize>,
}

impl<'a> Snapshots<'a> {
    fn new(dimension: usize, values: &'a [&'a [f64]], weights: TimeWeights) -> Self {
        let columns = columns(dimension);
        let count = |columns: &[Column]| columns.iter().map(|column| column.components).sum();
        let first = |name: &str| count(&columns[..columns.iter().take_while(|column| column.name != name).count()]);
        let place = if is_closed(values) { Some(0) } else { (dimension == 2).then_some(1) };
        let (width, quantities) = (count(&columns), QUANTITIES.map(first));
        Snapshots {
            values,
            weights,
            width,
            area: first("area"),
            position: first(""),
            normal: first("normal"),
            quantities,
            place,
        }
    }

    /// The mean of `of` over the rows of `group` by area, and over the snapshots by their `weights`: a wall that becomes longer has no larger
    /// part in the mean over time.
    fn mean(&self, weights: &[f64], group: &[usize], of: impl Fn(&[f64]) -> f64) -> f64 {
        let at_one_time = |values: &[f64]| {
            let (mut sum, mut area) = (0.0, 0.0);
            for number in group {
                let row = &values[number * self.width..][..self.width];
                sum += row[self.area] * of(row);
                area += row[self.area];
            }
            sum / area
        };
        let (mut sum, mut total) = (0.0, 0.0);
        for (values, weight) in self.values.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            sum += weight * at_one_time(values);
            total += weight;
        }
        sum / total
    }

    /// Quantity `number` of a row. The skin friction is that along the wall.
    fn quantity(&self, row: &[f64], number: usize) -> f64 {
        let first = self.quantities[number];
        if number != SKIN_FRICTION {
            return row[first];
        }
        row[first] * row[self.normal + 1] - row[first + 1] * row[self.normal]
    }

    /// The 95 % error of the mean of quantity `number`, from those of parts of the time. NaN if there are too few.
    fn error(&self, group: &[usize], number: usize) -> f64 {
        let Some(parts) = &self.weights.parts else { return f64::NAN };
        let of_part = |weights: &Vec<f64>| self.mean(weights, group, |row| self.quantity(row, number));
        half_width(&parts.iter().map(of_part).collect::<Vec<_>>())
    }

    /// The mean area of the rows of `group` together.
    fn area(&self, group: &[usize]) -> f64 {
        let of_time = |values: &&[f64]| group.iter().map(|number| values[number * self.width + self.area]).sum::<f64>();
        let weights = &self.weights.whole;
        let sum: f64 = self.values.iter().zip(weights).map(|(values, weight)| weight * of_time(values)).sum();
        sum / weights.iter().sum::<f64>()
    }

    /// The means at all points of the `section`.
    fn rows(&self, section: &Section) -> Vec<Row> {
        let lengths = section.lengths.iter().copied().map(Some).chain(std::iter::repeat(None));
        section.rows.iter().zip(lengths).map(|(group, lengths)| self.row(group, lengths)).collect()
    }

    /// The means at a point. `lengths` are those of an extruded wall.
    fn row(&self, group: &[usize], lengths: Option<[f64; 2]>) -> Row {
        let mean = |of: &dyn Fn(&[f64]) -> f64| self.mean(&self.weights.whole, group, of);
        let place = self.place.map(|place| mean(&|row| row[place]));
        Row {
            place: place.or(lengths.map(|[length, _]| length)).unwrap_or(f64::NAN),
            position: [0, 1].map(|i| mean(&|row| row[self.position + i])),
            area: lengths.map_or_else(|| self.area(group), |[_, part]| part),
            means: from_fn(|number| mean(&|row| self.quantity(row, number))),
            errors: from_fn(|number| self.error(group, number)),
        }
    }
}

/// (error)
fn half_width(means: &[f64]) -> f64 {
    let count = means.len() as f64;
    let centre = means.iter().sum::<f64>() / count;
    let square = means.iter().map(|mean| (mean - centre).powi(2)).sum::<f64>() / (count - 1.0);
    STUDENT * (square / count).sqrt()
}

/// A curve of the wall.
struct Part<'a> {
    rows: &'a [Row],
    /// What the positions jump by from the row before: by zero, but across a periodic boundary.
    jumps: Vec<[f64; 2]>,
    is_closed: bool,
    /// The place where it begins, and its length: 0 and 1 if places are s.
    start: f64,
    length: f64,
}

/// The parts of the `rows` that are the `curves`. A wall that has s is one curve.
fn parts<'a>(rows: &'a [Row], curves: &[Curve], has_s: bool) -> Vec<Part<'a>> {
    let of_facet = rows.len() / curves.iter().map(|curve| curve.facets.len()).sum::<usize>();
    let (mut rest, mut start) = (rows, 0.0);
    let part = |curve: &Curve| {
        let (rows, others) = rest.split_at(curve.facets.len() * of_facet);
        let inside = std::iter::repeat_n([0.0; 2], of_facet - 1);
        let jumps = curve.jumps.iter().flat_map(|jump| std::iter::once(*jump).chain(inside.clone())).collect();
        let length = if has_s { 1.0 } else { rows.iter().map(|row| row.area).sum() };
        let part = Part { rows, jumps, is_closed: curve.is_closed, start, length };
        (rest, start) = (others, start + length);
        part
    };
    curves.iter().map(part).collect()
}

impl Part<'_> {
    /// Where the mean skin friction changes its sign between neighbouring rows, by linear interpolation.
    fn zeros(&self) -> Vec<Zero> {
        let (start, length) = (self.start, self.length);
        let last = if self.is_closed { self.rows.len() } else { self.rows.len().saturating_sub(1) };
        let zero = |k: usize| {
            let next = (k + 1) % self.rows.len();
            let zero = zero(&self.rows[k], &self.rows[next], self.jumps[next], length)?;
            let place = if self.is_closed { start + (zero.place - start).rem_euclid(length) } else { zero.place };
            Some(Zero { place, ..zero })
        };
        (0..last).filter_map(zero).collect()
    }
}

/// The zero of the mean skin friction between two rows. From one to the other the position jumps, and the place may begin anew after the
/// `length` of the curve.
fn zero(row: &Row, next: &Row, jump: [f64; 2], length: f64) -> Option<Zero> {
    let (here, there) = (row.means[SKIN_FRICTION], next.means[SKIN_FRICTION]);
    let part = here / (here - there);
    let between = |a: f64, b: f64| a + part * (b - a);
    // An end of facets that occurs twice has the same place to round-off, and does not begin the curve anew.
    let end = if next.place < row.place - 0.5 * length { next.place + length } else { next.place.max(row.place) };
    // A row without friction counts to the negative side.
    (here != there && (here > 0.0) != (there > 0.0) && !part.is_nan()).then(|| Zero {
        kind: if here > 0.0 { "separation" } else { "attachment" },
        place: between(row.place, end),
        position: [0, 1].map(|i| between(row.position[i], next.position[i] - jump[i])),
    })
}

fn table(place: &str, rows: &[Row]) -> String {
    let errors = QUANTITIES.map(|name| format!("{name}_error"));
    let mut text = format!("{place},x,y,{},{}\n", QUANTITIES.join(","), errors.join(","));
    for Row { place, position, means, errors, .. } in rows {
        let numbers = [&[*place][..], position, means, errors].concat();
        let line = numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{line}");
    }
    text
}

fn list(place: &str, zeros: &[Zero]) -> String {
    let mut text = format!("kind,{place},x,y\n");
    for Zero { kind, place, position: [x, y] } in zeros {
        let _ = writeln!(text, "{kind},{place},{x},{y}");
    }
    text
}
