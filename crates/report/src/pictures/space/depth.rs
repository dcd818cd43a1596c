//! Pictures of surfaces in space: at every pixel the nearest one.

use super::camera::Camera;
use super::surface::TriangleSurface;
use crate::pictures::encode::{WALL, colour_numbers};
use crate::pictures::lines::LineLayer;
use crate::pictures::quantity::Range;
use crate::pictures::raster::{centres, cross};
use crate::pictures::window::Window;
use tensor::{dot, norm};

/// The darkness of a surface along which the light falls.
pub const DARKEST: f64 = 0.6;

/// Nearness, darkness and values of the nearest surface at each pixel.
pub struct DepthRaster {
    width: usize,
    height: usize,
    quantities: usize,
    /// How near the surface is. Pixels without a surface have the lowest number.
    nearness: Vec<f64>,
    /// 0 for a surface across the light, [`DARKEST`] for one along it.
    darkness: Vec<f32>,
    /// `[row][column][quantity]`, the first row on top; NaN on walls.
    values: Vec<f32>,
}

/// The corners of a triangle in the picture.
struct Corners<'a> {
    pixels: [[f64; 2]; 3],
    nearness: [f64; 3],
    normals: [[f64; 3]; 3],
    values: [&'a [f64]; 3],
}

impl DepthRaster {
    /// An empty picture of `window`.
    pub fn new(window: &Window, quantities: usize) -> Self {
        let Window { width, height, .. } = *window;
        let pixels = width * height;
        DepthRaster {
            width,
            height,
            quantities,
            nearness: vec![f64::NEG_INFINITY; pixels],
            darkness: vec![0.0; pixels],
            values: vec![f32::NAN; pixels * quantities],
        }
    }

    /// A quantity at all pixels, row by row. Pixels without a surface have NaN.
    pub fn of(&self, quantity: usize) -> impl Iterator<Item = f32> + '_ {
        self.values.iter().skip(quantity).step_by(self.quantities).copied()
    }

    /// The colour numbers of a quantity, with those of walls.
    pub fn numbers(&self, quantity: usize, range: Range) -> Vec<u8> {
        let mut numbers = colour_numbers(self.of(quantity), range);
        for (number, nearness) in numbers.iter_mut().zip(&self.nearness) {
            if *number == 0 && *nearness > f64::NEG_INFINITY {
                *number = WALL;
            }
        }
        numbers
    }

    /// The darkness of all pixels, as a layer above the colours.
    pub fn shadows(&self) -> LineLayer {
        LineLayer { width: self.width, height: self.height, coverage: self.darkness.clone() }
    }

    /// Draws a surface; what is nearer remains.
    pub fn draw(&mut self, window: &Window, camera: &Camera, surface: &TriangleSurface) {
        for triangle in &surface.triangles {
            let points = triangle.map(|corner| surface.points[corner]);
            let normals = triangle.map(|corner| surface.normals[corner]);
            let normal = std::array::from_fn(|i| normals.iter().map(|n| n[i]).sum());
            if surface.one_sided && !camera.sees(&normal) {
                continue;
            }
            let corners = Corners {
                pixels: points.map(|x| window.pixel(camera.project(&x))),
                nearness: points.map(|x| camera.nearness(&x)),
                normals,
                values: triangle.map(|corner| &surface.values[corner * self.quantities..][..self.quantities]),
            };
            self.triangle(camera, &corners);
        }
    }

    fn triangle(&mut self, camera: &Camera, corners: &Corners) {
        let x = corners.pixels;
        let area = cross(x[0], x[1], x[2]);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let columns = centres(x.map(|x| x[0]), self.width);
        for row in centres(x.map(|x| x[1]), self.height) {
            for column in columns.clone() {
                let p = [column as f64 + 0.5, row as f64 + 0.5];
                // Barycentric coordinates: area fractions opposite to the corners.
                let b = [cross(p, x[1], x[2]) / area, cross(x[0], p, x[2]) / area, cross(x[0], x[1], p) / area];
                // An edge belongs to both of its triangles, so rounding leaves no gap.
                if b.iter().all(|b| *b >= -1e-9) {
                    self.set(row * self.width + column, camera, corners, b);
                }
            }
        }
    }

    /// Sets a pixel at barycentric coordinates `b`, unless there is something nearer.
    fn set(&mut self, pixel: usize, camera: &Camera, corners: &Corners, b: [f64; 3]) {
        let nearness = dot(&b, &corners.nearness);
        if nearness <= self.nearness[pixel] {
            return;
        }
        self.nearness[pixel] = nearness;
        let normal = std::array::from_fn(|i| (0..3).map(|k| b[k] * corners.normals[k][i]).sum());
        self.darkness[pixel] = darkness(camera, &normal);
        for (q, value) in self.values[pixel * self.quantities..][..self.quantities].iter_mut().enumerate() {
            *value = (0..3).map(|k| b[k] * corners.values[k][q]).sum::<f64>() as f32;
        }
    }
}

