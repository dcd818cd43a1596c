//! The choice of windows: the bodies, every wall by itself, the whole domain.

use super::bounds::Extent;
use super::snapshot::Snapshot;
use super::track::Track;
use super::wall::Wall;
use super::window::Window;

/// Pixels of a picture of the bodies, of the whole domain beside it, and of the domain if there are no bodies.
const PIXELS: [f64; 3] = [420e3, 160e3, 420e3];

/// Pixels of all pictures of single walls together. A page has room for a few millions of pixels per step.
const PIXELS_OF_WALLS: f64 = 480e3;

/// A boundary shorter than this fraction of the domain is a body in it.
const BODY: f64 = 0.5;

/// The margins around the bodies as fractions of their length; larger at the sides, because screens are wide.
const MARGIN: [f64; 2] = [0.9, 0.45];

/// The margins around the middle of a wall that is no body, as fractions of its length.
const MARGIN_OF_LONG_WALL: [f64; 2] = [0.1, 0.05];

/// Bodies that move by less than this part of their length do not need a window that moves with them.
const VISIBLE: f64 = 0.02;

/// Two windows are the same if they share this part of their areas.
const ALIKE: f64 = 0.75;

/// The windows on a domain: close to all bodies, moving with them, close to every wall that these do not show, and the whole domain.
/// Boundaries count as bodies by their size; those that are not `known` to be walls only if they lie inside. `walls` that are no bodies get
/// a window only if they are known.
pub fn windows<const D: usize>(domain: Extent, walls: &[Wall], known: bool, snapshots: &[Snapshot<D>]) -> Vec<Window> {
    let extents: Vec<Extent> = walls.iter().map(|wall| wall.extent).collect();
    let bodies = bodies(domain, &extents).into_iter().filter(|&body| known || is_inside(domain, extents[body]));
    let bodies: Vec<&Wall> = bodies.map(|body| &walls[body]).collect();
    let whole = |pixels| Window::new("whole domain", domain, pixels);
    let mut windows = near_all(domain, &bodies, snapshots);
    let none = windows.is_empty();
    if none {
        windows.push(whole(PIXELS[2]));
    }
    if known || bodies.len() > 1 {
        let single = walls.iter().filter(|wall| known || bodies.iter().any(|body| body.name == wall.name));
        windows.extend(near_each(domain, single, snapshots, &windows));
    }
    windows.extend((!none).then(|| whole(PIXELS[1])));
    windows
}

/// The boundaries that are bodies in a domain, given their boxes; none if they surround the domain together.
pub fn bodies(domain: Extent, boundaries: &[Extent]) -> Vec<usize> {
    let bodies: Vec<usize> = (0..boundaries.len()).filter(|&boundary| is_body(domain, boundaries[boundary])).collect();
    let all = bodies.iter().fold(Extent::EMPTY, |all, &body| all.union(boundaries[body]));
    if all.length() > BODY * domain.length() { Vec::new() } else { bodies }
}

fn is_body(domain: Extent, boundary: Extent) -> bool {
    !boundary.is_empty() && boundary.length() < BODY * domain.length()
}

/// Whether a boundary touches no side of the domain.
fn is_inside(domain: Extent, boundary: Extent) -> bool {
    let margin = 1e-6 * domain.length();
    (0..2).all(|i| boundary.lower[i] > domain.lower[i] + margin && boundary.upper[i] < domain.upper[i] - margin)
}

/// The window close to all bodies, and the one that moves with them, if they move visibly.
fn near_all<const D: usize>(domain: Extent, bodies: &[&Wall], snapshots: &[Snapshot<D>]) -> Vec<Window> {
    let near = bodies.iter().fold(Extent::EMPTY, |near, body| near.union(body.extent));
    if near.is_empty() {
        return Vec::new();
    }
    let fixed = Window::new("near the walls", around(near).intersection(domain), PIXELS[0]);
    let facets = bodies.iter().flat_map(|body| body.facets.iter().copied()).collect();
    [fixed].into_iter().chain(following("moving with the walls", facets, snapshots, PIXELS[0])).collect()
}

/// The windows close to single walls that no window among `there` shows as closely.
fn near_each<'w, const D: usize>(
    domain: Extent,
    walls: impl Iterator<Item = &'w Wall>,
    snapshots: &[Snapshot<D>],
    there: &[Window],
) -> Vec<Window> {
    let mut found: Vec<Window> = Vec::new();
    for wall in walls.filter(|wall| !wall.extent.is_empty()) {
        let window = near_one(domain, wall, snapshots);
        let alike = |other: &Window| other.follows.is_some() == window.follows.is_some() && alike(other, &window);
        if !there.iter().chain(&found).any(alike) {
            found.push(window);
        }
    }
    let pixels = (PIXELS_OF_WALLS / found.len().max(1) as f64).min(PIXELS[1]);
    found.iter().map(|window| window.with_pixels(pixels)).collect()
}

/// The window close to a wall. It moves with a body that moves. Of a wall along the domain it shows the middle.
fn near_one<const D: usize>(domain: Extent, wall: &Wall, snapshots: &[Snapshot<D>]) -> Window {
    let label = format!("near {}", wall.name);
    if is_body(domain, wall.extent) {
        let following = following(&format!("moving with {}", wall.name), wall.facets.clone(), snapshots, PIXELS[1]);
        let fixed = || Window::new(&label, around(wall.extent).intersection(domain), PIXELS[1]);
        return following.unwrap_or_else(fixed);
    }
    let margin = MARGIN_OF_LONG_WALL.map(|part| part * wall.extent.length());
    // The wider margin lies along the wall.
    let [x, y] = wall.extent.size();
    let margin = if x < y { [margin[1], margin[0]] } else { margin };
    Window::new(&label, wall.middle.grown(margin).intersection(domain), PIXELS[1])
}

