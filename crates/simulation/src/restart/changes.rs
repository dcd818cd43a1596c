//! What a run changes of the one that it continues.

use super::{Origin, RestartError};
use crate::bodies::has_bodies;
use crate::fallback;
use case::{AllowedChange, Case, gas_of, quadrature_of};
use fem::Orders;

/// The remedy if the gas differs.
const ALLOW: &str = "; `restart.allow = [\"viscosity\"]`, or \"mach\", if it is to change";

/// What the case of a run has of another kind than that of the run that it continues.
pub(super) struct Changes {
    /// The mesh.
    pub(super) mesh: bool,
    /// The gas.
    pub(super) gas: bool,
    /// The reference pressure, by another Mach number.
    pub(super) pressure: bool,
    /// The integrals over cells.
    pub(super) quadrature: bool,
    /// Rigid bodies or the structure.
    pub(super) bodies: bool,
}

impl Changes {
    /// Why distributions along walls begin anew on the same mesh, for a run that goes on in the orders `to`, if they do.
    pub(super) fn of_distributions(&self, from: Orders, to: Orders) -> Option<&'static str> {
        let has_other_points = from.flow != to.flow || from.mesh != to.mesh || self.quadrature;
        match (self.gas, has_other_points) {
            (true, _) => Some("gas"),
            (false, true) => Some("order or quadrature"),
            (false, false) => None,
        }
    }

    /// Whether the energies of flow and bodies are measured in another way.
    pub(super) fn of_energies(&self) -> bool {
        self.mesh || self.pressure || self.quadrature || self.bodies
    }
}

impl Origin {
    /// What `case` changes. A change that it may not make is an error.
    pub(super) fn changes<const D: usize>(&self, case: &Case<D>) -> Result<Changes, RestartError> {
        let mesh = self.check_mesh(case)?;
        let gas = self.check_flow(case)?;
        Ok(Changes {
            mesh,
            gas,
            pressure: gas && case.allows(AllowedChange::Mach),
            quadrature: self.has_other_quadrature(case)?,
            bodies: self.has_other_bodies(case)?,
        })
    }

    /// Whether rigid bodies or the structure of `case` may store another energy in the same state. Their numbers may be formulas of constants, and
    /// of tables. To begin the balance anew without need does no harm.
    fn has_other_bodies<const D: usize>(&self, case: &Case<D>) -> Result<bool, RestartError> {
        Ok(has_bodies(case) && self.is_other(case, &["constants", "tables", "bodies", "structure"])?)
    }

    /// Whether the flow of `case` has other integrals over the cells.
    fn has_other_quadrature<const D: usize>(&self, case: &Case<D>) -> Result<bool, RestartError> {
        let [there, here] = self.both(case, quadrature_of)?;
        Ok(there != here || fallback::since(&self.stored.state.arrays).is_some())
    }

    /// The gas in both cases, as text and without what is `allowed` to change.
    fn gases<const D: usize>(&self, case: &Case<D>, allowed: &[AllowedChange]) -> Result<[String; 2], RestartError> {
        self.both(case, |text| gas_of(text, allowed).map(Option::unwrap_or_default))
    }

    /// The result must hold a flow of the same gas; the case may allow changes. Returns whether the gas has changed.
    fn check_flow<const D: usize>(&self, case: &Case<D>) -> Result<bool, RestartError> {
        let [there, here] = self.gases(case, &[])?;
        if !self.result.layout.exact.iter().any(|array| array.name == "flow") {
            return Err(self.differs("what is solved", "no flow", "a flow"));
        }
        if there == here {
            return Ok(false);
        }
        let [there, here] = self.gases(case, &case.allowed_changes)?;
        if there != here {
            let everything = [AllowedChange::Viscosity, AllowedChange::Mach];
            let [rest_there, rest_here] = self.gases(case, &everything)?;
            let remedy = if rest_there == rest_here { ALLOW } else { "; a flow of another gas cannot be taken over" };
            return Err(self.differs("the gas", there, here + remedy));
        }
        Ok(true)
    }
}
