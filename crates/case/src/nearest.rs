//! The known name that a misspelt one probably meant.

/// What other programs call conditions and functions of this one, and what is near another name than the one that was meant: a supersonic outflow is an
/// `outflow`, not a `supersonic_inflow`.
const OTHER_NAMES: [(&str, &str); 12] = [
    ("supersonic_outflow", "outflow"),
    ("subsonic_outflow", "outflow"),
    ("pressure_outlet", "outflow"),
    ("outlet", "outflow"),
    ("subsonic_inflow", "inflow"),
    ("inlet", "inflow"),
    ("no_slip", "adiabatic_wall"),
    ("no_slip_wall", "adiabatic_wall"),
    ("ln", "log"),
    ("arcsin", "asin"),
    ("arccos", "acos"),
    ("arctan", "atan"),
];

/// The candidate that `name` means elsewhere, or the one with the smallest edit distance, if it is close enough.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let candidates: Vec<&str> = candidates.into_iter().collect();
    let other = OTHER_NAMES.iter().find(|(other, _)| *other == name).map(|(_, meant)| *meant);
    let meant = candidates.iter().copied().find(|candidate| Some(*candidate) == other);
    meant.or_else(|| closest(name, &candidates))
}

fn closest<'a>(name: &str, candidates: &[&'a str]) -> Option<&'a str> {
    let accepted = (name.chars().count() / 3).max(1);
    let distance = |candidate: &str| edit_distance(&name.to_lowercase(), &candidate.to_lowercase());
    candidates
        .iter()
        .copied()
        .map(|candidate| (distance(candidate), candidate))
        .min_by_key(|(distance, _)| *distance)
        .filter(|(distance, candidate)| *distance <= accepted && *distance < candidate.chars().count())
        .map(|(_, candidate)| candidate)
}

/// Insertions, deletions, replacements and exchanges of neighbours that turn `a` into `b` (optimal string alignment).
fn edit_distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    // rows[i][j]: the distance of the first i characters of a from the first j of b.
    let mut rows = vec![vec![0; b.len() + 1]; a.len() + 1];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            rows[i][j] = if i == 0 || j == 0 {
                i + j
            } else {
                let replaced = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
                let shortest = replaced.min(rows[i - 1][j] + 1).min(rows[i][j - 1] + 1);
                let exchanged = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
                if exchanged { shortest.min(rows[i - 2][j - 2] + 1) } else { shortest }
            };
        }
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_counts_of_single_edits() {
        for (a, b, distance) in
            [("", "abc", 3), ("order", "order", 0), ("ordr", "order", 1), ("oredr", "order", 1), ("roe", "hllc", 4)]
        {
            assert_eq!(edit_distance(a, b), distance, "{a} {b}");
            assert_eq!(edit_distance(b, a), distance, "{b} {a}");
        }
    }

    #[test]
    fn only_what_is_close_is_suggested() {
        let boundaries = ["left", "right", "bottom", "top"];
        assert_eq!(nearest("rihgt", boundaries), Some("right"));
        assert_eq!(nearest("Left", boundaries), Some("left"));
        assert_eq!(nearest("wall", boundaries), None);
        assert_eq!(nearest("q", ["x", "y"]), None);
    }

    /// The nearest name was `supersonic_inflow`.
    #[test]
    fn names_of_other_programs_are_known() {
        let conditions = ["inflow", "supersonic_inflow", "outflow", "slip_wall", "adiabatic_wall"];
        assert_eq!(nearest("supersonic_outflow", conditions), Some("outflow"));
        assert_eq!(nearest("no_slip_wall", conditions), Some("adiabatic_wall"));
        assert_eq!(nearest("supersonic_outflow", ["left"]), None);
    }
}
