//! A flag behind a cylinder in a channel.

use super::assembly::Assembly;
use super::growth::{Check, Growth};
use crate::{Mesh, MeshError};
use std::array::from_fn;
use std::f64::consts::TAU;

/// The channel [0, L] x [0, H] without a circle, with a flag that is attached to the circle: region "flag", beside region "fluid". Boundaries
/// are "inflow" (x = 0), "outflow" (x = L), "bottom", "top" and "cylinder". All nodes of the cylinder lie on the circle.
///
/// ```text
/// +--------------+---------+-------------------+
/// | \   around  / | beside  |                   |        The rectangle around the cylinder ends at twice the x of its centre.
/// |  \        /  |         |                   |
/// |    (  ) ====|=========|                   |        outwards | along | after
/// |  /        \  |         |                   |
/// +--------------+---------+-------------------+
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelFlagMesh {
    /// L and H.
    pub extent: [f64; 2],
    /// The centre of the circle, at whose height the flag lies.
    pub centre: [f64; 2],
    /// Diameter of the circle.
    pub diameter: f64,
    /// x of the end of the flag.
    pub flag_end: f64,
    /// Thickness of the flag.
    pub thickness: f64,
    /// Height of the cells at the cylinder, where it is nearest to the rectangle.
    pub first_cell: f64,
    /// Height of the cells beside the flag.
    pub flag_cell: f64,
    /// Numbers of cells.
    pub cells: FlagCells,
    /// N, nodes per direction of the geometry.
    pub order: usize,
}

/// Numbers of cells around a flag.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlagCells {
    /// Along the cylinder on its front, its top and its bottom, each.
    pub around: usize,
    /// Outwards from the cylinder.
    pub outwards: usize,
    /// From either side of the flag to the wall.
    pub beside: usize,
    /// Along the flag behind the rectangle around the cylinder.
    pub along: usize,
    /// Across the flag.
    pub across: usize,
    /// From the end of the flag to the outflow.
    pub after: usize,
}

/// Names of the regions.
const FLUID: &str = "fluid";
const FLAG: &str = "flag";

impl ChannelFlagMesh {
    /// The geometry of Turek & Hron (2006), in about 500 cells.
    pub fn turek_hron(order: usize) -> Self {
        ChannelFlagMesh {
            extent: [2.5, 0.41],
            centre: [0.2, 0.2],
            diameter: 0.1,
            flag_end: 0.6,
            thickness: 0.02,
            first_cell: 0.01,
            flag_cell: 0.01,
            cells: FlagCells { around: 6, outwards: 6, beside: 6, along: 8, across: 2, after: 14 },
            order,
        }
    }

    /// The mesh.
    pub fn build(&self) -> Result<Mesh<2>, MeshError> {
        let mut assembly = Assembly::new(self.order)?;
        let layout = self.layout()?;
        layout.add_around(&mut assembly);
        layout.add_root(&mut assembly);
        layout.add_rows(&mut assembly);
        assembly.build(&[])
    }

    /// The flag reaches from the first to the second of these heights.
    fn flag_heights(&self) -> [f64; 2] {
        [-0.5, 0.5].map(|side| self.centre[1] + side * self.thickness)
    }

