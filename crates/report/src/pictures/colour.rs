//! Colour maps.

/// A colour, red, green and blue.
pub type Colour = [u8; 3];

/// A colour as CSS.
pub fn css([r, g, b]: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A colour map: colours at equal distances, linear in between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColourMap {
    /// Viridis, perceptually uniform (S. van der Walt and N. Smith, matplotlib): for values from low to high.
    Sequential,
    /// Blue to red through white (C. Brewer's RdBu): for deviations from a middle value.
    Diverging,
}

const VIRIDIS: [Colour; 11] = [
    [68, 1, 84],
    [72, 36, 117],
    [65, 68, 135],
    [53, 95, 141],
    [42, 120, 142],
    [33, 145, 140],
    [34, 168, 132],
    [68, 191, 112],
    [122, 209, 81],
    [189, 223, 38],
    [253, 231, 37],
];

const RED_BLUE: [Colour; 11] = [
    [5, 48, 97],
    [33, 102, 172],
    [67, 147, 195],
    [146, 197, 222],
    [209, 229, 240],
    [247, 247, 247],
    [253, 219, 199],
    [244, 165, 130],
    [214, 96, 77],
    [178, 24, 43],
    [103, 0, 31],
];

impl ColourMap {
    /// The colours at equal distances.
    pub fn stops(self) -> &'static [Colour] {
        match self {
            ColourMap::Sequential => &VIRIDIS,
            ColourMap::Diverging => &RED_BLUE,
        }
    }

    /// The colour at the fraction `part` of the way from the low to the high end.
    pub fn at(self, part: f64) -> Colour {
        let stops = self.stops();
        let place = part.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
        let left = (place as usize).min(stops.len() - 2);
        let right = place - left as f64;
        std::array::from_fn(|i| {
            let [a, b] = [stops[left][i], stops[left + 1][i]].map(f64::from);
            (a + right * (b - a)).round() as u8
        })
    }

    /// As a CSS gradient from left to right.
    pub fn css(self) -> String {
        let stops: Vec<String> = self.stops().iter().copied().map(css).collect();
        format!("linear-gradient(to right,{})", stops.join(","))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of a colour without gamma correction, enough to compare lightness.
    fn lightness([r, g, b]: Colour) -> f64 {
        0.21 * f64::from(r) + 0.72 * f64::from(g) + 0.07 * f64::from(b)
    }

    #[test]
    fn the_sequential_map_grows_lighter_all_the_way() {
        let lightness: Vec<f64> =
            (0..=100).map(|i| lightness(ColourMap::Sequential.at(f64::from(i) / 100.0))).collect();
        assert!(lightness.is_sorted(), "{lightness:?}");
    }

    #[test]
    fn the_middle_of_the_diverging_map_is_its_lightest_colour() {
        let at = |part| lightness(ColourMap::Diverging.at(part));
        assert!((0..=100).all(|i| at(f64::from(i) / 100.0) <= at(0.5)));
        assert_eq!(ColourMap::Diverging.at(-1.0), RED_BLUE[0]);
        assert_eq!(ColourMap::Diverging.at(2.0), RED_BLUE[10]);
    }
}
