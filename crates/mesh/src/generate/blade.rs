//! A passage of a blade row: one blade, periodic in the pitch.
//!
//! An O-block of lines normal to the blade, and around it a frame of 3 x 3 blocks without the middle one:
//!
//! ```text
//!            upper periodic line
//!       +---------+---------------+---------+
//!       |         |    above      |         |
//!       |         FU ----------- RU         |        F front, R rear; U upper, L lower corner of the O-block
//! inflow| before  |   (O-block)   |  after  | outflow
//!       |         FL ----------- RL         |
//!       |         |    below      |         |
//!       +---------+---------------+---------+
//!            lower periodic line
//! ```
//!
//! The periodic lines follow the flow: straight in its direction before and behind the blade, a cubic between, half a
//! pitch below and above the middle of the blade. Blocks of the frame are filled by transfinite interpolation of their
//! sides.

use super::assembly::{Assembly, Names};
use super::growth::{Check, Growth};
use super::{ClosedCurve, low_pressure_turbine_profile};
use crate::{Mesh, MeshError};
use std::array::from_fn;

/// A mesh around one blade of a row along y. Boundaries are "blade", "inflow" and "outflow".
#[derive(Clone, Debug, PartialEq)]
pub struct BladeMesh {
    /// The blade.
    pub profile: ClosedCurve,
    /// The distance of the blades, along y.
    pub pitch: f64,
    /// dy/dx of the flow that enters, and of the flow that leaves.
    pub slopes: [f64; 2],
    /// Distance of the inflow from the front of the O-block, and of the outflow from its rear, along x.
    pub distances: [f64; 2],
    /// Thickness of the O-block: less than the radius of every hollow of the blade.
    pub layer: f64,
    /// Height of the cells at the blade.
    pub first_cell: f64,
    /// How cells are laid out.
    pub cells: BladeCells,
    /// N, nodes per direction of the geometry.
    pub order: usize,
}

/// Numbers of cells of a [`BladeMesh`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BladeCells {
    /// Along each side of the blade, without its ends.
    pub side: usize,
    /// Around each end of the blade.
    pub end: usize,
    /// From the blade to the edge of the O-block.
    pub normal: usize,
    /// From the O-block to either periodic line.
    pub gap: usize,
    /// From the inflow to the O-block.
    pub before: usize,
    /// From the O-block to the outflow.
    pub after: usize,
}

impl BladeMesh {
    /// 500 cells around a low-pressure turbine blade of chord 1, see [`low_pressure_turbine_profile`].
    pub fn low_pressure_turbine(order: usize) -> Result<Self, MeshError> {
        Ok(BladeMesh {
            profile: low_pressure_turbine_profile()?,
            pitch: 0.798,
            slopes: [37.7_f64.to_radians().tan(), -63.2_f64.to_radians().tan()],
            distances: [0.6, 0.8],
            layer: 0.06,
            first_cell: 0.006,
            cells: BladeCells { side: 22, end: 4, normal: 4, gap: 4, before: 7, after: 10 },
            order,
        })
    }

    /// The mesh.
    pub fn build(&self) -> Result<Mesh<2>, MeshError> {
        let growth = self.check()?;
        let around = Around::new(self)?;
        let frame = Frame::new(self, &around);
        let mut assembly = Assembly::new(self.order)?;
        let rings = [around.corners[4], self.cells.normal];
        assembly.add(rings, [None, None, Some("blade"), None], |[s, t]| around.position(s, growth.size(t)));
        for column in 0..3 {
            for row in (0..3).filter(|&row| (column, row) != (1, 1)) {
                frame.add_block(&mut assembly, column, row);
            }
        }
        assembly.build(&[("upper", "lower", [0.0, -self.pitch])])
    }

