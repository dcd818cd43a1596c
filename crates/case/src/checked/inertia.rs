//! The tensor of inertia of a rigid body.

use crate::cause::Cause;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw::{self, InertiaEntry};

/// A tensor about the centre of mass.
type Tensor = [[f64; 3]; 3];

/// Rotations about the axes of space, by their keys.
pub(super) const COMPONENTS: &str = "`rotation_x`, `rotation_y`, `rotation_z`";

/// The first rotation about an axis of space that a body has.
pub(super) fn component(raw: &raw::Body) -> Option<&'static str> {
    let given = [("rotation_x", &raw.rotation_x), ("rotation_y", &raw.rotation_y), ("rotation_z", &raw.rotation_z)];
    given.into_iter().find(|(_, freedom)| freedom.is_some()).map(|(name, _)| name)
}

/// Checks that no key describes the rotation of a body that cannot turn. `pivot` also describes how the mesh follows.
pub(super) fn check_turns(checker: &Checker<'_>, key: &Key, raw: &raw::Body) -> Checked<()> {
    if raw.rotation.is_some() || component(raw).is_some() {
        return Ok(());
    }
    let given = [
        ("moment_of_inertia", raw.moment_of_inertia.is_some()),
        ("inertia", raw.inertia.is_some()),
        ("axis", raw.axis.is_some()),
    ];
    let Some((name, _)) = given.into_iter().find(|(_, is_given)| *is_given) else { return Ok(()) };
    let problem = format!("`{name}` has no effect: the body has no coordinate that turns it");
    Err(checker.combination(
        &key.child(name),
        &problem,
        "this key together with `rotation`, for instance `rotation = {}`",
    ))
}

/// The tensor of the body at `key`. A single moment is taken about every axis; a body that cannot turn needs none.
pub(super) fn check<const D: usize>(checker: &Checker<'_>, key: &Key, raw: &raw::Body) -> Checked<Tensor> {
    match (&raw.inertia, &raw.moment_of_inertia) {
        (Some(_), Some(_)) => {
            let accepted = format!("`inertia` with {COMPONENTS}, `moment_of_inertia` with `rotation`");
            let problem = "`inertia` and `moment_of_inertia` both say how hard the body is to turn";
            Err(checker.combination(&key.child("inertia"), problem, &accepted))
        }
        (Some(_), None) if D == 2 => {
            let problem = "in two dimensions a body turns about z alone";
            Err(checker.dimension(&key.child("inertia"), problem, "`moment_of_inertia`"))
        }
        (Some(entries), None) => of_entries(checker, &key.child("inertia"), entries),
        (None, given) => of_moment(checker, key, raw, given.as_ref()),
    }
}

fn of_moment(checker: &Checker<'_>, key: &Key, raw: &raw::Body, moment: Option<&raw::Formula>) -> Checked<Tensor> {
    if let Some(name) = component(raw) {
        let problem = format!("a body with `{name}` has no tensor of inertia");
        let accepted = "`inertia`, about the centre of mass: the three numbers of its diagonal, or three rows of three";
        return Err(checker.combination(key, &problem, accepted));
    }
    let Some(moment) = moment else {
        if raw.rotation.is_some() {
            let accepted = "`moment_of_inertia`, about the axis through the centre of mass";
            return Err(checker.combination(key, "a body that rotates has no moment of inertia", accepted));
        }
        return Ok(diagonal([1.0; 3]));
    };
    let key = key.child("moment_of_inertia");
    Ok(diagonal([checker.positive(&key, "the moment of inertia", checker.number(&key, moment)?)?; 3]))
}

fn diagonal(moments: [f64; 3]) -> Tensor {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { moments[i] } else { 0.0 }))
}

