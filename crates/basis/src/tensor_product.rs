//! Matrices along the axes of a batched tensor.
//!
//! A tensor of `components` lies as `[component][axis D-1]...[axis 0]`, axis 0 fastest. With the value matrix of a
//! basis on every axis [`apply_all_axes`] interpolates to the points of a tensor rule. With the transposed matrices it
//! integrates against the test functions. The gradient along axis a takes the derivative matrix on axis a and value
//! matrices on the others.
//!
//! A quadrature rule with at least as many points as the basis has nodes allows a cheaper way, which is exact too: interpolate first, then
//! differentiate at the points. That takes one [`contract`] with the derivative matrix of the Lagrange polynomials of the points.

use crate::{AlongAxis, Matrix, contract};
use pulp::Simd;
use tensor::Pack;

/// A matrix along every axis, for each component of a batched tensor.
#[derive(Clone, Copy, Debug)]
pub struct AllAxes<'m, 'a> {
    /// M_a on axis a.
    pub matrices: &'m [&'a Matrix],
    /// The number of components.
    pub components: usize,
}

/// output = (M_{D-1} x ... x M_0) input for each component, D >= 1. With `add` the result is added to `output`.
///
/// `input` holds components * prod cols packs, `output` components * prod rows, `scratch` at least [`scratch_length`].
pub fn apply_all_axes<S: Simd>(
    simd: S,
    axes: AllAxes<'_, '_>,
    input: &[Pack],
    output: &mut [Pack],
    scratch: &mut [Pack],
    add: bool,
) {
    if let Some((last, input)) = all_but_last_axis(simd, axes, input, scratch) {
        contract(simd, last, input, output, add);
    }
}

/// Applies all matrices but the last. Returns the last one and its input.
fn all_but_last_axis<'a, S: Simd>(
    simd: S,
    AllAxes { matrices, components }: AllAxes<'_, 'a>,
    mut input: &'a [Pack],
    mut scratch: &'a mut [Pack],
) -> Option<(AlongAxis<'a>, &'a [Pack])> {
    let (last, others) = matrices.split_last()?;
    let mut inner = 1;
    for (axis, matrix) in others.iter().enumerate() {
        let outer = components * matrices[axis + 1..].iter().map(|m| m.cols()).product::<usize>();
        let (output, rest) = scratch.split_at_mut(outer * matrix.rows() * inner);
        contract(simd, AlongAxis { matrix, outer, inner }, input, output, false);
        inner *= matrix.rows();
        (input, scratch) = (output, rest);
    }
    Some((AlongAxis { matrix: last, outer: components, inner }, input))
}

