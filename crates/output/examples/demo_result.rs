//! Writes results of known polynomials and the values that a reader must find, for `scripts/check_vtk.py`:
//!
//! ```text
//! cargo run -p output --example demo_result -- DIRECTORY
//! scripts/check_vtk.py DIRECTORY/quadrilaterals/result.vtkhdf DIRECTORY/quadrilaterals/expected.json
//! scripts/check_vtk.py DIRECTORY/hexahedra/result.vtkhdf DIRECTORY/hexahedra/expected.json
//! ```

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use output::{
    ArraySpec, FieldSpec, FileLayout, Grid, Metadata, ResultFile, RunDirectory, SolverState, Step, vtk_order,
};
use serde_json::{Value, json};

const TIMES: [f64; 4] = [0.0, 0.25, 0.5, 0.8];

/// Reference points in [0, 1]^3 beside the lattice points at which the reader evaluates.
const INSIDE: [[f64; 3]; 4] = [[0.13, 0.7, 0.4], [0.9, 0.2, 0.55], [0.5, 0.5, 0.5], [0.01, 0.3, 0.98]];

/// A box of m^D cells: X in [0, 1]^D is the position at rest, third component 0 in two dimensions.
struct Demo {
    grid: Grid,
    cells_per_direction: usize,
}

impl Demo {
    fn new(dimension: usize, degree: usize, cells_per_direction: usize) -> Self {
        let cells = cells_per_direction.pow(dimension as u32);
        Self { grid: Grid { dimension, points_per_direction: degree + 1, cells }, cells_per_direction }
    }

    fn degree(&self) -> usize {
        self.grid.points_per_direction - 1
    }

    /// X of a point of a cell with reference coordinates r in [0, 1]^D.
    fn rest(&self, cell: usize, r: [f64; 3]) -> [f64; 3] {
        let m = self.cells_per_direction;
        let corner = [cell % m, cell / m % m, cell / (m * m)];
        let mut x = [0.0; 3];
        for a in 0..self.grid.dimension {
            x[a] = (corner[a] as f64 + r[a]) / m as f64;
        }
        x
    }

    /// x(X, t), of degree 3 at most in each direction.
    fn position(&self, [x, y, z]: [f64; 3], t: f64) -> [f64; 3] {
        [x + 0.1 * t * y.powi(3) + 0.2 * y * y * z, y + 0.1 * (1.0 + t) * x.powi(3), z * (1.0 + 0.3 * t * x * y)]
    }

    /// A scalar of the full degree.
    fn density(&self, [x, y, z]: [f64; 3], t: f64) -> f64 {
        let p = self.degree() as i32;
        1.0 + x.powi(p) * y - 0.5 * y.powi(p) + z.powi(p) * x + t * x * y
    }

    /// A vector; its third component is zero in two dimensions.
    fn velocity(&self, [x, y, z]: [f64; 3], t: f64) -> [f64; 3] {
        [t - y * y, x * x * x - t * z, z * (x - y)]
    }

    /// Reference coordinates of the lattice points of a cell, lexicographic.
    fn lattice(&self) -> Vec<[f64; 3]> {
        let (n, p) = (self.grid.points_per_direction, self.degree() as f64);
        let point = |q: usize| [q % n, q / n % n, q / (n * n)].map(|i| i as f64 / p);
        (0..self.grid.points_per_cell()).map(point).collect()
    }

    /// Positions at rest of all lattice points, [cell][point].
    fn all_points(&self) -> Vec<[f64; 3]> {
        let lattice = self.lattice();
        (0..self.grid.cells).flat_map(|cell| lattice.iter().map(move |&r| self.rest(cell, r))).collect()
    }

    fn layout(&self) -> FileLayout {
        let fields = vec![FieldSpec::scalar("density"), FieldSpec::vector("velocity")];
        let axes = [("cell", self.grid.cells), ("space node", self.grid.points_per_cell())];
        FileLayout { grid: self.grid, fields, exact: vec![ArraySpec::new("density", &axes)] }
    }

    fn append(&self, result: &mut ResultFile, t: f64) -> Result<(), Box<dyn Error>> {
        let rest = self.all_points();
        let points: Vec<f64> = rest.iter().flat_map(|&x| self.position(x, t)).collect();
        let density: Vec<f64> = rest.iter().map(|&x| self.density(x, t)).collect();
        let velocity: Vec<f64> = rest.iter().flat_map(|&x| self.velocity(x, t)).collect();
        let fields: [(&str, &[f64]); 2] = [("velocity", &velocity), ("density", &density)];
        Ok(result.append(&Step { time: t, points: &points, fields: &fields, exact: &[("density", &density)] })?)
    }

    /// The values that a reader must find at the lattice points and inside every cell.
    fn expected(&self) -> Value {
        let steps = TIMES.map(|t| json!({ "time": t, "samples": self.samples(t) }));
        json!({ "steps": steps, "node_orders": node_orders(self.grid.dimension) })
    }

    fn samples(&self, t: f64) -> Vec<Value> {
        let points: Vec<_> = self.lattice().into_iter().chain(INSIDE).collect();
        let sample = |cell: usize, r: [f64; 3]| {
            let x = self.rest(cell, r);
            json!({ "cell": cell, "reference": r, "point": self.position(x, t),
                    "fields": { "density": [self.density(x, t)], "velocity": self.velocity(x, t) } })
        };
        (0..self.grid.cells).flat_map(|cell| points.iter().map(move |&r| sample(cell, r))).collect()
    }

    /// Writes the steps with a checkpoint after every second one, and the expected values.
    fn write(&self, path: &Path) -> Result<(), Box<dyn Error>> {
        let directory = RunDirectory::open(path)?;
        let metadata =
            Metadata { creator: "demo_result".to_owned(), case_name: "demo".to_owned(), ..Metadata::default() };
        let mut result = ResultFile::create(&directory, self.layout(), &metadata)?;
        for pair in TIMES.chunks(2) {
            pair.iter().try_for_each(|&t| self.append(&mut result, t))?;
            result.checkpoint(&SolverState::default())?;
        }
        Ok(fs::write(path.join("expected.json"), self.expected().to_string())?)
    }
}

/// The numbering of the nodes for every number of points per direction that the program accepts.
fn node_orders(dimension: usize) -> Vec<Value> {
    let order = |points_per_direction| {
        let grid = Grid { dimension, points_per_direction, cells: 1 };
        json!({ "dimension": dimension, "points_per_direction": points_per_direction, "order": vtk_order(&grid) })
    };
    (2..=17).map(order).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let directory = PathBuf::from(std::env::args().nth(1).ok_or("usage: demo_result DIRECTORY")?);
    Demo::new(2, 4, 3).write(&directory.join("quadrilaterals"))?;
    Demo::new(3, 3, 2).write(&directory.join("hexahedra"))
}