fn of_entries(checker: &Checker<'_>, key: &Key, entries: &[InertiaEntry]) -> Checked<Tensor> {
    let mut rows = Vec::new();
    let mut moments = Vec::new();
    for entry in entries {
        match entry {
            InertiaEntry::Moment(moment) => moments.push(moment.clone()),
            InertiaEntry::Row(row) => rows.push(row),
        }
    }
    if rows.is_empty() {
        let moments = numbers(checker, key, &moments)?;
        for (index, moment) in moments.iter().enumerate() {
            checker.positive(&key.entry(index), &format!("the moment of inertia, {moment},"), *moment)?;
        }
        let tensor = diagonal(moments);
        return check_of_a_body(checker, key, &tensor).map(|()| tensor);
    }
    if !moments.is_empty() {
        let accepted = "three numbers, the diagonal, or three rows of three numbers";
        return Err(checker.combination(key, "numbers stand beside rows", accepted));
    }
    let rows: [&Vec<raw::Formula>; 3] = three(checker, key, &rows)?;
    let mut tensor = [[0.0; 3]; 3];
    for (index, row) in rows.into_iter().enumerate() {
        tensor[index] = numbers(checker, &key.entry(index), row)?;
    }
    check_definite(checker, key, &tensor)?;
    Ok(tensor)
}

fn three<T: Clone>(checker: &Checker<'_>, key: &Key, entries: &[T]) -> Checked<[T; 3]> {
    let length = || checker.error(key, Cause::Entries { found: entries.len(), accepted: 3 });
    <[T; 3]>::try_from(entries.to_vec()).map_err(|_| length())
}

fn numbers(checker: &Checker<'_>, key: &Key, formulas: &[raw::Formula]) -> Checked<[f64; 3]> {
    let formulas = three(checker, key, formulas)?;
    let mut numbers = [0.0; 3];
    for (index, formula) in formulas.iter().enumerate() {
        let key = key.entry(index);
        numbers[index] = checker.number(&key, formula)?;
        checker.computable(&key, "the inertia", numbers[index])?;
    }
    Ok(numbers)
}

/// The moments about two axes are together not less than that about the third: no body has another tensor.
fn check_of_a_body(checker: &Checker<'_>, key: &Key, tensor: &Tensor) -> Checked<()> {
    let [x, y, z] = std::array::from_fn(|i| tensor[i][i]);
    let quantity = format!("the tensor of inertia, with the moments {x}, {y}, {z},");
    let holds = [(x, y, z), (y, z, x), (z, x, y)].iter().all(|(a, b, c)| (a + b) * (1.0 + 1e-9) >= *c);
    let accepted = "the tensor of a body: no moment is larger than the sum of the other two";
    checker.require(key, &quantity, holds, accepted)
}

/// A tensor of inertia is symmetric, up to rounding, and positive definite: its leading minors are positive.
fn check_definite(checker: &Checker<'_>, key: &Key, tensor: &Tensor) -> Checked<()> {
    let largest = tensor.iter().flatten().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
    for (i, j) in [(1, 0), (2, 0), (2, 1)] {
        let (below, above) = (tensor[i][j], tensor[j][i]);
        let quantity = format!("{below}, where the entry on the other side of the diagonal is {above},");
        let holds = (below - above).abs() <= 1e-12 * largest;
        checker.require(&key.entry(i).entry(j), &quantity, holds, "a symmetric tensor")?;
    }
    check_of_a_body(checker, key, tensor)?;
    let minors = leading_minors(tensor);
    let quantity = format!("the tensor of inertia, with the leading minors {minors:?},");
    let accepted = "a positive definite tensor: its leading minors are positive";
    checker.require(key, &quantity, minors.iter().all(|minor| *minor > 0.0), accepted)?;
    check_principal_moments(checker, key, tensor)
}

/// The condition of [`check_of_a_body`] on the principal moments, which are not on the diagonal: tr(J)/2 I - J, the integral of rho x x^T, is positive
/// semi-definite, up to rounding.
fn check_principal_moments(checker: &Checker<'_>, key: &Key, tensor: &Tensor) -> Checked<()> {
    let half = 0.5 * (1.0 + 1e-6) * (tensor[0][0] + tensor[1][1] + tensor[2][2]);
    let spread: Tensor =
        std::array::from_fn(|i| std::array::from_fn(|j| if i == j { half - tensor[i][j] } else { -tensor[i][j] }));
    let accepted = "the tensor of a body: no principal moment is larger than the sum of the other two";
    checker.require(key, "the tensor of inertia", leading_minors(&spread).iter().all(|minor| *minor > 0.0), accepted)
}

/// They are positive if and only if the symmetric `tensor` is positive definite.
fn leading_minors(tensor: &Tensor) -> [f64; 3] {
    let cofactor = tensor::cofactor(tensor);
    [tensor[0][0], cofactor[2][2], tensor::determinant(tensor, &cofactor)]
}