/// Lambert's law, on both sides alike: the brightness grows with the cosine of the angle between normal and light.
fn darkness(camera: &Camera, normal: &[f64; 3]) -> f32 {
    let cosine = dot(&camera.light(), normal).abs() / norm(normal).max(f64::MIN_POSITIVE);
    (DARKEST * (1.0 - cosine.min(1.0))) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pictures::bounds::Cuboid;

    /// The square [-half, half]^2 at a height z, with normals along z and the value z.
    fn square(half: f64, z: f64) -> TriangleSurface {
        let points = [[-half, -half], [half, -half], [-half, half], [half, half]].map(|[x, y]| [x, y, z]);
        TriangleSurface {
            points: points.to_vec(),
            normals: vec![[0.0, 0.0, 1.0]; 4],
            values: vec![z; 4],
            triangles: vec![[0, 1, 2], [1, 3, 2]],
            one_sided: false,
        }
    }

    /// The picture against the axis z, 100 times 100 pixels of [-1, 1]^2.
    fn picture(surfaces: &[TriangleSurface]) -> DepthRaster {
        let camera = Camera::all()[2];
        let window = Window::new("", camera.extent(&[Cuboid { lower: [-1.0; 3], upper: [1.0; 3] }]), 1e4);
        let mut raster = DepthRaster::new(&window, 1);
        surfaces.iter().for_each(|surface| raster.draw(&window, &camera, surface));
        raster
    }

    fn count(raster: &DepthRaster, value: f32) -> usize {
        raster.of(0).filter(|other| *other == value).count()
    }

    #[test]
    fn the_nearer_surface_hides_the_other_in_any_order() {
        let (near, far) = (square(0.24, 0.5), square(0.5, -0.5));
        for surfaces in [[near.clone(), far.clone()], [far, near]] {
            let raster = picture(&surfaces);
            assert_eq!((count(&raster, 0.5), count(&raster, -0.5)), (576, 2500 - 576));
            assert_eq!(raster.of(0).filter(|value| value.is_nan()).count(), 7500);
        }
    }

    #[test]
    fn walls_are_seen_from_the_flow_alone() {
        let wall = |normal: f64| TriangleSurface {
            normals: vec![[0.0, 0.0, normal]; 4],
            values: vec![f64::NAN; 4],
            one_sided: true,
            ..square(0.5, 0.0)
        };
        let walls = |normal: f64| {
            let numbers = picture(&[wall(normal)]).numbers(0, Range { lower: 0.0, upper: 1.0 });
            numbers.iter().filter(|number| **number == WALL).count()
        };
        assert_eq!((walls(1.0), walls(-1.0)), (2500, 0));
    }

    #[test]
    fn a_surface_toward_the_light_is_bright() {
        let camera = Camera::all()[0];
        let light = camera.light();
        let across = tensor::cross(&light, &[0.0, 1.0, 0.0]);
        assert!(darkness(&camera, &light) < 1e-3 && (f64::from(darkness(&camera, &across)) - DARKEST).abs() < 1e-3);
        assert_eq!(darkness(&camera, &light), darkness(&camera, &light.map(|n| -n)));
    }
}
