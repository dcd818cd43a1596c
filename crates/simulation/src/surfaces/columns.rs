//! The numbers of a point of a wall, and their names.

use tensor::AXES;

/// A quantity: one number, or one for each axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its name.
    pub name: &'static str,
    /// The number of its components.
    pub components: usize,
    /// Whether it is a field for viewers, which have the positions already.
    pub is_field: bool,
}

/// The quantities at a point, in their order, in `dimension` dimensions.
pub fn columns(dimension: usize) -> Vec<Column> {
    let scalar = |name| Column { name, components: 1, is_field: true };
    let vector = |name| Column { name, components: dimension, is_field: true };
    let hidden = |column: Column| Column { is_field: false, ..column };
    // Only a curve has a length; s is also that of a curve that is extruded.
    let along = [hidden(scalar("s")), scalar("arc_length")];
    let along = if dimension == 2 { &along[..] } else { &along[..1] };
    let others = [
        hidden(vector("")),
        vector("normal"),
        hidden(scalar("area")),
        scalar("pressure"),
        scalar("pressure_coefficient"),
        vector("friction"),
        vector("skin_friction"),
        scalar("friction_coefficient"),
        scalar("heat_flux"),
        scalar("y_plus"),
    ];
    [along, &others].concat()
}

impl Column {
    /// The names of its components: `friction_x`, `friction_y`.
    pub fn names(&self) -> Vec<String> {
        let named =
            |axis: &&str| if self.name.is_empty() { (*axis).to_owned() } else { format!("{}_{axis}", self.name) };
        match self.components {
            1 => vec![self.name.to_owned()],
            components => AXES[..components].iter().map(named).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_components() {
        let names = |dimension| columns(dimension).iter().flat_map(Column::names).collect::<Vec<_>>().join(",");
        assert!(names(2).starts_with("s,arc_length,x,y,normal_x,normal_y,area,pressure,"), "{}", names(2));
        assert!(names(3).starts_with("s,x,y,z,normal_x,normal_y,normal_z,area,"), "{}", names(3));
    }
}
