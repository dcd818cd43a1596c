//! Values at the centres of pixels.

use super::window::Window;

/// Linear pieces of a surface: triangles with several values at each corner.
#[derive(Clone, Debug, Default)]
pub struct Triangles {
    /// The corners.
    pub points: Vec<[f64; 2]>,
    /// Values at the corners, `[corner][quantity]`.
    pub values: Vec<f64>,
    /// The triangles, by their corners.
    pub triangles: Vec<[usize; 3]>,
}

/// Values at the centres of the pixels of a window; NaN outside the domain, infinite in a structure beside the flow.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    quantities: usize,
    /// `[row][column][quantity]`, the first row on top.
    values: Vec<f32>,
}

impl Raster {
    /// An empty picture of `window`.
    pub fn new(window: &Window, quantities: usize) -> Self {
        let Window { width, height, .. } = *window;
        Raster { width, height, quantities, values: vec![f32::NAN; width * height * quantities] }
    }

    /// A quantity at all pixels, row by row.
    pub fn of(&self, quantity: usize) -> impl Iterator<Item = f32> + '_ {
        self.values.iter().skip(quantity).step_by(self.quantities).copied()
    }

    /// Draws triangles with values that are linear in each.
    pub fn draw(&mut self, window: &Window, surface: &Triangles) {
        let pixels: Vec<[f64; 2]> = surface.points.iter().map(|&point| window.pixel(point)).collect();
        for corners in &surface.triangles {
            self.triangle(
                corners.map(|corner| pixels[corner]),
                corners.map(|corner| corner * self.quantities),
                surface,
            );
        }
    }

    /// Draws the triangle with corners `x` in pixels, whose values begin at `at`.
    fn triangle(&mut self, x: [[f64; 2]; 3], at: [usize; 3], surface: &Triangles) {
        let area = cross(x[0], x[1], x[2]);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let heights = [[1, 2], [2, 0], [0, 1]]
            .map(|[a, b]: [usize; 2]| area.abs() / (x[b][0] - x[a][0]).hypot(x[b][1] - x[a][1]));
        let rows = centres(grown(x.map(|x| x[1])), self.height);
        let columns = centres(grown(x.map(|x| x[0])), self.width);
        for row in rows {
            for column in columns.clone() {
                let p = [column as f64 + 0.5, row as f64 + 0.5];
                // Barycentric coordinates: area fractions opposite to the corners.
                let b = [cross(p, x[1], x[2]) / area, cross(x[0], p, x[2]) / area, cross(x[0], x[1], p) / area];
                let pixel = row * self.width + column;
                // An edge belongs to both of its triangles, so rounding leaves no gap.
                if b.iter().all(|b| *b >= -1e-9) {
                    self.set(pixel, b, at, &surface.values);
                } else if self.is_empty(pixel) && (0..3).all(|k| b[k] * heights[k] >= -SLIT) {
                    self.set(pixel, within(b), at, &surface.values);
                }
            }
        }
    }

    /// Whether nothing has been drawn at a pixel.
    fn is_empty(&self, pixel: usize) -> bool {
        self.values[pixel * self.quantities..][..self.quantities].iter().all(|value| value.is_nan())
    }

    fn set(&mut self, pixel: usize, b: [f64; 3], at: [usize; 3], values: &[f64]) {
        for (q, value) in self.values[pixel * self.quantities..][..self.quantities].iter_mut().enumerate() {
            // Infinite values mark cells; a zero weight would make them no number.
            let corners = at.map(|at| values[at + q]);
            let linear = (0..3).map(|k| b[k] * corners[k]).sum::<f64>();
            *value = if corners[0].is_infinite() { corners[0] } else { linear } as f32;
        }
    }
}

/// Two cells may cut a curved edge into different numbers of straight pieces, which leaves slits between them. So a triangle also covers
/// centres of pixels this far beside it, in pixels, unless another one contains them.
const SLIT: f64 = 0.25;

/// The smallest, the largest and any coordinate, with slits on both sides.
fn grown(x: [f64; 3]) -> [f64; 3] {
    let (lower, upper) = (x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2]));
    [lower - SLIT, upper + SLIT, lower]
}