    /// Checks the numbers and returns how cells of the O-block grow.
    fn check(&self) -> Result<Growth, MeshError> {
        let check = Check { mesh: "blade" };
        let BladeCells { side, end, normal, gap, before, after } = self.cells;
        for (quantity, value) in [
            ("the number of cells along a side", side),
            ("the number of cells around an end", end),
            ("the number of cells normal to the blade", normal),
            ("the number of cells beside the O-block", gap),
            ("the number of cells before the blade", before),
            ("the number of cells behind the blade", after),
        ] {
            check.count(quantity, value)?;
        }
        for (quantity, value) in [
            ("the pitch", self.pitch),
            ("the distance of the inflow", self.distances[0]),
            ("the distance of the outflow", self.distances[1]),
            ("the thickness of the O-block", self.layer),
            ("the height of the first cell", self.first_cell),
        ] {
            check.positive(quantity, value)?;
        }
        let steepest = self.slopes[0].abs().max(self.slopes[1].abs());
        check.that(steepest < 20.0, "the slope of the flow", steepest, "less than 20 (87 degrees)")?;
        check.that(self.first_cell <= self.layer, "the height of the first cell", self.first_cell, "at most the layer")?;
        Ok(Growth::new(normal, self.first_cell, self.layer))
    }
}

/// The normal at a corner of the O-block and the direction of the flow at that end of the blade make this angle.
const CORNER_ANGLE: f64 = 0.8;

/// The O-block: s counts cells from corner FL clockwise, so that FU, RU, RL follow, and FL again.
struct Around<'a> {
    profile: &'a ClosedCurve,
    layer: f64,
    /// s of FL, FU, RU, RL, FL.
    corners: [usize; 5],
    /// Parameters of the curve at s = 0, 1, .., increasing.
    parameters: Vec<f64>,
}

impl<'a> Around<'a> {
    fn new(mesh: &'a BladeMesh) -> Result<Self, MeshError> {
        let (profile, BladeCells { side, end, .. }) = (&mesh.profile, mesh.cells);
        let length = profile.length();
        let [lower_front, upper_front] = end_corners(profile, [-1.0, -mesh.slopes[0]])?;
        let [upper_rear, lower_rear] = end_corners(profile, [1.0, mesh.slopes[1]])?;
        let after = |u: f64| lower_front + (u - lower_front).rem_euclid(length);
        let ends = [lower_front, after(upper_front), after(upper_rear), after(lower_rear), lower_front + length];
        let mut parameters = vec![lower_front];
        for (k, cells) in [end, side, end, side].into_iter().enumerate() {
            parameters.extend(distributed(profile, mesh.layer, ends[k], ends[k + 1], cells).into_iter().skip(1));
        }
        let corners = [0, end, end + side, 2 * end + side, 2 * (end + side)];
        Ok(Around { profile, layer: mesh.layer, corners, parameters })
    }

    /// The point at distance `height` from the blade. Between the ends of a cell the parameter of the curve is linear in
    /// s, so that the cell is as smooth as the curve.
    fn position(&self, s: f64, height: f64) -> [f64; 2] {
        let cell = (s as usize).min(self.corners[4] - 1);
        let (fraction, ends) = (s - cell as f64, [self.parameters[cell], self.parameters[cell + 1]]);
        let u = (1.0 - fraction) * ends[0] + fraction * ends[1];
        let (x, normal) = (self.profile.position(u), self.profile.normal(u));
        from_fn(|i| x[i] + height * normal[i])
    }

    /// The point of the outer edge at the fraction `share` of the way from corner `from` to corner `to`.
    fn edge(&self, from: usize, to: usize, share: f64) -> [f64; 2] {
        let [from, to] = [from, to].map(|corner| self.corners[corner] as f64);
        self.position((1.0 - share) * from + share * to, self.layer)
    }
}

