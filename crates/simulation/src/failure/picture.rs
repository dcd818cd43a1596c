//! The worst cell and its neighbours as SVG, coloured by a quantity.

use super::grid::Grid;
use mesh::face_nodes;
use report::html::{escaped, short};
use report::pictures::ColourMap;
use std::fmt::Write;

/// Pixels of the longer side, and around the picture.
const SIZE: f64 = 480.0;
const MARGIN: f64 = 20.0;

/// Height of the legend.
const LEGEND: f64 = 60.0;

/// The input of a picture.
pub struct Painting<'a, const D: usize> {
    /// The points of cells.
    pub grid: &'a Grid<'a, D>,
    /// The displacement of the mesh, `[C0 node][component]`.
    pub displacement: &'a [f64],
    /// The worst cell, then its neighbours.
    pub cells: Vec<usize>,
    /// The quantity.
    pub label: String,
    /// Its values at the points of each of the cells.
    pub values: Vec<Vec<f64>>,
}

/// A drawn cell: its projected points, in pixels.
struct Drawn {
    cell: usize,
    points: Vec<[f64; 2]>,
    values: Vec<f64>,
}

impl<const D: usize> Painting<'_, D> {
    /// The picture.
    pub fn svg(&self) -> String {
        let (cells, [width, height]) = self.drawn();
        let range = range(&self.values);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{:.0}\" font-family=\"sans-serif\" \
             font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
            height + LEGEND
        );
        // The worst cell is drawn last, above the others.
        for (number, drawn) in cells.iter().enumerate().rev() {
            self.paint(&mut svg, drawn, range, number == 0);
        }
        svg += &legend(&self.label, range, height);
        svg + "</svg>\n"
    }

    /// The cells in pixels, and the size of the picture without its legend.
    fn drawn(&self) -> (Vec<Drawn>, [f64; 2]) {
        let projected = |cell: usize| -> Vec<[f64; 2]> {
            self.grid.positions(cell, self.displacement).iter().map(projection).collect()
        };
        let points: Vec<Vec<[f64; 2]>> = self.cells.iter().map(|&cell| projected(cell)).collect();
        let extreme = |axis: usize, pick: fn(f64, f64) -> f64, start: f64| {
            points.iter().flatten().map(|x| x[axis]).fold(start, pick)
        };
        let lower = [0, 1].map(|axis| extreme(axis, f64::min, f64::INFINITY));
        let upper = [0, 1].map(|axis| extreme(axis, f64::max, f64::NEG_INFINITY));
        let extent = [0, 1].map(|axis| (upper[axis] - lower[axis]).max(f64::MIN_POSITIVE));
        let scale = SIZE / extent[0].max(extent[1]);
        let pixels = |x: &[f64; 2]| [MARGIN + scale * (x[0] - lower[0]), MARGIN + scale * (upper[1] - x[1])];
        let drawn = self.cells.iter().zip(&points).zip(&self.values).map(|((&cell, points), values)| Drawn {
            cell,
            points: points.iter().map(pixels).collect(),
            values: values.clone(),
        });
        (drawn.collect(), extent.map(|extent| 2.0 * MARGIN + scale * extent))
    }

    /// The lattices of points that are filled: the cell itself in two dimensions, its faces in three.
    fn lattices(&self) -> Vec<Vec<usize>> {
        let n = self.grid.points;
        match D {
            2 => vec![(0..n * n).collect()],
            _ => (0..2 * D).map(|face| face_nodes(D, n, face)).collect(),
        }
    }

    fn paint(&self, svg: &mut String, drawn: &Drawn, range: [f64; 2], worst: bool) {
        let n = self.grid.points;
        for lattice in self.lattices() {
            let quads = (0..(n - 1) * (n - 1)).map(|k| k % (n - 1) + k / (n - 1) * n);
            // In three dimensions neighbours would hide the cell, so only their edges are drawn.
            for corner in quads.filter(|_| D == 2 || worst) {
                let corners = [corner, corner + 1, corner + n + 1, corner + n].map(|i| lattice[i]);
                let value = corners.map(|i| drawn.values[i]).iter().sum::<f64>() / 4.0;
                let opacity = if D == 2 { 1.0 } else { 0.5 };
                let _ = writeln!(
                    svg,
                    "<polygon points=\"{}\" fill=\"{}\" fill-opacity=\"{opacity}\"/>",
                    path(corners.iter(), &drawn.points),
                    colour(value, range)
                );
            }
            let (stroke, width) = if worst { ("#d00", 2.5) } else { ("black", 1.0) };
            let edge = path(border(n).iter().map(|i| &lattice[*i]), &drawn.points);
            let _ = writeln!(
                svg,
                "<polygon points=\"{edge}\" fill=\"none\" stroke=\"{stroke}\" stroke-width=\"{width}\"/>"
            );
        }
        let [x, y] = drawn.points[drawn.points.len() / 2];
        let _ = writeln!(
            svg,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\" stroke=\"white\" stroke-width=\"3\" \
             paint-order=\"stroke\">{}</text>",
            drawn.cell
        );
    }
}

