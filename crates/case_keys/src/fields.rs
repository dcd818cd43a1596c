//! The components of fields.

use crate::Field;

impl Field {
    /// All fields.
    pub const ALL: [Field; 16] = [
        Field::Density,
        Field::Velocity,
        Field::Pressure,
        Field::Temperature,
        Field::Mach,
        Field::PressureCoefficient,
        Field::TotalPressure,
        Field::TotalTemperature,
        Field::Entropy,
        Field::QCriterion,
        Field::Vorticity,
        Field::MeshVelocity,
        Field::Jacobian,
        Field::Displacement,
        Field::VonMises,
        Field::PrincipalStress,
    ];

    /// The fields of a flow. Formulas may contain their components.
    pub const OF_FLOW: &'static [Field] = Field::ALL.split_at(11).0;

    /// Whether it is a stress, which only structures have.
    pub fn is_of_structure(self) -> bool {
        matches!(self, Field::VonMises | Field::PrincipalStress)
    }

    /// The names of its components in `dimension` dimensions.
    pub fn components(self, dimension: usize) -> &'static [&'static str] {
        let vector = |names: &'static [&'static str; 3]| &names[..dimension];
        match self {
            Field::Density => &["density"],
            Field::Velocity => vector(&["velocity_x", "velocity_y", "velocity_z"]),
            Field::Pressure => &["pressure"],
            Field::Temperature => &["temperature"],
            Field::Mach => &["mach"],
            Field::PressureCoefficient => &["pressure_coefficient"],
            Field::TotalPressure => &["total_pressure"],
            Field::TotalTemperature => &["total_temperature"],
            Field::Entropy => &["entropy"],
            Field::QCriterion => &["q_criterion"],
            Field::Vorticity if dimension == 2 => &["vorticity"],
            Field::Vorticity => &["vorticity_x", "vorticity_y", "vorticity_z"],
            Field::MeshVelocity => vector(&["mesh_velocity_x", "mesh_velocity_y", "mesh_velocity_z"]),
            Field::Jacobian => &["jacobian"],
            Field::Displacement => vector(&["displacement_x", "displacement_y", "displacement_z"]),
            Field::VonMises => &["von_mises"],
            Field::PrincipalStress => &["principal_stress_1", "principal_stress_2", "principal_stress_3"],
        }
    }

    /// The names of the components of all fields of a flow.
    pub fn components_of_flow(dimension: usize) -> impl Iterator<Item = &'static str> {
        Field::OF_FLOW.iter().flat_map(move |field| field.components(dimension).iter().copied())
    }
}
