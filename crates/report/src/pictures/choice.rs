//! The field and the window of a movie or a picture, by their names.

use super::bounds::{Cuboid, Extent};
use super::cuts;
use super::error::PictureError;
use super::medium::PictureMedium;
use super::plane::Plane;
use super::quantity::PictureQuantity;
use super::view::View;
use super::window::Window;
use output::ResultReader;
use tensor::AXES;

/// Pixels of a window that is given by a box or a plane.
const PIXELS: f64 = 420e3;

/// A field to draw.
pub struct PictureField {
    /// The quantity.
    pub quantity: PictureQuantity,
    /// What it is made with.
    pub medium: PictureMedium,
    /// The label of its colours; `None` for that of the quantity.
    pub label: Option<String>,
}

/// The name of the first field of the page.
pub fn first_field(reader: &ResultReader) -> &'static str {
    let arrays: Vec<&str> = reader.layout.exact.iter().map(|array| &array.name[..]).collect();
    PictureQuantity::of(arrays.contains(&"flow"), &arrays)[0].name()
}

/// The field of a name: a quantity, or else a formula of the case.
///
/// # Errors
/// A name that is not known.
pub fn field(reader: &ResultReader, name: &str) -> Result<PictureField, PictureError> {
    let arrays: Vec<&str> = reader.layout.exact.iter().map(|array| &array.name[..]).collect();
    let known = PictureQuantity::of_movies(arrays.contains(&"flow"), &arrays);
    if let Some(quantity) = known.iter().find(|quantity| quantity.name() == name).copied() {
        let medium = if quantity.needs_case() { PictureMedium::full(reader) } else { PictureMedium::simple(reader) };
        return Ok(PictureField { quantity, medium: medium?, label: None });
    }
    let mut accepted: Vec<String> = known.iter().map(|quantity| quantity.name().to_owned()).collect();
    match PictureMedium::full(reader) {
        Ok(medium) => match medium.formulas.iter().position(|formula| formula.name == name) {
            Some(number) => {
                let quantity = PictureQuantity::Formula(number);
                return Ok(PictureField { quantity, medium, label: Some(name.to_owned()) });
            }
            None => accepted.extend(medium.formulas.into_iter().map(|formula| formula.name)),
        },
        // The name may be that of a formula.
        Err(PictureError::Case(problem)) => {
            accepted.push(format!("formulas of the case, which cannot be read: {problem}"))
        }
        Err(error) => return Err(error),
    }
    Err(PictureError::NoField { name: name.to_owned(), accepted })
}

/// The window of a name, of a box `x0,y0,x1,y1`, or in three dimensions of a plane such as `x=0.5` or `cut x`, the middle position of the
/// page. Without a name the first one.
///
/// # Errors
/// An unknown name.
pub fn window<const D: usize>(view: &View<D>, name: Option<&str>) -> Result<Window, PictureError> {
    let Some(name) = name else { return named(&view.windows, None, D) };
    let plane = || {
        let near = view.near?;
        let plane = plane(name).map(|plane| inside(plane, view.mesh));
        let plane = plane.or_else(|| cuts::middle(near, name.strip_prefix("cut ")?))?;
        Some(Window { label: name.to_owned(), ..cuts::window(near, plane, PIXELS) })
    };
    let within = || Some(Window { plane: view.plane, ..Window::new(name, extent(name)?, PIXELS) });
    if misses::<D>(name, view.mesh) {
        let [lower, upper] = [view.mesh.lower, view.mesh.upper].map(|corner| corner[..D].to_vec());
        return Err(PictureError::Outside { name: name.to_owned(), lower, upper });
    }
    plane().or_else(within).map_or_else(|| named(&view.windows, Some(name), D), Ok)
}

/// Whether the plane or the box of this name shows no part of a mesh in the box `mesh`.
fn misses<const D: usize>(name: &str, mesh: Cuboid) -> bool {
    let mut shown = Cuboid { lower: [f64::NEG_INFINITY; 3], upper: [f64::INFINITY; 3] };
    if let Some(plane) = plane(name).filter(|plane| plane.axis < D) {
        (shown.lower[plane.axis], shown.upper[plane.axis]) = (plane.at, plane.at);
    }
    if let Some(extent) = extent(name) {
        shown.lower[..2].copy_from_slice(&extent.lower);
        shown.upper[..2].copy_from_slice(&extent.upper);
    }
    shown.intersection(mesh).is_empty()
}