/// The nearest barycentric coordinates in the triangle, for points close to it.
fn within(b: [f64; 3]) -> [f64; 3] {
    let b = b.map(|b| b.max(0.0));
    let sum: f64 = b.iter().sum();
    b.map(|b| b / sum)
}

/// Twice the signed area of a triangle.
pub fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The pixels of `count` in a line whose centres lie between the coordinates `x`.
pub fn centres(x: [f64; 3], count: usize) -> std::ops::Range<usize> {
    let (lower, upper) = (x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2]));
    // The cast turns negative numbers into 0.
    let first = (lower - 0.5 - 1e-6).ceil() as usize;
    first..((upper - 0.5 + 1e-6).floor() + 1.0).min(count as f64) as usize
}

#[cfg(test)]
mod tests {
    use super::super::bounds::Extent;
    use super::*;

    /// The unit square cut into two triangles, with the values x + 10 y and 1.
    fn square() -> Triangles {
        let points = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let values = points.iter().flat_map(|&[x, y]| [x + 10.0 * y, 1.0]).collect();
        Triangles { points, values, triangles: vec![[0, 1, 2], [1, 3, 2]] }
    }

    #[test]
    fn a_linear_field_is_exact_and_has_no_gaps() {
        let window = Window::new("", Extent { lower: [0.0; 2], upper: [1.0; 2] }, 30.0 * 30.0);
        let mut raster = Raster::new(&window, 2);
        raster.draw(&window, &square());
        let scale = window.scale();
        for (pixel, value) in raster.of(0).enumerate() {
            let (column, row) = (pixel % raster.width, pixel / raster.width);
            let (x, y) = ((column as f64 + 0.5) / scale, 1.0 - (row as f64 + 0.5) / scale);
            assert!((f64::from(value) - (x + 10.0 * y)).abs() < 1e-5, "pixel {pixel}: {value}");
        }
        assert!(raster.of(1).all(|value| (value - 1.0).abs() < 1e-6));
    }

    /// Two cells with a curved edge between them, cut into 2 and into 8 pieces.
    #[test]
    fn slits_between_cells_are_covered() {
        let curve = |s: f64| [0.5 + 0.02 * s * (1.0 - s), s];
        let strip = |pieces: usize, side: f64| {
            let row = |k: usize| {
                let s = k as f64 / pieces as f64;
                [curve(s), [side, s]]
            };
            let points: Vec<[f64; 2]> = (0..=pieces).flat_map(row).collect();
            let pair = |k: usize| [[2 * k, 2 * k + 1, 2 * k + 2], [2 * k + 1, 2 * k + 3, 2 * k + 2]];
            Triangles { values: vec![side; points.len()], points, triangles: (0..pieces).flat_map(pair).collect() }
        };
        let window = Window::new("", Extent { lower: [0.0; 2], upper: [1.0; 2] }, 200.0 * 200.0);
        let mut raster = Raster::new(&window, 1);
        raster.draw(&window, &strip(8, 0.0));
        raster.draw(&window, &strip(2, 1.0));
        assert_eq!(raster.of(0).filter(|value| value.is_nan()).count(), 0);
        // No pixel of one cell is taken by the other: the left one is 0.5 + 0.02/6 wide.
        let left = raster.of(0).filter(|value| *value == 0.0).count() as f64 / 40_000.0;
        assert!((left - 0.5 - 0.02 / 6.0).abs() < 0.003, "{left}");
    }

    #[test]
    fn an_infinite_value_fills_its_triangles() {
        let window = Window::new("", Extent { lower: [0.0; 2], upper: [1.0; 2] }, 20.0 * 20.0);
        let mut raster = Raster::new(&window, 1);
        raster.draw(&window, &Triangles { values: vec![f64::INFINITY; 4], ..square() });
        assert!(raster.of(0).all(|value| value == f32::INFINITY));
    }

    #[test]
    fn outside_there_is_nothing() {
        let window = Window::new("", Extent { lower: [-1.0; 2], upper: [1.0; 2] }, 1600.0);
        let mut raster = Raster::new(&window, 2);
        raster.draw(&window, &square());
        let drawn = raster.of(0).filter(|value| value.is_finite()).count();
        assert_eq!((drawn, raster.of(0).count()), (400, 1600));
    }
}