    fn layout(&self) -> Result<GridLayout<'_>, MeshError> {
        let gap = self.gap()?;
        let [low, high] = self.flag_heights();
        let FlagCells { outwards, beside, along, after, .. } = self.cells;
        let (length, end) = (self.extent[0], 2.0 * self.centre[0]);
        let last = (self.flag_end - end) / along as f64;
        let rest = length - self.flag_end;
        Ok(GridLayout {
            mesh: self,
            end,
            outwards: Parts::new(outwards, self.first_cell, gap),
            below: Parts::new(beside, self.flag_cell, low),
            above: Parts::new(beside, self.flag_cell, self.extent[1] - high),
            after: Parts::new(after, last.min(rest / after as f64), rest),
        })
    }

    /// The distance from the cylinder to the rectangle.
    fn gap(&self) -> Result<f64, MeshError> {
        let check = Check { mesh: "channel with a flag" };
        self.check_numbers(check)?;
        let ([length, height], [x, y], radius) = (self.extent, self.centre, 0.5 * self.diameter);
        let accepted = "less than the diameter";
        check.that(self.thickness < self.diameter, "the thickness of the flag", self.thickness, accepted)?;
        let inside = "a place at which a cylinder of the given diameter touches neither walls nor inflow";
        let above = (y - radius).min(height - y - radius);
        check.that(x > radius, "x of the centre", x, inside)?;
        check.that(above > 0.0, "y of the centre", y, inside)?;
        let accepted = "more than twice x of the centre, and less than the length";
        let fine = 2.0 * x < self.flag_end && self.flag_end < length;
        check.that(fine, "the end of the flag", self.flag_end, accepted)?;
        let gap = above.min(x - radius);
        let accepted = "less than the distance from the cylinder to walls and inflow";
        check.first_cell((self.cells.outwards, self.first_cell), gap, accepted)?;
        let [low, high] = self.flag_heights();
        let (accepted, room) = ("less than the distance from the flag to the walls", low.min(height - high));
        let fine = self.flag_cell < room || (self.cells.beside == 1 && self.flag_cell == room);
        check.that(fine, "the height of the cells beside the flag", self.flag_cell, accepted)?;
        Ok(gap)
    }

    fn check_numbers(&self, check: Check) -> Result<(), MeshError> {
        for (quantity, value) in [
            ("the length", self.extent[0]),
            ("the height", self.extent[1]),
            ("the diameter", self.diameter),
            ("the end of the flag", self.flag_end),
            ("the thickness of the flag", self.thickness),
            ("the height of the first cell", self.first_cell),
            ("the height of the cells beside the flag", self.flag_cell),
        ] {
            check.positive(quantity, value)?;
        }
        let FlagCells { around, outwards, beside, along, across, after } = self.cells;
        for (quantity, cells) in [
            ("the number of cells around", around),
            ("the number of cells outwards", outwards),
            ("the number of cells beside the flag", beside),
            ("the number of cells along the flag", along),
            ("the number of cells across the flag", across),
            ("the number of cells after the flag", after),
        ] {
            check.count(quantity, cells)?;
        }
        Ok(())
    }
}

/// Growing cells, as parts of their total.
struct Parts {
    growth: Growth,
    cells: f64,
    total: f64,
}

impl Parts {
    fn new(cells: usize, first: f64, total: f64) -> Self {
        Parts { growth: Growth::new(cells, first, total), cells: cells as f64, total }
    }

    /// The part that the first `t` cells fill.
    fn first(&self, t: f64) -> f64 {
        self.growth.size(t) / self.total
    }

    /// The part that the last `t` cells leave.
    fn without_last(&self, t: f64) -> f64 {
        self.first(self.cells - t)
    }
}

/// A coordinate, or a part of a length, by the place between cells.
type Line<'a> = &'a dyn Fn(f64) -> f64;

/// A side of the rectangle around the cylinder, run through clockwise.
struct Side<'a> {
    name: Option<&'a str>,
    cells: usize,
    ends: [[f64; 2]; 2],
    /// The part of the side before place `s` between its cells.
    part: Line<'a>,
}

/// Where the lines of the mesh run.
struct GridLayout<'a> {
    mesh: &'a ChannelFlagMesh,
    /// x of the end of the rectangle around the cylinder.
    end: f64,
    /// From the cylinder to the rectangle.
    outwards: Parts,
    /// From the flag to the lower and to the upper wall.
    below: Parts,
    above: Parts,
    /// From the flag to the outflow.
    after: Parts,
}

