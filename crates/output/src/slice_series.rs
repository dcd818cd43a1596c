//! `slice_NAME.pvd`: the times of a slice, and for each the name of its file.

use std::fs;
use std::path::{Path, PathBuf};

use crate::error::OutputError;
use crate::files::{file_error, remove, write_atomically};
use crate::poly_data::PolyData;

/// A series of poly data that ParaView opens as one: `slice_NAME.pvd`, and `slice_NAME/slab_NNNNNN.vtp` for every time.
#[derive(Clone, Debug, PartialEq)]
pub struct SliceSeries {
    directory: PathBuf,
    name: String,
}

const HEAD: &str = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n";
const TAIL: &str = "</Collection>\n</VTKFile>\n";

impl SliceSeries {
    /// The series NAME in a directory.
    pub fn of(directory: &Path, name: &str) -> Self {
        SliceSeries { directory: directory.to_owned(), name: format!("slice_{name}") }
    }

    /// Starts the series, or keeps its times up to `reached` of a run that is resumed. The files of other times are removed.
    ///
    /// # Errors
    /// [`OutputError::File`] if the system refuses.
    pub fn begin(&self, reached: Option<f64>) -> Result<(), OutputError> {
        let folder = self.directory.join(&self.name);
        fs::create_dir_all(&folder).map_err(|source| file_error(&folder, source))?;
        let is_kept = |entry: &String| reached.zip(time_of(entry)).is_some_and(|(reached, t)| t <= reached);
        let (kept, dropped): (Vec<String>, Vec<String>) = self.entries().into_iter().partition(is_kept);
        self.write(&kept)?;
        dropped
            .iter()
            .filter_map(|entry| self.file_of(entry))
            .try_for_each(|file| [file.clone(), file.with_extension("csv")].iter().try_for_each(|file| remove(file)))
    }

    /// The file of an entry, if it is one of this series.
    fn file_of(&self, entry: &str) -> Option<PathBuf> {
        let file = entry.split('"').nth(5)?;
        let slab = file.strip_prefix(&format!("{}/slab_", self.name))?.strip_suffix(".vtp")?;
        slab.bytes().all(|byte| byte.is_ascii_digit()).then(|| self.directory.join(file))
    }

    /// Adds the slice of a time, on request also as a table, `slab_NNNNNN.csv`.
    ///
    /// # Errors
    /// [`OutputError::File`] if the system refuses.
    pub fn append(&self, slab: usize, time: f64, slice: &PolyData, as_table: bool) -> Result<(), OutputError> {
        let file = format!("{}/slab_{slab:06}.vtp", self.name);
        write_atomically(&self.directory.join(&file), slice.to_xml(time).as_bytes())?;
        if as_table {
            let table = self.directory.join(&file).with_extension("csv");
            write_atomically(&table, slice.to_csv().as_bytes())?;
        }
        let mut entries = self.entries();
        entries.push(format!("<DataSet timestep=\"{time:?}\" part=\"0\" file=\"{file}\"/>"));
        self.write(&entries)
    }

    fn path(&self) -> PathBuf {
        self.directory.join(format!("{}.pvd", self.name))
    }

    /// The lines of the times.
    fn entries(&self) -> Vec<String> {
        let text = fs::read_to_string(self.path()).unwrap_or_default();
        text.lines().filter(|line| line.starts_with("<DataSet ")).map(str::to_owned).collect()
    }

    fn write(&self, entries: &[String]) -> Result<(), OutputError> {
        let lines: String = entries.iter().map(|entry| format!("{entry}\n")).collect();
        write_atomically(&self.path(), (HEAD.to_owned() + &lines + TAIL).as_bytes())
    }
}

fn time_of(entry: &str) -> Option<f64> {
    entry.split('"').nth(1)?.parse().ok()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_resumed_series_keeps_the_times_of_its_checkpoint() {
        let directory = tempfile::tempdir().unwrap();
        let series = SliceSeries::of(directory.path(), "wake");
        series.begin(None).unwrap();
        for slab in 0..4 {
            series.append(slab, 0.1 * slab as f64, &PolyData::default(), slab == 1).unwrap();
        }
        assert_eq!(series.entries().len(), 4);
        series.begin(Some(0.1)).unwrap();
        let text = fs::read_to_string(directory.path().join("slice_wake.pvd")).unwrap();
        assert!(text.starts_with(HEAD) && text.ends_with(TAIL), "{text}");
        assert_eq!(series.entries().iter().filter_map(|entry| time_of(entry)).collect::<Vec<_>>(), [0.0, 0.1]);
        let has = |file: &str| directory.path().join("slice_wake").join(file).exists();
        assert!(has("slab_000001.vtp") && has("slab_000001.csv") && !has("slab_000002.csv"));
        assert!(!has("slab_000002.vtp") && !has("slab_000003.vtp"), "slices of a former end stayed");
    }
}