/// The number of packs that [`apply_all_axes`] needs as scratch.
pub fn scratch_length(matrices: &[&Matrix], components: usize) -> usize {
    let after = |axes: usize| -> usize {
        let extent = |(a, m): (usize, &&Matrix)| if a < axes { m.rows() } else { m.cols() };
        components * matrices.iter().enumerate().map(extent).product::<usize>()
    };
    (1..matrices.len()).map(after).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{self, OnEveryMachine};
    use crate::{Lagrange, Rule, gauss};
    use tensor::{WIDTH, zeroed};

    /// (0.3 + axis + 0.7 x)^3 + c and its derivative: a cubic that differs from axis to axis.
    fn cubic(axis: usize, c: f64, x: f64) -> [f64; 2] {
        let y = 0.3 + axis as f64 + 0.7 * x;
        [y * y * y + c, 2.1 * y * y]
    }
    /// The product of the cubics, differentiated along `differentiated` if there is one; different in every component
    /// and lane.
    fn polynomial(differentiated: Option<usize>, component: usize, lane: usize, x: &[f64]) -> f64 {
        let c = 0.1 * lane as f64 - component as f64;
        let factor = |axis: usize| cubic(axis, c, x[axis])[usize::from(differentiated == Some(axis))];
        (0..x.len()).map(factor).product()
    }

    /// f(component, lane, x) at the lattice of the points of each axis, axis 0 fastest.
    fn sample(axes: &[&[f64]], components: usize, f: impl Fn(usize, usize, &[f64]) -> f64) -> Vec<Pack> {
        let count: usize = axes.iter().map(|points| points.len()).product();
        let mut packs = zeroed(components * count);
        for k in 0..components * count {
            let mut rest = k % count;
            let coordinate = |points: &&[f64]| {
                let x = points[rest % points.len()];
                rest /= points.len();
                x
            };
            let x: Vec<f64> = axes.iter().map(coordinate).collect();
            for lane in 0..WIDTH {
                packs[k].0[lane] = f(k / count, lane, &x);
            }
        }
        packs
    }

    struct Interpolation<'a>(Vec<&'a Matrix>, usize, Vec<Pack>);
    impl OnEveryMachine for Interpolation<'_> {
        fn run<S: Simd>(&self, simd: S) -> Vec<Pack> {
            let Interpolation(matrices, components, input) = self;
            let mut output = zeroed(components * matrices.iter().map(|m| m.rows()).product::<usize>());
            let mut scratch = zeroed(scratch_length(matrices, *components));
            let axes = AllAxes { matrices, components: *components };
            apply_all_axes(simd, axes, input, &mut output, &mut scratch, false);
            output
        }
    }

    /// Orders and rules that differ from axis to axis.
    fn bases() -> ([Lagrange; 3], [Rule; 3]) {
        ([4, 5, 6].map(Lagrange::gauss_lobatto), [7, 5, 6].map(gauss))
    }

    #[test]
    fn values_and_gradients_of_polynomials_in_every_dimension() {
        let (bases, rules) = bases();
        for dimension in 1..=3 {
            let nodes: Vec<&[f64]> = bases[..dimension].iter().map(|b| b.nodes()).collect();
            let points: Vec<&[f64]> = rules[..dimension].iter().map(|r| r.points.as_slice()).collect();
            let values: Vec<Matrix> = (0..dimension).map(|a| bases[a].value_matrix(points[a])).collect();
            let input = sample(&nodes, 2, |c, lane, x| polynomial(None, c, lane, x));
            let exact = sample(&points, 2, |c, lane, x| polynomial(None, c, lane, x));
            testing::on_every_machine(&Interpolation(values.iter().collect(), 2, input.clone()), &exact, 1e-12);
            for axis in 0..dimension {
                let slope = bases[axis].derivative_matrix(points[axis]);
                let matrices = (0..dimension).map(|a| if a == axis { &slope } else { &values[a] }).collect();
                let exact = sample(&points, 2, |c, lane, x| polynomial(Some(axis), c, lane, x));
                testing::on_every_machine(&Interpolation(matrices, 2, input.clone()), &exact, 1e-11);
            }
        }
    }

    struct AtPoints(usize, Matrix, Vec<usize>, Vec<Pack>);
    impl OnEveryMachine for AtPoints {
        fn run<S: Simd>(&self, simd: S) -> Vec<Pack> {
            let AtPoints(axis, matrix, extents, input) = self;
            let mut output = zeroed(input.len());
            let along = AlongAxis::new(matrix, *axis, extents, 2);
            contract(simd, along, input, &mut output, false);
            let fresh = output.clone();
            contract(simd, along, input, &mut output, true);
            (0..output.len()).for_each(|i| (0..WIDTH).for_each(|lane| output[i].0[lane] -= fresh[i].0[lane]));
            output
        }
    }

    #[test]
    fn differentiating_at_the_points_is_exact_too() {
        let (_, rules) = bases();
        let points: Vec<&[f64]> = rules.iter().map(|r| r.points.as_slice()).collect();
        let input = sample(&points, 2, |c, lane, x| polynomial(None, c, lane, x));
        for axis in 0..3 {
            let slope = Lagrange::new(points[axis].to_vec()).derivative_matrix(points[axis]);
            let exact = sample(&points, 2, |c, lane, x| polynomial(Some(axis), c, lane, x));
            testing::on_every_machine(&AtPoints(axis, slope, vec![7, 5, 6], input.clone()), &exact, 1e-11);
        }
    }

    struct Adjoint<'a>(Vec<&'a Matrix>, Vec<Pack>);
    impl OnEveryMachine for Adjoint<'_> {
        /// Twice into the same output: A^T y + A^T y.
        fn run<S: Simd>(&self, simd: S) -> Vec<Pack> {
            let Adjoint(matrices, input) = self;
            let mut output = zeroed(matrices.iter().map(|m| m.rows()).product());
            let mut scratch = zeroed(scratch_length(matrices, 1));
            let axes = AllAxes { matrices, components: 1 };
            apply_all_axes(simd, axes, input, &mut output, &mut scratch, true);
            apply_all_axes(simd, axes, input, &mut output, &mut scratch, true);
            output
        }
    }

    /// int l_j over the cube, from the transposed value matrices and the weights at the points, is the weight of the
    /// Gauss-Lobatto rule.
    #[test]
    fn transposed_matrices_integrate_against_the_basis() {
        let (bases, rules) = bases();
        let transposed: Vec<Matrix> = (0..3).map(|a| bases[a].value_matrix(&rules[a].points).transpose()).collect();
        let weights: Vec<&[f64]> = rules.iter().map(|r| r.weights.as_slice()).collect();
        let lobatto: Vec<Rule> = [4, 5, 6].map(crate::gauss_lobatto).into();
        let expected: Vec<&[f64]> = lobatto.iter().map(|r| r.weights.as_slice()).collect();
        let product = |w: &[f64]| w.iter().product::<f64>();
        let input = sample(&weights, 1, |_, lane, w| lane as f64 * product(w));
        let exact = sample(&expected, 1, |_, lane, w| 2.0 * lane as f64 * product(w));
        testing::on_every_machine(&Adjoint(transposed.iter().collect(), input), &exact, 1e-13);
    }
}
