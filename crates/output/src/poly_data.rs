//! Polygons with fields, as VTK's XML file of poly data (`.vtp`), which ParaView opens, and as a table of their corners.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;

use crate::layout::FieldSpec;

/// Polygons with values at their corners.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PolyData {
    /// Corners, `[point][3]`.
    pub points: Vec<f64>,
    /// The corners of each polygon, in their order.
    pub polygons: Vec<Vec<usize>>,
    /// Fields, `[point][component]`.
    pub fields: Vec<(FieldSpec, Vec<f64>)>,
}

impl PolyData {
    /// The contents of a file at `time`. Numbers are in base64, with all their bits.
    pub fn to_xml(&self, time: f64) -> String {
        let field = |(spec, values): &(FieldSpec, Vec<f64>)| floats(&spec.name, spec.components, values);
        let connectivity: Vec<i64> = self.polygons.iter().flatten().map(|point| *point as i64).collect();
        let ends = self.polygons.iter().scan(0, |end, polygon| {
            *end += polygon.len() as i64;
            Some(*end)
        });
        format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
             <PolyData>\n<FieldData>\n<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">{time:?}\
             </DataArray>\n</FieldData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" \
             NumberOfPolys=\"{}\">\n<PointData>\n{}</PointData>\n<Points>\n{}</Points>\n<Polys>\n{}{}</Polys>\n</Piece>\n</PolyData>\n\
             </VTKFile>\n",
            self.points.len() / 3,
            self.polygons.len(),
            self.fields.iter().map(field).collect::<String>(),
            floats("Points", 3, &self.points),
            integers("connectivity", &connectivity),
            integers("offsets", &ends.collect::<Vec<_>>()),
        )
    }

    /// A table of the corners: a row for each, with its position and its fields.
    pub fn to_csv(&self) -> String {
        let names = self.fields.iter().flat_map(|(spec, _)| match spec.components {
            1 => vec![spec.name.clone()],
            count => ["x", "y", "z"][..count].iter().map(|axis| format!("{}_{axis}", spec.name)).collect(),
        });
        let mut text = ["x", "y", "z"].map(str::to_owned).into_iter().chain(names).collect::<Vec<_>>().join(",") + "\n";
        for (number, point) in self.points.chunks_exact(3).enumerate() {
            let fields =
                self.fields.iter().flat_map(|(spec, values)| &values[number * spec.components..][..spec.components]);
            let numbers = point.iter().chain(fields).map(|number| format!("{number:?}")).collect::<Vec<_>>();
            text += &(numbers.join(",") + "\n");
        }
        text
    }
}

fn floats(name: &str, components: usize, values: &[f64]) -> String {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    array(&format!("type=\"Float64\" Name=\"{name}\" NumberOfComponents=\"{components}\""), &bytes)
}

fn integers(name: &str, values: &[i64]) -> String {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    array(&format!("type=\"Int64\" Name=\"{name}\""), &bytes)
}

/// The number of bytes comes before them.
fn array(head: &str, bytes: &[u8]) -> String {
    let counted = [&(bytes.len() as u64).to_le_bytes()[..], bytes].concat();
    format!("<DataArray {head} format=\"binary\">{}</DataArray>\n", BASE64_STANDARD.encode(counted))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn triangle() -> PolyData {
        let velocity = vec![1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 3.0, 0.5, 0.0];
        let pressure = vec![0.1 + 0.2, 1.0, 2.0];
        PolyData {
            points: vec![0.1, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0],
            polygons: vec![vec![0, 1, 2]],
            fields: vec![(FieldSpec::scalar("pressure"), pressure), (FieldSpec::vector("velocity"), velocity)],
        }
    }

    #[test]
    fn a_table_has_a_row_for_each_corner() {
        let text = triangle().to_csv();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "x,y,z,pressure,velocity_x,velocity_y,velocity_z");
        assert_eq!(
            (lines[1], lines[3]),
            ("0.1,0.0,0.0,0.30000000000000004,1.0,0.0,0.0", "0.0,1.0,0.0,2.0,3.0,0.5,0.0")
        );
        assert_eq!(lines.len(), 4);
    }

    #[test]
    fn numbers_keep_their_bits() {
        let triangle = triangle();
        let text = triangle.to_xml(0.5);
        let encoded = text.split("Name=\"pressure\"").nth(1).unwrap().split(['>', '<']).nth(1).unwrap();
        let bytes = BASE64_STANDARD.decode(encoded).unwrap();
        assert_eq!((bytes.len(), bytes[0]), (32, 24));
        assert_eq!(bytes[8..16], (0.1_f64 + 0.2).to_le_bytes());
        assert!(text.contains("NumberOfPolys=\"1\"") && text.contains(">0.5</DataArray>"), "{text}");
    }
}
