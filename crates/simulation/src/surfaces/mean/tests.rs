//! Means over time and span of a wall, their errors, and the zeros of its friction.

#![allow(clippy::unwrap_used)]

use super::*;
use output::ArraySpec;
use std::f64::consts::TAU;

/// A closed curve of `count` facets.
fn ring(count: usize) -> Curve {
    Curve { facets: (0..count).collect(), jumps: vec![[0.0; 2]; count], is_closed: true }
}

/// The section of [`circle`].
fn section(dimension: usize) -> Section {
    let (count, spans) = (40, if dimension == 2 { 1 } else { 3 });
    let rows = (0..count).map(|row| (0..spans).map(|span| row + span * count).collect()).collect();
    let lengths = if dimension == 2 { Vec::new() } else { vec![[0.0; 2]; count] };
    Section { curves: vec![ring(count)], rows, lengths }
}

/// A circle of radius 1 in a flow from the left: friction along increasing angle is -`amplitude` sin(angle), around 1 +- 0.1 in time.
fn circle(dimension: usize) -> Series {
    let count = 40;
    let width = columns(dimension).iter().map(|column| column.components).sum();
    let spans = if dimension == 2 { 1 } else { 3 };
    let array = ArraySpec::new("surface_wall", &[("facet", count), ("point", spans), ("column", width)]);
    let at = |time: f64, number: usize| -> Vec<f64> {
        let (s, span) = (((number % count) as f64 + 0.5) / count as f64, number / count);
        let (sin, cos) = (TAU * s).sin_cos();
        let friction = -sin * (1.0 + 0.1 * (TAU * time).sin());
        let mut row = if dimension == 2 { vec![s, TAU * s, cos, sin] } else { vec![s, cos, sin, span as f64] };
        // The normal out of the gas points to the centre; the tangent is (-sin, cos).
        row.extend([-cos, -sin].into_iter().chain((dimension == 3).then_some(0.0)));
        row.extend([1.0 + span as f64, 5.0 + span as f64, cos]);
        row.extend([0.0, 0.0].into_iter().chain((dimension == 3).then_some(0.0)));
        row.extend([-sin * friction, cos * friction].into_iter().chain((dimension == 3).then_some(0.0)));
        row.extend([friction.abs(), 0.0, 1.0]);
        row
    };
    let times: Vec<f64> = (0..=32).map(|k| f64::from(k) / 8.0).collect();
    let values = times.iter().flat_map(|&time| (0..spans * count).flat_map(move |number| at(time, number))).collect();
    Series { array, times, values }
}

fn lines(directory: &Path, file: &str) -> Vec<String> {
    let text = std::fs::read_to_string(directory.join(file)).unwrap();
    text.lines().map(str::to_owned).collect()
}

#[test]
fn means_over_time_and_span_have_zeros_where_the_flow_attaches_and_separates() {
    for dimension in [2, 3] {
        let directory = tempfile::tempdir().unwrap();
        // Whole periods.
        let wall = MeansOf { series: &circle(dimension), section: &section(dimension), slips: false };
        assert!(write_means(directory.path(), dimension, &wall, [1.0, 4.0]).unwrap());
        let mean = lines(directory.path(), "surface_wall_mean.csv");
        assert_eq!(mean.len(), 41);
        assert!(mean[0].starts_with("s,x,y,pressure,pressure_coefficient,skin_friction,"), "{}", mean[0]);
        for line in &mean[1..] {
            let row: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
            let pressure = if dimension == 2 { 5.0 } else { (5.0 + 2.0 * 6.0 + 3.0 * 7.0) / 6.0 };
            assert!((row[3] - pressure).abs() < 1e-12 && (row[4] - (TAU * row[0]).cos()).abs() < 1e-12, "{line}");
            assert!((row[5] + (TAU * row[0]).sin()).abs() < 1e-12, "{line}");
        }
        let zeros = lines(directory.path(), "surface_wall_separation.csv");
        assert_eq!(zeros.len(), 3, "{zeros:?}");
        let parts: Vec<Vec<&str>> = zeros[1..].iter().map(|line| line.split(',').collect()).collect();
        // Wind from the left: it attaches at the angle pi, and leaves at 0, where s begins.
        assert_eq!([parts[0][0], parts[1][0]], ["attachment", "separation"]);
        let s: f64 = parts[0][1].parse().unwrap();
        assert!((s - 0.5).abs() < 1e-12, "{s}");
    }
}

