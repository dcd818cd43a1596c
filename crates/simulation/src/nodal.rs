//! Values at the nodes of one cell.

/// `[component][node]` as `[node][component]`.
pub fn by_node<const D: usize>(values: &[f64]) -> Vec<f64> {
    let nodes = values.len() / D;
    (0..values.len()).map(|i| values[i % D * nodes + i / D]).collect()
}

/// `[node][component]` as `[component][node]`.
pub fn by_component<const D: usize>(values: &[f64]) -> Vec<f64> {
    (0..D).flat_map(|i| values.iter().skip(i).step_by(D).copied()).collect()
}

/// The value of a component with the coefficients that `u` begins with, where the functions are known.
pub fn dot_of(u: &[f64], functions: &[f64]) -> f64 {
    u.iter().zip(functions).map(|(u, phi)| u * phi).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_order_undoes_the_other() {
        let values: Vec<f64> = (0..12).map(f64::from).collect();
        assert_eq!(by_component::<3>(&values)[..5], [0.0, 3.0, 6.0, 9.0, 1.0]);
        assert_eq!(by_node::<3>(&by_component::<3>(&values)), values);
    }
}
