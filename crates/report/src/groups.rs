//! Groups of history columns that share a chart.

use super::html::capitalised;
use tensor::AXES;

/// The scale of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Equal distances are equal differences.
    Linear,
    /// Equal distances are equal ratios; of negative values the magnitude is shown.
    Logarithmic,
}

/// Columns that share a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Their title.
    pub title: String,
    /// The columns, and their labels in the chart.
    pub series: Vec<(String, String)>,
    /// The scale of the vertical axis.
    pub scale: Scale,
    /// Whether the columns describe solver and mesh, not the flow or a structure.
    pub of_solver: bool,
}

/// A chart of columns of solver and mesh: title, scale, columns and their labels.
type SolverChart = (&'static str, Scale, &'static [(&'static str, &'static str)]);

const SOLVER_CHARTS: [SolverChart; 10] = [
    (
        "Residual of a slab",
        Scale::Logarithmic,
        &[("residual_initial", "from the predictor"), ("residual", "at the end")],
    ),
    ("Iterations per slab", Scale::Linear, &[("newton", "Newton"), ("krylov", "Krylov")]),
    ("Elasticity: CG iterations per slab", Scale::Linear, &[("elasticity_iterations", "CG")]),
    (
        "Quality of the mesh, worst cell of a slab",
        Scale::Linear,
        &[
            ("det_j_lower_bound", "det J / det J\u{2080}, proved bound"),
            ("det_j_sampled_min", "det J / det J\u{2080}, smallest sample"),
            ("scaled_jacobian", "scaled Jacobian"),
        ],
    ),
    ("Mass", Scale::Linear, &[("mass", "in the domain")]),
    ("Mass error, magnitude", Scale::Logarithmic, &[("mass_error", "relative to the start")]),
    ("Energy error, magnitude", Scale::Logarithmic, &[("energy_error", "of the balance")]),
    ("Jump of the flow between slabs", Scale::Logarithmic, &[("jump", "L\u{b2} norm, scaled")]),
    ("Length of a slab", Scale::Linear, &[("dt", "\u{394}t")]),
    (
        "Repairs per slab",
        Scale::Linear,
        &[("preconditioner_builds", "preconditioner made anew"), ("rejected", "attempts rejected")],
    ),
];

/// Words for the kind of a quantity, singular and plural: quantities of one kind and wall share a chart.
const KINDS: [(&str, &str); 18] = [
    ("force", "forces"),
    ("reaction", "reactions"),
    ("coefficient", "coefficients"),
    ("power", "power and heat flow"),
    ("heat_flow", "power and heat flow"),
    ("energy", "energies"),
    ("flow_work", "work and losses since the start"),
    ("drive_work", "work and losses since the start"),
    ("force_work", "work and losses since the start"),
    ("damped", "work and losses since the start"),
    ("numerical_dissipation", "work and losses since the start"),
    ("displacement", "displacement"),
    ("impulse_in_slab", "impulses of a slab"),
    ("work_in_slab", "work and heat of a slab"),
    ("heat_in_slab", "work and heat of a slab"),
    ("impulse", "impulses since the start"),
    ("total_work", "work and heat since the start"),
    ("total_heat", "work and heat since the start"),
];

/// All charts of a history: first coefficients, forces and columns unknown to this table, then solver and mesh. `boundaries` are possible
/// first parts of column names.
pub fn groups(columns: &[String], boundaries: &[String]) -> Vec<Group> {
    let known =
        |column: &str| SOLVER_CHARTS.iter().any(|(_, _, series)| series.iter().any(|(name, _)| *name == column));
    let mut groups: Vec<Group> = Vec::new();
    for column in columns.iter().filter(|column| *column != "t" && !known(column)) {
        let (title, label) = title_and_label(column, boundaries);
        let series = (column.clone(), label);
        match groups.iter_mut().find(|group| group.title == title) {
            Some(group) => group.series.push(series),
            None => groups.push(Group { title, series: vec![series], scale: Scale::Linear, of_solver: false }),
        }
    }
    // Stable: otherwise in the order of the columns.
    groups.sort_by_key(|group| !group.title.ends_with("coefficients"));
    groups.extend(SOLVER_CHARTS.iter().filter_map(|known| known_group(known, columns)));
    groups
}

fn known_group((title, scale, series): &SolverChart, columns: &[String]) -> Option<Group> {
    let present = series.iter().filter(|(name, _)| columns.iter().any(|column| column == name));
    let series: Vec<_> = present.map(|(name, label)| (name.to_string(), label.to_string())).collect();
    (!series.is_empty()).then(|| Group { title: title.to_string(), series, scale: *scale, of_solver: true })
}

/// The chart of a column, and its label there: `foil_pressure_force_x` is `pressure force x` in `foil: forces`.
fn title_and_label(column: &str, boundaries: &[String]) -> (String, String) {
    let begins = |name: &&String| column.strip_prefix(name.as_str()).is_some_and(|rest| rest.starts_with('_'));
    let wall = boundaries.iter().filter(begins).max_by_key(|name| name.len());
    let quantity = wall.map_or(column, |wall| &column[wall.len() + 1..]);
    let stem = without_axis(quantity);
    let of_kind = |(kind, _): &&(&str, &str)| stem == *kind || stem.ends_with(&format!("_{kind}"));
    let kind = KINDS.iter().find(of_kind).map_or(stem, |(_, several)| several);
    let words = |name: &str| name.replace('_', " ");
    let title = match wall {
        Some(wall) => format!("{wall}: {}", words(kind)),
        None => capitalised(&words(kind)),
    };
    (title, words(quantity))
}

/// A name without the axis or number at its end.
fn without_axis(name: &str) -> &str {
    match name.rsplit_once('_') {
        Some((stem, end)) if AXES.contains(&end) || end.parse::<usize>().is_ok() => stem,
        _ => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_column_but_the_time_is_drawn_once() {
        let columns: Vec<String> = [
            "t",
            "dt",
            "det_j_lower_bound",
            "scaled_jacobian",
            "newton",
            "krylov",
            "residual",
            "foil_force_x",
            "foil_force_y",
            "foil_pressure_force_x",
            "foil_power",
            "foil_heat_flow",
            "foil_tail_force_x",
            "kinetic_energy",
            "strain_energy",
            "mode_1",
            "mode_2",
            "foil_drag_coefficient",
            "something_new",
        ]
        .map(str::to_owned)
        .to_vec();
        let groups = groups(&columns, &["foil".to_owned(), "foil_tail".to_owned()]);
        let mut drawn: Vec<&String> =
            groups.iter().flat_map(|group| group.series.iter().map(|(name, _)| name)).collect();
        let mut all: Vec<&String> = columns.iter().skip(1).collect();
        drawn.sort();
        all.sort();
        assert_eq!(drawn, all);
        let titles: Vec<&str> = groups.iter().map(|group| group.title.as_str()).collect();
        assert_eq!(
            titles[..7],
            [
                "foil: coefficients",
                "foil: forces",
                "foil: power and heat flow",
                "foil_tail: forces",
                "Energies",
                "Mode",
                "Something new"
            ]
        );
        assert_eq!(groups[1].series[2], ("foil_pressure_force_x".to_owned(), "pressure force x".to_owned()));
        let of_solver: Vec<&str> =
            groups.iter().filter(|group| group.of_solver).map(|group| &group.title[..]).collect();
        assert_eq!(of_solver[..2], ["Residual of a slab", "Iterations per slab"]);
        assert_eq!(
            groups.iter().position(|group| group.of_solver),
            Some(groups.len() - of_solver.len()),
            "they come last"
        );
    }
}