/// The corners, in clockwise order, at the end of the blade that lies farthest in `direction`.
fn end_corners(profile: &ClosedCurve, direction: [f64; 2]) -> Result<[f64; 2], MeshError> {
    let size = direction[0].hypot(direction[1]);
    let tip = profile.farthest(direction);
    let turned = |u: f64| {
        let normal = profile.normal(u);
        (normal[0] * direction[0] + normal[1] * direction[1]) / size < CORNER_ANGLE.cos()
    };
    let step = profile.length() / 4000.0;
    let corner = |sense: f64| {
        let beyond = (1..1000).map(|k| tip + sense * step * f64::from(k)).find(|&u| turned(u));
        let (mut high, mut low) = (beyond?, beyond? - sense * step);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if turned(middle) { high = middle } else { low = middle }
        }
        Some(high)
    };
    let missing = MeshError::Parameter {
        mesh: "blade",
        quantity: "the angle by which the profile turns at an end",
        value: 0.0,
        accepted: "at least 0.8 on either side of the direction of the flow",
    };
    corner(-1.0).zip(corner(1.0)).map(|(before, after)| [before, after]).ok_or(missing)
}

/// `cells` + 1 parameters from `from` to `to`, in equal steps of int sqrt(|x'|^2 + (c theta')^2) du, theta the angle of
/// the tangent: where the curve is not straight cells are shorter, by as much as an edge at the distance c is longer.
fn distributed(profile: &ClosedCurve, c: f64, from: f64, to: f64, cells: usize) -> Vec<f64> {
    let density = |u: f64| {
        let (t, b) = (profile.tangent(u), profile.bend(u));
        let square = t[0] * t[0] + t[1] * t[1];
        (square + (c * (t[0] * b[1] - t[1] * b[0]) / square).powi(2)).sqrt()
    };
    let steps = 200 * cells;
    let width = (to - from) / steps as f64;
    let mut sums = vec![0.0];
    for k in 0..steps {
        sums.push(sums[k] + width * density(from + (k as f64 + 0.5) * width));
    }
    let parameter = |share: f64| {
        let sum = share * sums[steps];
        let k = sums.partition_point(|&before| before <= sum).clamp(1, steps) - 1;
        from + width * (k as f64 + (sum - sums[k]) / (sums[k + 1] - sums[k]))
    };
    (0..=cells).map(|i| if i == cells { to } else { parameter(i as f64 / cells as f64) }).collect()
}

/// The blocks around the O-block. Columns 0, 1, 2 lie before, beside and behind the blade, rows 0, 1, 2 below, beside
/// and above it.
struct Frame<'a> {
    mesh: &'a BladeMesh,
    around: &'a Around<'a>,
    /// x of the four lines between the columns, where they meet the periodic lines.
    columns: [f64; 4],
    /// y of the middle of the passage at the two inner ones.
    middle: [f64; 2],
}

type Point = [f64; 2];

/// Corners of the O-block as [`Around`] counts them: by column (front, rear) and row (lower, upper).
const CORNERS: [[usize; 2]; 2] = [[0, 1], [3, 2]];

impl<'a> Frame<'a> {
    fn new(mesh: &'a BladeMesh, around: &'a Around) -> Self {
        let corner = |column: usize, row: usize| around.edge(CORNERS[column][row], CORNERS[column][row], 0.0);
        let mean = |column, i: usize| 0.5 * (corner(column, 0)[i] + corner(column, 1)[i]);
        let (front, rear) = (mean(0, 0), mean(1, 0));
        let columns = [front - mesh.distances[0], front, rear, rear + mesh.distances[1]];
        Frame { mesh, around, columns, middle: [mean(0, 1), mean(1, 1)] }
    }

    /// Cells of the columns and of the rows.
    fn cells(&self) -> [[usize; 3]; 2] {
        let BladeCells { side, end, gap, before, after, .. } = self.mesh.cells;
        [[before, side, after], [gap, end, gap]]
    }

    fn add_block(&self, assembly: &mut Assembly, column: usize, row: usize) {
        let cells = [self.cells()[0][column], self.cells()[1][row]];
        let name = |here: bool, name: &'static str| here.then_some(name);
        let names: Names = [
            name(column == 0, "inflow"),
            name(column == 2, "outflow"),
            name(row == 0, "lower"),
            name(row == 2, "upper"),
        ];
        assembly.add(cells, names, |[s, t]| {
            let (s, t) = (s / cells[0] as f64, t / cells[1] as f64);
            transfinite([s, t], |s| self.along(column, row, s), |s| self.along(column, row + 1, s), |t| {
                self.across(column, row, t)
            }, |t| self.across(column + 1, row, t))
        });
    }

