//! The variation of the stiffness over the mesh.

/// The factor by which Young's modulus varies over the mesh.
#[derive(Clone, Copy)]
pub enum Stiffness<'a, const D: usize> {
    /// 1 everywhere.
    Constant,
    /// (det J / mean det J)^-power, point by point, with the Jacobian J of the reference mapping and its mean over all cells. Small
    /// cells, near walls, move rigidly and large ones take the deformation. Power 1 is the usual choice.
    InverseJacobian {
        /// The power chi.
        power: f64,
    },
    /// A positive function of the reference position.
    Function(&'a (dyn Fn(&[f64; D]) -> f64 + Sync)),
}

impl<const D: usize> Stiffness<'_, D> {
    /// The factor at `position`, where the Jacobian determinant is `relative_determinant` times its mean.
    pub(crate) fn at(&self, position: &[f64; D], relative_determinant: f64) -> f64 {
        match self {
            Stiffness::Constant => 1.0,
            Stiffness::InverseJacobian { power } => relative_determinant.powf(-power),
            Stiffness::Function(modulus) => modulus(position),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_of_half_the_volume_is_twice_as_stiff() {
        let at = |stiffness: Stiffness<'_, 2>| stiffness.at(&[0.5, 2.0], 0.5);
        assert_eq!(at(Stiffness::Constant), 1.0);
        assert_eq!(at(Stiffness::InverseJacobian { power: 1.0 }), 2.0);
        assert_eq!(at(Stiffness::InverseJacobian { power: 2.0 }), 4.0);
        assert_eq!(at(Stiffness::Function(&|x| x[0] + x[1])), 2.5);
    }
}