impl GridLayout<'_> {
    /// The fluid between the cylinder and the rectangle.
    fn add_around(&self, assembly: &mut Assembly) {
        let (height, end) = (self.mesh.extent[1], self.end);
        let [low, high] = self.mesh.flag_heights();
        let FlagCells { around, beside, .. } = self.mesh.cells;
        let even = |s: f64| s / around as f64;
        let below = |s: f64| self.below.first(s);
        let above = |s: f64| 1.0 - self.above.without_last(s);
        let side = |name, ends| Side { name, cells: around, ends, part: &even };
        let beside = |ends, part| Side { name: None, cells: beside, ends, part };
        for side in [
            beside([[end, low], [end, 0.0]], &below as Line<'_>),
            side(Some("bottom"), [[end, 0.0], [0.0, 0.0]]),
            side(Some("inflow"), [[0.0, 0.0], [0.0, height]]),
            side(Some("top"), [[0.0, height], [end, height]]),
            beside([[end, height], [end, high]], &above),
        ] {
            let names = [None, None, Some("cylinder"), side.name];
            let cells = [side.cells, self.mesh.cells.outwards];
            assembly.add_to(FLUID, cells, names, |[s, t]| self.on_ray(&side, s, self.outwards.first(t)));
        }
    }

    /// The point after the part `t` of the ray from the circle to place `s` on `side`.
    fn on_ray(&self, side: &Side<'_>, s: f64, t: f64) -> [f64; 2] {
        let [from, to] = side.ends.map(|x| self.angle(x));
        let to = if to > from { to - TAU } else { to };
        let (sine, cosine) = (from + s / side.cells as f64 * (to - from)).sin_cos();
        let (centre, radius, part) = (self.mesh.centre, 0.5 * self.mesh.diameter, (side.part)(s));
        let circle = [centre[0] + radius * cosine, centre[1] + radius * sine];
        from_fn(|i| (1.0 - t) * circle[i] + t * (side.ends[0][i] * (1.0 - part) + side.ends[1][i] * part))
    }

    /// The angle at which the ray to the end `x` of a side leaves the circle: along the flag where it begins there.
    fn angle(&self, x: [f64; 2]) -> f64 {
        let height = x[1] - self.mesh.centre[1];
        if self.mesh.flag_heights().contains(&x[1]) {
            (2.0 * height / self.mesh.diameter).asin()
        } else {
            height.atan2(x[0] - self.mesh.centre[0])
        }
    }

    /// The flag from the circle to the end of the rectangle.
    fn add_root(&self, assembly: &mut Assembly) {
        let FlagCells { outwards, across, .. } = self.mesh.cells;
        let (centre, radius) = (self.mesh.centre, 0.5 * self.mesh.diameter);
        assembly.add_to(FLAG, [outwards, across], [Some("cylinder"), None, None, None], |[s, t]| {
            let (y, part) = (self.across(t), self.outwards.first(s));
            let circle = centre[0] + (radius.powi(2) - (y - centre[1]).powi(2)).sqrt();
            [(1.0 - part) * circle + part * self.end, y]
        });
    }

    /// The rows behind the rectangle: below, in and above the height of the flag, along it and behind it.
    fn add_rows(&self, assembly: &mut Assembly) {
        let (flag_end, [length, height]) = (self.mesh.flag_end, self.mesh.extent);
        let FlagCells { beside, along, across, after, .. } = self.mesh.cells;
        let [low, high] = self.mesh.flag_heights();
        let below = |t: f64| low * (1.0 - self.below.without_last(t));
        let within = |t: f64| self.across(t);
        let above = |t: f64| high * (1.0 - self.above.first(t)) + height * self.above.first(t);
        let on_flag = |s: f64| {
            let part = s / along as f64;
            self.end * (1.0 - part) + flag_end * part
        };
        let behind = |s: f64| flag_end * (1.0 - self.after.first(s)) + length * self.after.first(s);
        let rows: [(usize, Line<'_>, [Option<&str>; 2], &str); 3] = [
            (beside, &below, [Some("bottom"), None], FLUID),
            (across, &within, [None, None], FLAG),
            (beside, &above, [None, Some("top")], FLUID),
        ];
        for (cells, y, [low, high], region) in rows {
            assembly.add_to(region, [along, cells], [None, None, low, high], |[s, t]| [on_flag(s), y(t)]);
            let names = [None, Some("outflow"), low, high];
            assembly.add_to(FLUID, [after, cells], names, |[s, t]| [behind(s), y(t)]);
        }
    }

    /// The height of line `t` across the flag.
    fn across(&self, t: f64) -> f64 {
        let ([low, high], part) = (self.mesh.flag_heights(), t / self.mesh.cells.across as f64);
        low * (1.0 - part) + high * part
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn the_flag_and_the_fluid_fill_the_channel() {
        for order in [2, 3, 5, 8] {
            let mesh = ChannelFlagMesh::turek_hron(order).build().unwrap();
            assert_eq!(mesh.n_cells(), 6 * (3 * 6 + 2 * 6 + 2) + (8 + 14) * (2 * 6 + 2));
            assert_eq!(mesh.boundary_names(), ["cylinder", "bottom", "inflow", "top", "outflow"]);
            let [flag, fluid] = [FLAG, FLUID].map(|name| mesh.part(&[name]).unwrap());
            assert_eq!(flag.mesh.boundary_names(), ["cylinder", FLUID]);
            assert_eq!(fluid.mesh.boundary_names(), ["cylinder", "bottom", "inflow", "top", "outflow", FLAG]);
            assert_eq!(flag.mesh.n_cells(), 2 * (6 + 8));
            let nodes = mesh.interface(&flag, &fluid, order).unwrap();
            assert_eq!(nodes.len(), (2 * (6 + 8) + 2) * (order - 1) + 1);
            if order >= 5 {
                // The flag ends on the circle: up to there it is shorter than from the centre.
                let (h, r) = (0.01_f64, 0.05_f64);
                let hidden = h * (r * r - h * h).sqrt() + r * r * (h / r).asin();
                assert!((flag.mesh.volume() / (0.02 * 0.4 - hidden) - 1.0).abs() < 1e-9);
                assert!((mesh.volume() / (2.5 * 0.41 - 0.0025 * PI) - 1.0).abs() < 1e-8);
            }
        }
    }

    #[test]
    fn boundaries_lie_where_their_names_say() {
        let mesh = ChannelFlagMesh::turek_hron(4).build().unwrap();
        for part in [&mesh, &mesh.part(&[FLAG]).unwrap().mesh] {
            for facet in part.boundary_facets() {
                for [x, y] in part.face_positions(facet.side) {
                    let distance = match &part.boundary_names()[facet.boundary][..] {
                        "inflow" => x,
                        "outflow" => x - 2.5,
                        "bottom" => y,
                        "top" => y - 0.41,
                        FLUID => ((y - 0.2).abs() - 0.01).abs().min((x - 0.6).abs()),
                        _ => (x - 0.2).hypot(y - 0.2) - 0.05,
                    };
                    assert!(distance.abs() < 1e-13, "{x} {y}");
                }
            }
        }
    }

    #[test]
    fn impossible_flags_are_refused() {
        let flag = ChannelFlagMesh::turek_hron(2);
        let refused = |mesh: ChannelFlagMesh| mesh.build().unwrap_err().to_string();
        assert!(refused(ChannelFlagMesh { thickness: 0.1, ..flag }).contains("the thickness of the flag is 0.1"));
        assert!(refused(ChannelFlagMesh { flag_end: 0.4, ..flag }).contains("the end of the flag is 0.4"));
        assert!(refused(ChannelFlagMesh { flag_end: 2.5, ..flag }).contains("the end of the flag is 2.5"));
        assert!(refused(ChannelFlagMesh { flag_cell: 0.3, ..flag }).contains("beside the flag is 0.3"));
        assert!(refused(ChannelFlagMesh { first_cell: 0.2, ..flag }).contains("the first cell is 0.2"));
        // It left cells without height beside it.
        let all = flag.gap().unwrap();
        assert!(refused(ChannelFlagMesh { first_cell: all, ..flag }).contains("the height of the first cell"));
        assert!(refused(ChannelFlagMesh { centre: [0.04, 0.2], ..flag }).contains("x of the centre"));
        assert!(refused(ChannelFlagMesh { centre: [0.2, f64::NAN], ..flag }).contains("y of the centre"));
        let cells = FlagCells { along: 0, ..flag.cells };
        assert!(refused(ChannelFlagMesh { cells, ..flag }).contains("along the flag is 0"));
    }
}