    /// Line `row` (0..=3, from the lower to the upper periodic one) in `column`, s from 0 to 1.
    fn along(&self, column: usize, row: usize, s: f64) -> Point {
        match (column, row) {
            (_, 0 | 3) => self.periodic_line(column, row, s),
            // The lower side is met from its end, corner FL after a full turn.
            (1, 1) => self.around.edge(4, 3, s),
            (1, _) => self.around.edge(1, 2, s),
            _ => blend(self.vertex(column, row), self.vertex(column + 1, row), s),
        }
    }

    /// Line `column` (0..=3, from the inflow to the outflow) in `row`, t from 0 to 1.
    fn across(&self, column: usize, row: usize, t: f64) -> Point {
        if let (1 | 2, 1) = (column, row) {
            let [lower, upper] = CORNERS[column - 1];
            return self.around.edge(lower, upper, t);
        }
        blend(self.vertex(column, row), self.vertex(column, row + 1), t)
    }

    /// Where line `column` and line `row` cross.
    fn vertex(&self, column: usize, row: usize) -> Point {
        match (column, row) {
            (1 | 2, 1 | 2) => {
                let corner = CORNERS[column - 1][row - 1];
                self.around.edge(corner, corner, 0.0)
            }
            (0, 1 | 2) | (3, 1 | 2) => {
                // Inflow and outflow are cut in proportion to the cells.
                let BladeCells { gap, end, .. } = self.mesh.cells;
                let share = if row == 1 { gap } else { gap + end } as f64 / (2 * gap + end) as f64;
                blend(self.vertex(column, 0), self.vertex(column, 3), share)
            }
            (3, _) => self.periodic_line(2, row, 1.0),
            _ => self.periodic_line(column, row, 0.0),
        }
    }

    /// The lower (row 0) or upper (row 3) periodic line.
    fn periodic_line(&self, column: usize, row: usize, s: f64) -> Point {
        let x = (1.0 - s) * self.columns[column] + s * self.columns[column + 1];
        let offset = if row == 0 { -0.5 } else { 0.5 } * self.mesh.pitch;
        let [enters, leaves] = self.mesh.slopes;
        let y = match column {
            0 => self.middle[0] + enters * (x - self.columns[1]),
            2 => self.middle[1] + leaves * (x - self.columns[2]),
            _ => hermite(self.middle, [enters, leaves], self.columns[2] - self.columns[1], s),
        };
        [x, y + offset]
    }
}

/// The cubic on an interval of length h with given values and slopes at its ends, at the fraction s.
fn hermite(values: [f64; 2], slopes: [f64; 2], h: f64, s: f64) -> f64 {
    let r = 1.0 - s;
    r * r * (1.0 + 2.0 * s) * values[0] + s * s * (1.0 + 2.0 * r) * values[1] + h * r * s * (r * slopes[0] - s * slopes[1])
}

fn blend(a: Point, b: Point, s: f64) -> Point {
    from_fn(|i| (1.0 - s) * a[i] + s * b[i])
}

/// The point (s, t) of a block with given sides (Gordon & Hall 1973): the sum of the two linear interpolations between
/// opposite sides less the bilinear one between the corners.
fn transfinite(
    [s, t]: [f64; 2],
    bottom: impl Fn(f64) -> Point,
    top: impl Fn(f64) -> Point,
    left: impl Fn(f64) -> Point,
    right: impl Fn(f64) -> Point,
) -> Point {
    let (rows, columns) = (blend(bottom(s), top(s), t), blend(left(t), right(t), s));
    let corners = blend(blend(bottom(0.0), bottom(1.0), s), blend(top(0.0), top(1.0), s), t);
    from_fn(|i| rows[i] + columns[i] - corners[i])
}
