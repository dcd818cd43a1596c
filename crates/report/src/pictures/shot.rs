//! A frame of a movie: the picture with its title, its colours and their numbers.

use super::animation::MovieFormat;
use super::canvas::Canvas;
use super::colour::Colour;
use super::drawn::Drawn;
use super::encode::{COLOURS, palette};
use super::indexed::IndexedColours;
use super::lettering::{self, write};
use super::lines::LineLayer;
use super::quantity::{PictureQuantity, Range};
use super::window::Window;
use crate::axis::linear_ticks;
use crate::html::{texts_on_scale, with_digits};

/// What a movie or a picture shows.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scenario<'a> {
    /// The name of the field; empty for the first one of the page.
    pub field: &'a str,
    /// The window: its name in the page, a box `x0,y0,x1,y1`, or in three dimensions a plane such as `z=0.5`. Without it the first window is shown.
    pub window: Option<&'a str>,
    /// The Q of the surfaces in space, if it is given.
    pub q_level: Option<f64>,
    /// The values at the ends of the colours, if they are given.
    pub range: Option<[f64; 2]>,
    /// Pixels per row, if they are given.
    pub width: Option<usize>,
    /// Whether the edges of the cells are left out.
    pub without_edges: bool,
    /// The kind of the file.
    pub format: MovieFormat,
}

/// All that the frames of a movie have in common.
pub struct Shot {
    /// The name of the case.
    pub title: String,
    /// The field and the range of its colours.
    pub quantity: (PictureQuantity, Range),
    /// The name of the field.
    pub label: String,
    /// The window.
    pub window: Window,
    /// Whether the edges of the cells are left out.
    pub without_edges: bool,
}

/// The darkness of the edges of cells.
const EDGES: f64 = 0.5;

/// Texts.
const INK: [u8; 3] = [0; 3];

/// The height of capitals as a fraction of the width of the picture, and its limits in pixels.
const LETTERS: f64 = 0.018;
const SMALLEST: f64 = 8.0;
const LARGEST: f64 = 16.0;

/// A text, where it begins and where it stands.
type Text = (String, [f64; 2]);

impl Shot {
    /// A frame.
    pub fn frame(&self, drawn: &Drawn, time: f64) -> Canvas {
        let Window { width, height, .. } = self.window;
        let mut canvas = Canvas::new(width, self.header() + height + self.footer(), [255; 3]);
        self.paint(&mut canvas, drawn);
        let mut texts = self.heading(time);
        texts.extend(self.legend(&mut canvas));
        let mut ink = LineLayer { width, height: canvas.height, coverage: vec![0.0; width * canvas.height] };
        for (text, at) in &texts {
            write(&mut ink, text, *at, self.letters());
        }
        canvas.cover(&ink, 0, INK, 1.0);
        canvas
    }

    /// The colours that frames are reduced to.
    pub fn colours(&self) -> IndexedColours {
        IndexedColours::new(self.quantity.0.colours(), self.ground())
    }

    /// The colour where nothing is drawn.
    fn ground(&self) -> Colour {
        self.quantity.0.ground().unwrap_or([255; 3])
    }

    /// The height of capitals.
    fn letters(&self) -> f64 {
        (LETTERS * self.window.width as f64).clamp(SMALLEST, LARGEST).round()
    }

    /// Rows above the picture.
    fn header(&self) -> usize {
        (2.4 * self.letters()) as usize
    }

    /// Rows below the picture.
    fn footer(&self) -> usize {
        (6.0 * self.letters()) as usize
    }

    /// The field, the boundaries, the edges of the cells.
    fn paint(&self, canvas: &mut Canvas, drawn: &Drawn) {
        let (width, top) = (self.window.width, self.header());
        let (quantity, _) = self.quantity;
        let colours = palette(quantity.colours());
        let ground = self.ground();
        for (pixel, &number) in drawn.numbers[0].iter().enumerate() {
            let colour = if number == 0 { ground } else { colours[usize::from(number)] };
            canvas.set(pixel % width, top + pixel / width, colour);
        }
        if !self.without_edges {
            canvas.cover(&drawn.mesh, top, INK, EDGES);
        }
        canvas.cover(&drawn.outline, top, drawn.outline_colour, 1.0);
    }

    /// The name of the case on the left, as much of it as has room, and the time on the right.
    fn heading(&self, time: f64) -> Vec<Text> {
        let (size, width) = (self.letters(), self.window.width as f64);
        let y = 1.7 * size;
        // The room of the time does not depend on its digits, so it does not tremble.
        let right = (width - lettering::width("t = 0.0000", size)).max(0.0);
        let mut title = self.title.clone();
        while lettering::width(&title, size) > right && title.pop().is_some() {}
        vec![(title, [0.5 * size, y]), (format!("t = {}", with_digits(time, 4)), [right, y])]
    }