/// The window that moves with the faces `facets` of bodies, if they move visibly.
fn following<const D: usize>(
    label: &str,
    facets: Vec<[usize; 2]>,
    snapshots: &[Snapshot<D>],
    pixels: f64,
) -> Option<Window> {
    let track = Track::new(facets, snapshots.first()?);
    let shifts: Vec<[f64; 2]> = snapshots.iter().map(|snapshot| track.shift(snapshot)).collect();
    let boxes = snapshots.iter().zip(&shifts).map(|(snapshot, by)| track.extent(snapshot).shifted([-by[0], -by[1]]));
    let at_first = boxes.fold(Extent::EMPTY, Extent::union);
    let farthest = shifts.iter().map(|by| by[0].hypot(by[1])).fold(0.0, f64::max);
    let window = || Window { follows: Some(track), ..Window::new(label, around(at_first), pixels) };
    (farthest > VISIBLE * at_first.length()).then(window)
}

fn around(bodies: Extent) -> Extent {
    bodies.grown(MARGIN.map(|part| part * bodies.length()))
}

/// Whether two windows share most of what they show.
fn alike(a: &Window, b: &Window) -> bool {
    let area = |extent: Extent| if extent.is_empty() { 0.0 } else { extent.size()[0] * extent.size()[1] };
    let common = area(a.extent.intersection(b.extent));
    common > ALIKE * (area(a.extent) + area(b.extent) - common)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wall(name: &str, extent: Extent) -> Wall {
        Wall { name: name.into(), facets: vec![], extent, middle: Extent::of([extent.centre()]) }
    }

    fn of(domain: Extent, walls: &[Wall], known: bool) -> Vec<Window> {
        windows::<2>(domain, walls, known, &[])
    }

    fn labels(windows: &[Window]) -> Vec<&str> {
        windows.iter().map(|window| &window.label[..]).collect()
    }

    fn square(half: f64) -> Extent {
        Extent { lower: [-half; 2], upper: [half; 2] }
    }

    #[test]
    fn a_body_in_a_wide_domain_is_not_a_dot() {
        let body = Extent { lower: [0.0, -0.06], upper: [1.0, 0.06] };
        for known in [false, true] {
            let walls = [wall("far", square(100.0)), wall("body", body)];
            let found = of(square(100.0), &walls[usize::from(known)..], known);
            assert_eq!(labels(&found), ["near the walls", "whole domain"]);
            let [chord, total] = [1.0 * found[0].scale(), found[0].width as f64];
            assert!(chord > 0.3 * total, "{chord} of {total} pixels");
        }
    }

    #[test]
    fn boundaries_around_the_domain_are_no_bodies() {
        let bottom = Extent { lower: [-1.0, -1.0], upper: [1.0, -1.0] };
        assert_eq!(
            labels(&of(square(1.0), &[wall("bottom", bottom), wall("all", square(1.0))], false)),
            ["whole domain"]
        );
    }

    /// The clamped end of a beam is no body.
    #[test]
    fn a_side_of_the_domain_is_no_body() {
        let domain = Extent { lower: [0.0, 0.0], upper: [8.0, 1.0] };
        let end = [wall("clamp", Extent { lower: [0.0, 0.0], upper: [0.0, 1.0] })];
        assert_eq!(labels(&of(domain, &end, false)), ["whole domain"]);
        assert_eq!(labels(&of(domain, &end, true)), ["near the walls", "whole domain"]);
    }

    /// Two cylinders, a distant one and a channel: each wall fills a large part of a window that has its name.
    #[test]
    fn every_wall_has_a_window() {
        let domain = Extent { lower: [0.0, 0.0], upper: [20.0, 8.0] };
        let disc = |x: f64| Extent { lower: [x - 0.2, 3.8], upper: [x + 0.2, 4.2] };
        let plate = |y: f64| Extent { lower: [0.0, y], upper: [20.0, y] };
        let walls =
            [wall("first", disc(3.0)), wall("second", disc(17.0)), wall("top", plate(8.0)), wall("low", plate(0.0))];
        let found = of(domain, &walls, true);
        assert_eq!(labels(&found), ["whole domain", "near first", "near second", "near top", "near low"]);
        for (wall, window) in walls.iter().zip(&found[1..]) {
            let seen = window.extent.intersection(wall.extent);
            assert!(!seen.is_empty() && seen.length() > 0.25 * window.extent.length(), "{}: {seen:?}", wall.name);
            assert!(window.extent.length() < 0.25 * domain.length(), "{}: {:?}", wall.name, window.extent);
        }
        let pixels: usize = found[1..].iter().map(|window| window.width * window.height).sum();
        assert!((pixels as f64) < 1.05 * PIXELS_OF_WALLS, "{pixels}");
    }

    #[test]
    fn neighbours_have_a_common_window_and_their_own() {
        let disc = |x: f64| Extent { lower: [x - 0.5, -0.5], upper: [x + 0.5, 0.5] };
        let found = of(square(100.0), &[wall("left", disc(-3.0)), wall("right", disc(3.0))], true);
        assert_eq!(labels(&found), ["near the walls", "near left", "near right", "whole domain"]);
        // The two sides of one body need one window.
        let side = |y: f64| Extent { lower: [-1.0, y - 0.05], upper: [1.0, y + 0.05] };
        let found = of(square(100.0), &[wall("upper", side(0.05)), wall("lower", side(-0.05))], true);
        assert_eq!(labels(&found), ["near the walls", "whole domain"]);
    }
}