/// The plane, moved into the box `mesh` by round-off where it is on its lower side: cells are cut if a part of them lies below.
fn inside(plane: Plane, mesh: Cuboid) -> Plane {
    let [lower, upper] = [mesh.lower, mesh.upper].map(|corner| corner[plane.axis]);
    let lowest = lower + 1e-9 * (upper - lower);
    if plane.at < lowest { Plane { at: lowest, ..plane } } else { plane }
}

/// The window of a name, or the first one.
fn named(windows: &[Window], name: Option<&str>, dimension: usize) -> Result<Window, PictureError> {
    let found = windows.iter().find(|window| name.is_none_or(|name| window.label == name)).cloned();
    let accepted = || {
        let planes = ["cut x", "cut y", "cut z", "a plane such as \"z=0.5\""].into_iter().filter(|_| dimension == 3);
        let others = ["a box such as \"-1,-1,3,1\""].into_iter().chain(planes);
        windows.iter().map(|window| &window.label[..]).chain(others).map(str::to_owned).collect()
    };
    found.ok_or_else(|| PictureError::NoWindow { name: name.unwrap_or_default().to_owned(), accepted: accepted() })
}

/// The box `x0,y0,x1,y1`.
fn extent(name: &str) -> Option<Extent> {
    let numbers: Vec<f64> = name.split(',').map(|word| word.trim().parse().ok()).collect::<Option<_>>()?;
    let [x0, y0, x1, y1] = numbers[..] else { return None };
    let edges = [x1 - x0, y1 - y0];
    let good = edges.iter().all(|edge| edge.is_finite() && *edge > 0.0);
    good.then_some(Extent { lower: [x0, y0], upper: [x1, y1] })
}

/// The plane `x=0.5`.
fn plane(name: &str) -> Option<Plane> {
    let (axis, at) = name.split_once('=')?;
    let axis = AXES.iter().position(|name| *name == axis.trim())?;
    let at = at.trim().parse().ok().filter(|at: &f64| at.is_finite())?;
    Some(Plane { axis, at })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// The pictures were empty.
    #[test]
    fn a_window_beside_the_mesh_is_refused() {
        let mesh = Cuboid { lower: [0.0; 3], upper: [1.0, 2.0, 3.0] };
        let misses = |name| super::misses::<3>(name, mesh);
        assert!(misses("x=2") && misses("100,100,101,101") && misses("-2,-2,-1,5"));
        assert!(!misses("z=2") && !misses("-1e300,-1,0.5,1") && !misses("whole domain"));
        let square = Cuboid { lower: [0.0; 3], upper: [1.0, 1.0, 0.0] };
        assert!(!super::misses::<2>("z=2", square), "it has no plane");
    }

    #[test]
    fn a_window_that_is_not_there_is_refused_with_the_others() {
        let extent = Extent { lower: [0.0; 2], upper: [1.0; 2] };
        let windows = ["near the walls", "whole domain"].map(|label| Window::new(label, extent, 100.0));
        assert_eq!(named(&windows, None, 2).unwrap().label, "near the walls");
        assert_eq!(named(&windows, Some("whole domain"), 2).unwrap().label, "whole domain");
        let message = named(&windows, Some("whole"), 2).unwrap_err().to_string();
        let expected =
            "there is no window `whole`; accepted: near the walls, whole domain, a box such as \"-1,-1,3,1\"";
        assert_eq!(message, expected);
        assert!(named(&windows, Some("whole"), 3).unwrap_err().to_string().ends_with("a plane such as \"z=0.5\""));
    }

    #[test]
    fn boxes_and_planes_are_read() {
        assert_eq!(extent("-2, -4,14,4"), Some(Extent { lower: [-2.0, -4.0], upper: [14.0, 4.0] }));
        for wrong in ["0,0,1", "0,0,1,1,2", "0,0,0,1", "1,0,0,1", "0,0,1,inf", "0,0,1,nan", "a,0,1,1"] {
            assert_eq!(extent(wrong), None, "{wrong}");
        }
        assert_eq!(plane("y = -0.5"), Some(Plane { axis: 1, at: -0.5 }));
        assert!(["w=1", "x", "x=", "x=nan", "=1"].iter().all(|wrong| plane(wrong).is_none()));
    }
}
