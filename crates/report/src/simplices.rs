//! Cells cut into simplices, and simplices cut by a surface.

/// The edges of a simplex on which `height` changes its sign, each from the corner below 0 to the one above, and the
/// position of the zero as a fraction. For each corner below come all corners above. So of four crossings, 0, 1, 2 and 1, 2,
/// 3 are triangles.
pub fn crossings(corners: &[usize], height: impl Fn(usize) -> f64) -> Vec<(usize, usize, f64)> {
    let (below, above): (Vec<usize>, Vec<usize>) = corners.iter().partition(|&&corner| height(corner) < 0.0);
    let edge = |a: usize, b: usize| (a, b, height(a) / (height(a) - height(b)));
    below.iter().flat_map(|&a| above.iter().map(move |&b| (a, b))).map(|(a, b)| edge(a, b)).collect()
}

/// The lattice with `parts` parts along each axis, cut into simplices (Kuhn), given by their D + 1 corners. For every order
/// of the axes there is the path along them from the lowest to the highest corner of each part.
pub fn simplices<const D: usize>(parts: usize) -> Vec<Vec<usize>> {
    (0..parts.pow(D as u32)).flat_map(|part| of_part::<D>(parts, part)).collect()
}

/// Those of the parts in which `heights`, the numbers at the points of the lattice, have both signs.
pub fn crossed_simplices<const D: usize>(parts: usize, heights: &[f64]) -> Vec<Vec<usize>> {
    let crossed = |part: &usize| {
        let lowest = lowest::<D>(parts, *part);
        let corner = |k: usize| lowest + (0..D).map(|axis| (k >> axis & 1) * stride(parts, axis)).sum::<usize>();
        let below = (0..1 << D).filter(|&k| heights[corner(k)] < 0.0).count();
        0 < below && below < 1 << D
    };
    (0..parts.pow(D as u32)).filter(crossed).flat_map(|part| of_part::<D>(parts, part)).collect()
}

/// The distance of neighbours along an axis in the numbering of points.
fn stride(parts: usize, axis: usize) -> usize {
    (parts + 1).pow(axis as u32)
}

/// The corner of a part with the smallest coordinates.
fn lowest<const D: usize>(parts: usize, part: usize) -> usize {
    (0..D).map(|axis| part / parts.pow(axis as u32) % parts * stride(parts, axis)).sum()
}

/// The simplices of a part.
fn of_part<const D: usize>(parts: usize, part: usize) -> impl Iterator<Item = Vec<usize>> {
    let orders: &[&[usize]] = match D {
        2 => &[&[0, 1], &[1, 0]],
        _ => &[&[0, 1, 2], &[0, 2, 1], &[1, 0, 2], &[1, 2, 0], &[2, 0, 1], &[2, 1, 0]],
    };
    let lowest = lowest::<D>(parts, part);
    orders.iter().map(move |order| {
        let mut corners = vec![lowest];
        order.iter().for_each(|&axis| corners.push(corners[corners.len() - 1] + stride(parts, axis)));
        corners
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossed_simplices_are_all_that_a_plane_meets() {
        let height = |p: usize| {
            [p % 6, p / 6 % 6, p / 36].iter().zip([0.3, -0.2, 0.5]).map(|(x, n)| *x as f64 * n).sum::<f64>() - 1.1
        };
        let heights: Vec<f64> = (0..216).map(height).collect();
        let meets = |corners: &Vec<usize>| !crossings(corners, |corner| heights[corner]).is_empty();
        let met = |simplices: Vec<Vec<usize>>| simplices.into_iter().filter(meets).collect::<Vec<_>>();
        let (all, crossed) = (simplices::<3>(5), crossed_simplices::<3>(5, &heights));
        assert!(crossed.len() < all.len() / 2 && !crossed.is_empty());
        assert_eq!(met(all), met(crossed));
    }
}
