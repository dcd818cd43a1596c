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
    let orders: &[&[usize]] = match D {
        2 => &[&[0, 1], &[1, 0]],
        _ => &[&[0, 1, 2], &[0, 2, 1], &[1, 0, 2], &[1, 2, 0], &[2, 0, 1], &[2, 1, 0]],
    };
    let stride = |axis: usize| (parts + 1).pow(axis as u32);
    let lowest = |part: usize| (0..D).map(|axis| part / parts.pow(axis as u32) % parts * stride(axis)).sum::<usize>();
    let path = |start: usize, order: &[usize]| {
        let mut corners = vec![start];
        order.iter().for_each(|&axis| corners.push(corners[corners.len() - 1] + stride(axis)));
        corners
    };
    (0..parts.pow(D as u32)).flat_map(|part| orders.iter().map(move |order| path(lowest(part), order))).collect()
}