/// The identity in two dimensions; in three the view from the direction (1, -1, 1).
fn projection<const D: usize>(x: &[f64; D]) -> [f64; 2] {
    match x[..] {
        [x, y, z] => [(x + y) * 0.75_f64.sqrt(), z + 0.5 * (y - x)],
        _ => [x[0], x[1]],
    }
}

/// The indices around an n x n lattice.
fn border(n: usize) -> Vec<usize> {
    let (bottom, right) = ((0..n - 1), (0..n - 1).map(|j| j * n + n - 1));
    let (top, left) = ((1..n).rev().map(|i| (n - 1) * n + i), (1..n).rev().map(|j| j * n));
    bottom.chain(right).chain(top).chain(left).collect()
}

fn path<'a>(indices: impl Iterator<Item = &'a usize>, points: &[[f64; 2]]) -> String {
    indices.map(|&i| format!("{:.1},{:.1}", points[i][0], points[i][1])).collect::<Vec<_>>().join(" ")
}

/// The smallest and the largest value, slightly extended.
fn range(values: &[Vec<f64>]) -> [f64; 2] {
    let finite = || values.iter().flatten().copied().filter(|value| value.is_finite());
    let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    // Values that differ only by round-off have one colour.
    match high - low > 1e-9 * low.abs().max(high.abs()) {
        true => [low, high],
        false if low.is_finite() => [low - 0.5, low + 0.5],
        false => [0.0, 1.0],
    }
}

/// Grey if there is no value.
fn colour(value: f64, [low, high]: [f64; 2]) -> String {
    if !value.is_finite() {
        return "#999".into();
    }
    let [r, g, b] = ColourMap::Sequential.at((value - low) / (high - low));
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A bar of the colours with the values at both ends and a label.
fn legend(label: &str, range: [f64; 2], top: f64) -> String {
    let parts = ColourMap::Sequential.stops().len();
    let width = 200.0 / parts as f64;
    let part = |i: usize| {
        let value = range[0] + (i as f64 + 0.5) / parts as f64 * (range[1] - range[0]);
        let x = MARGIN + i as f64 * width;
        format!(
            "<rect x=\"{x:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"12\" fill=\"{}\"/>\n",
            colour(value, range)
        )
    };
    let text = |x: f64, y: f64, anchor: &str, text: &str| {
        format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{}</text>\n", escaped(text))
    };
    let bar: String = (0..parts).map(part).collect();
    bar + &text(MARGIN, top + 28.0, "start", &short(range[0]))
        + &text(MARGIN + 200.0, top + 28.0, "end", &short(range[1]))
        + &text(MARGIN, top + 46.0, "start", label)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_border_goes_around_once() {
        assert_eq!(border(3), [0, 1, 2, 5, 8, 7, 6, 3]);
    }

    #[test]
    fn colours_span_the_values_and_nothing_else() {
        assert_eq!(range(&[vec![2.0, f64::NAN], vec![5.0]]), [2.0, 5.0]);
        assert_eq!(range(&[vec![2.0]]), [1.5, 2.5]);
        assert_eq!(range(&[vec![2.0, 2.0 + 1e-15]]), [1.5, 2.5]);
        assert_eq!(range(&[vec![f64::NAN]]), [0.0, 1.0]);
        assert_eq!(colour(f64::NAN, [0.0, 1.0]), "#999");
        assert_ne!(colour(0.0, [0.0, 1.0]), colour(1.0, [0.0, 1.0]));
    }
}