/// Rows at x = 0.5, 1.5, ... with this skin friction.
fn rows_of(frictions: &[f64]) -> Vec<Row> {
    let row = |(k, friction): (usize, &f64)| Row {
        place: k as f64 + 0.5,
        position: [k as f64 + 0.5, 0.0],
        area: 1.0,
        means: from_fn(|number| if number == SKIN_FRICTION { *friction } else { 0.0 }),
        errors: [0.0; QUANTITIES.len()],
    };
    frictions.iter().enumerate().map(row).collect()
}

/// A zero was found between the last point of a curve and the first one of the next.
#[test]
fn no_zero_lies_between_two_curves_and_each_closed_one_is_closed_by_itself() {
    let rows = rows_of(&[1.0, 1.0, -1.0, -1.0, 1.0, -3.0, -3.0, -3.0]);
    let open = |count| Curve { is_closed: false, ..ring(count) };
    let zeros = |curves: &[Curve]| -> Vec<(&str, f64)> {
        let parts = parts(&rows, curves, false);
        parts.iter().flat_map(Part::zeros).map(|zero| (zero.kind, zero.place)).collect()
    };
    assert_eq!(zeros(&[open(2), open(2), open(4)]), [("separation", 4.75)]);
    // From 7.5 over the end at 8, which is the start at 4, to 4.5.
    assert_eq!(zeros(&[open(2), open(2), ring(4)]), [("separation", 4.75), ("attachment", 4.25)]);
}

/// The position was half-way between both ends of the domain.
#[test]
fn zeros_across_a_periodic_boundary_have_a_position_at_it() {
    let rows = rows_of(&[-1.0, -1.0, 1.0]);
    let mut curve = ring(3);
    curve.jumps[0] = [-3.0, 0.0];
    let zeros = parts(&rows, &[curve], false)[0].zeros();
    assert_eq!((zeros[1].kind, zeros[1].position), ("separation", [3.0, 0.0]));
}

/// Snapshots at the ends of adapted slabs, and an interval that ends between them: a linear quantity has its exact mean.
#[test]
fn snapshots_count_by_the_time_between_them() {
    let times = [0.0, 0.1, 0.3, 1.0, 1.1, 2.0, 2.1, 2.2, 2.3, 4.0];
    for interval in [[0.0, 4.0], [0.05, 3.0], [-1.0, 9.0]] {
        let weights = TimeWeights::new(&times, interval).unwrap();
        let (from, to) = (interval[0].max(0.0), interval[1].min(4.0));
        let mean = |weights: &[f64]| {
            let sum: f64 = weights.iter().zip(times).map(|(weight, time)| weight * (1.0 + 2.0 * time)).sum();
            sum / weights.iter().sum::<f64>()
        };
        assert!((mean(&weights.whole) - (1.0 + from + to)).abs() < 1e-14);
        assert!((weights.whole.iter().sum::<f64>() - (to - from)).abs() < 1e-14);
        let parts: Vec<f64> = weights.parts.unwrap().iter().map(|weights| mean(weights)).collect();
        assert!((parts.iter().sum::<f64>() / 8.0 - (1.0 + from + to)).abs() < 1e-14, "{parts:?}");
    }
}

/// One distribution inside the interval was called the mean over it, and with none inside there was no mean.
#[test]
fn an_interval_between_distributions_has_its_mean() {
    let times = [0.7, 1.4, 2.1, 2.8];
    let mean = |interval: [f64; 2]| {
        let weights = TimeWeights::new(&times, interval)?;
        assert!(weights.parts.is_none());
        let sum: f64 = weights.whole.iter().zip(times).map(|(weight, time)| weight * (1.0 + time)).sum();
        Some(sum / weights.whole.iter().sum::<f64>())
    };
    for (interval, expected) in [([1.0, 1.9], 2.45), ([1.0, 1.3], 2.15), ([0.0, 1.0], 1.85)] {
        assert!((mean(interval).unwrap() - expected).abs() < 1e-14, "{interval:?}");
    }
    // One distribution alone was called the mean, up to round-off the last of these too.
    for interval in [[0.0, 0.6], [2.9, 9.0], [2.8, 9.0], [0.0, 0.7], [0.0, 0.7 + 1e-16]] {
        assert_eq!(mean(interval), None, "{interval:?}");
    }
    for times in [&[1.0, 1.0][..], &[1.0], &[]] {
        assert!(TimeWeights::new(times, [0.0, 2.0]).is_none(), "{times:?}");
    }
}