    /// Draws the colours below the picture; the name of the field, and the numbers that have room.
    fn legend(&self, canvas: &mut Canvas) -> Vec<Text> {
        let (size, width) = (self.letters(), self.window.width);
        let (quantity, range) = self.quantity;
        let (colours, left, bar) = (palette(quantity.colours()), width / 6, width - 2 * (width / 6));
        let below = (self.header() + self.window.height) as f64;
        let top = (below + 2.4 * size) as usize;
        let rows = size as usize;
        let place = |value: f64| left as f64 + (value - range.lower) / (range.upper - range.lower) * bar as f64;
        for k in 0..bar * rows {
            canvas.set(left + k % bar, top + k / bar, colours[1 + k % bar * COLOURS / bar]);
        }
        let centred = |text: String, at: f64, y: f64| {
            let x = at - 0.5 * lettering::width(&text, size);
            (text, [x, y])
        };
        let mut texts = vec![centred(self.label.clone(), 0.5 * width as f64, below + 1.8 * size)];
        for (value, text) in numbers_with_room(range, bar as f64, size) {
            (0..rows / 3).for_each(|row| canvas.set(place(value) as usize, top + rows + row, INK));
            texts.push(centred(text, place(value), top as f64 + 2.7 * size));
        }
        texts
    }
}

/// Round values in a range with their texts: fewer, if they would overlap on a bar of this length in pixels.
fn numbers_with_room(range: Range, bar: f64, size: f64) -> Vec<(f64, String)> {
    let ticks = linear_ticks(range.lower, range.upper);
    let texts = texts_on_scale(&ticks, 3);
    let widest = texts.iter().map(|text| lettering::width(text, size)).fold(0.0, f64::max) + size;
    let apart = ticks.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let stride = (widest / (apart / (range.upper - range.lower) * bar)).ceil().max(1.0) as usize;
    ticks.into_iter().zip(texts).step_by(stride).collect()
}

#[cfg(test)]
mod tests {
    use super::super::bounds::Extent;
    use super::super::lines::LineLayer;
    use super::*;
    use case::Field;

    fn shot(title: &str, without_edges: bool) -> Shot {
        Shot {
            title: title.to_owned(),
            quantity: (PictureQuantity::Flow(Field::Mach), Range { lower: 0.0, upper: 0.4 }),
            label: "Mach number".to_owned(),
            window: Window::new("", Extent { lower: [0.0; 2], upper: [1.0; 2] }, 300.0 * 300.0),
            without_edges,
        }
    }

    /// A picture of one colour with one line across it.
    fn drawn(window: &Window) -> Drawn {
        let mut mesh = LineLayer::new(window);
        mesh.draw(window, [[0.0, 0.5], [1.0, 0.5]], 2.0, 1.0);
        Drawn {
            numbers: vec![vec![COLOURS as u8; window.width * window.height]],
            extremes: vec![None],
            mesh,
            outline: LineLayer::new(window),
            outline_colour: [0; 3],
            strongest: 1.0,
        }
    }

    /// The darkest pixel in some rows of a frame.
    fn darkest(frame: &Canvas, rows: std::ops::Range<usize>) -> u8 {
        frame.pixels[3 * rows.start * frame.width..3 * rows.end * frame.width].iter().copied().min().unwrap_or(255)
    }

    #[test]
    fn a_frame_has_a_title_edges_and_a_legend() {
        let with = shot("vortex", false);
        let frame = with.frame(&drawn(&with.window), 0.5);
        let (header, height) = (with.header(), with.window.height);
        assert_eq!((frame.width, frame.height), (with.window.width, header + height + with.footer()));
        assert!(darkest(&frame, 0..header) < 100, "the title");
        assert!(darkest(&frame, header + height..frame.height) < 100, "the legend");
        let middle = header + height / 2;
        let without = shot("vortex", true);
        let plain = without.frame(&drawn(&without.window), 0.5);
        assert!(darkest(&frame, middle - 2..middle + 2) < darkest(&plain, middle - 2..middle + 2), "the edge");
    }

    #[test]
    fn a_title_leaves_room_for_the_time() {
        let texts = |title: &str| shot(title, true).heading(0.125);
        assert_eq!(texts("vortex")[0].0, "vortex");
        let long = texts(&"m".repeat(100));
        let end = long[0].1[0] + lettering::width(&long[0].0, shot("", true).letters());
        assert!(long[0].0.len() > 10 && end < long[1].1[0] + 8.0, "{long:?}");
        assert_eq!(long[1].0, "t = 0.125");
    }

    #[test]
    fn numbers_of_a_legend_do_not_overlap() {
        let range = Range { lower: -1.0, upper: 1.0 };
        let count = |bar: f64| numbers_with_room(range, bar, 10.0).len();
        assert_eq!(count(400.0), 5);
        assert!(count(100.0) < 5 && count(100.0) > 1 && count(1.0) == 1);
    }
}