/// A wall along which the gas slips had separations where its friction of 1e-33 changes its sign.
#[test]
fn nothing_separates_where_the_gas_slips() {
    let directory = tempfile::tempdir().unwrap();
    let wall = MeansOf { series: &circle(2), section: &section(2), slips: true };
    assert!(write_means(directory.path(), 2, &wall, [1.0, 4.0]).unwrap());
    assert_eq!(lines(directory.path(), "surface_wall_mean.csv").len(), 41);
    assert!(!directory.path().join("surface_wall_separation.csv").exists());
}

#[test]
fn errors_need_eight_times_and_vanish_for_a_steady_flow() {
    assert_eq!(half_width(&[2.0; PARTS]), 0.0);
    let spread = half_width(&[1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0]);
    assert!((spread - STUDENT * (8.0_f64 / 7.0 / 8.0).sqrt()).abs() < 1e-14);
}

/// Friction that is zero exactly at a row had no zero.
#[test]
fn a_zero_at_a_row_is_found_once() {
    let row = |k: usize, friction: f64| {
        let mut means = [0.0; QUANTITIES.len()];
        means[SKIN_FRICTION] = friction;
        Row { place: 0.1 * k as f64, position: [k as f64, 0.0], area: 1.0, means, errors: [0.0; QUANTITIES.len()] }
    };
    let found = |frictions: [f64; 3], kind: &str| {
        let rows: Vec<Row> = frictions.iter().enumerate().map(|(k, friction)| row(k, *friction)).collect();
        let zeros: Vec<Zero> = rows.windows(2).filter_map(|pair| zero(&pair[0], &pair[1], [0.0; 2], 1.0)).collect();
        let [zero] = &zeros[..] else { panic!("{} zeros of {frictions:?}", zeros.len()) };
        assert!(zero.kind == kind && zero.position == [1.0, 0.0], "{frictions:?}");
    };
    found([1e-3, 0.0, -1e-3], "separation");
    found([-1e-3, 0.0, 1e-3], "attachment");
    found([1e-200, 0.0, -1e-200], "separation");
    assert!(zero(&row(0, f64::NAN), &row(1, 1.0), [0.0; 2], 1.0).is_none());
}

/// With points at the ends of facets, the front of a cylinder was at s = 1 instead of 0.5.
#[test]
fn a_zero_between_two_rows_at_one_place_stays_there() {
    let mut rows = rows_of(&[-1.0, -1.0, 1.0, 1.0]);
    let places = [0.25, 0.500_000_000_000_000_1, 0.5, 0.75];
    rows.iter_mut().zip(places).for_each(|(row, place)| row.place = place);
    let zeros = parts(&rows, &[ring(4)], true)[0].zeros();
    assert_eq!(zeros[0].kind, "attachment");
    assert!((zeros[0].place - 0.5).abs() < 1e-15, "{}", zeros[0].place);
}

/// The lengths weighted the times.
#[test]
fn a_wall_that_becomes_longer_has_its_mean_over_time() {
    let (directory, mut series) = (tempfile::tempdir().unwrap(), circle(2));
    let (len, width) = (series.array.len(), series.array.axes[2].length);
    for (values, time) in series.values.chunks_exact_mut(len).zip(&series.times) {
        // Area and pressure.
        values.chunks_exact_mut(width).for_each(|row| (row[6], row[7]) = (1.0 + time, *time));
    }
    let wall = MeansOf { series: &series, section: &section(2), slips: false };
    assert!(write_means(directory.path(), 2, &wall, [1.0, 4.0]).unwrap());
    for line in &lines(directory.path(), "surface_wall_mean.csv")[1..] {
        let pressure: f64 = line.split(',').nth(3).unwrap().parse().unwrap();
        assert!((pressure - 2.5).abs() < 1e-12, "{line}");
    }
}
