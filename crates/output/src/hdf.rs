//! The few HDF5 operations that the format needs: arrays that grow along axis 0, texts, labels.

use hdf5::plist::dataset_create::{AllocTime, FillTime};
use hdf5::types::{VarLenAscii, VarLenUnicode};
use hdf5::{
    Dataset, DatasetBuilder, Error, Extent, File, FileBuilder, Group, H5Type, Hyperslab, Location, Result,
    SimpleExtents, SliceOrIndex,
};
use ndarray::ArrayViewD;

/// Chunks of a step have at most this many bytes, so that reading a part of one step reads little else.
const CHUNK_BYTES: usize = 1 << 20;

/// Steps below this many bytes share a chunk.
const SMALL_STEP_BYTES: usize = 1 << 12;

/// Effort of the lossless compression of indices; level 4 saves nothing more.
const DEFLATE_LEVEL: u8 = 1;

/// Files in the format of HDF5 1.10, for any version of the library: that and later versions open them.
pub(crate) fn options() -> FileBuilder {
    let mut options = File::with_options();
    options.with_fapl(|access| access.libver_v110());
    options
}

/// Creates an array of shape (0, `row`...) that grows along axis 0 by `rows` at each step.
///
/// It is not compressed: a smooth flow in two dimensions shrinks to 0.78 of its size, at 50 MB/s on one core, and all
/// other threads would wait.
pub(crate) fn growing<T: H5Type>(group: &Group, name: &str, rows: usize, row: &[usize]) -> Result<Dataset> {
    let bytes = rows * row.iter().product::<usize>() * size_of::<T>();
    let builder = allocated_early(group).chunk(chunk(rows, row, bytes)).empty::<T>();
    let axes = row.iter().map(|&length| Extent::fixed(length));
    builder.shape(SimpleExtents::from_vec(std::iter::once(Extent::resizable(0)).chain(axes).collect())).create(name)
}

/// An array that has its room on the disk as soon as it has its shape, without values: then other ranks can write there, see `SharedFile`.
pub(crate) fn allocated_early(group: &Group) -> DatasetBuilder {
    let builder = group.new_dataset_builder().obj_track_times(false);
    builder.alloc_time(Some(AllocTime::Early)).fill_time(FillTime::Never)
}

/// Whether an array has been made as by [`allocated_early`].
pub(crate) fn is_allocated_early(dataset: &Dataset) -> Result<bool> {
    Ok(dataset.create_plist()?.alloc_time() == AllocTime::Early)
}

/// Shape of a chunk: many small steps, or equal parts of one step of `bytes` bytes, cut along its slowest axis.
fn chunk(rows: usize, row: &[usize], bytes: usize) -> Vec<usize> {
    let parts = bytes.div_ceil(CHUNK_BYTES).max(1);
    let mut chunk: Vec<usize> = std::iter::once(rows).chain(row.iter().copied()).map(|length| length.max(1)).collect();
    if bytes < SMALL_STEP_BYTES {
        chunk[0] *= SMALL_STEP_BYTES / bytes.max(8);
    } else {
        let slowest = usize::from(rows == 1 && chunk.len() > 1);
        chunk[slowest] = chunk[slowest].div_ceil(parts);
    }
    chunk
}

/// Appends `rows` rows, given one after the other, to an array that grows along axis 0.
pub(crate) fn append<T: H5Type>(dataset: &Dataset, rows: usize, values: &[T]) -> Result<()> {
    write_at(dataset, dataset.shape()[0], rows, values)
}

/// Writes `rows` rows, from the row `first` on, to an array that grows along axis 0.
pub(crate) fn write_at<T: H5Type>(dataset: &Dataset, first: usize, rows: usize, values: &[T]) -> Result<()> {
    make_room(dataset, first + rows)?;
    let mut shape = dataset.shape();
    let whole = std::iter::repeat_n(SliceOrIndex::from(..), shape.len() - 1);
    let selection: Vec<_> = std::iter::once(SliceOrIndex::from(first..first + rows)).chain(whole).collect();
    shape[0] = rows;
    dataset.write_slice(ArrayViewD::from_shape(shape, values)?, Hyperslab::from(selection))
}

/// Gives an array at least so many `rows` along axis 0.
pub(crate) fn make_room(dataset: &Dataset, rows: usize) -> Result<()> {
    let mut shape = dataset.shape();
    if shape[0] >= rows {
        return Ok(());
    }
    shape[0] = rows;
    dataset.resize(&shape)
}

/// Writes `rows` rows of the second axis, from the row `first` on, at the number `step` of axis 0, along which the array grows.
pub(crate) fn write_rows(dataset: &Dataset, step: usize, first: usize, rows: usize, values: &[f64]) -> Result<()> {
    make_room(dataset, step + 1)?;
    let mut shape = dataset.shape();
    let here = [step..step + 1, first..first + rows].map(SliceOrIndex::from);
    let whole = std::iter::repeat_n(SliceOrIndex::from(..), shape.len() - 2);
    let selection: Vec<_> = here.into_iter().chain(whole).collect();
    (shape[0], shape[1]) = (1, rows);
    dataset.write_slice(ArrayViewD::from_shape(shape, values)?, Hyperslab::from(selection))
}

/// Drops the last `rows` rows of an array that grows along axis 0.
pub(crate) fn drop_last(dataset: &Dataset, rows: usize) -> Result<()> {
    let mut shape = dataset.shape();
    shape[0] = shape[0].saturating_sub(rows);
    dataset.resize(&shape)
}

/// The group `name` in `parent`, made if it is not there.
pub(crate) fn group_in(parent: &Group, name: &str) -> Result<Group> {
    if parent.link_exists(name) { parent.group(name) } else { parent.create_group(name) }
}

/// Writes an array that does not grow.
pub(crate) fn constant<T: H5Type>(group: &Group, name: &str, values: &[T]) -> Result<()> {
    group.new_dataset_builder().obj_track_times(false).with_data(values).create(name).map(drop)
}

/// Writes an array of indices that does not grow. Indices follow a pattern and compress to almost nothing.
pub(crate) fn indices(group: &Group, name: &str, values: &[i64]) -> Result<()> {
    let builder = group.new_dataset_builder().obj_track_times(false).shuffle().deflate(DEFLATE_LEVEL);
    builder.with_data(values).create(name).map(drop)
}

/// Writes a text as an attribute.
pub(crate) fn write_text(location: &Location, name: &str, text: &str) -> Result<()> {
    let value: VarLenUnicode =
        text.parse().map_err(|_| Error::from(format!("`{name}` contains a zero byte, which HDF5 cannot store")))?;
    location.new_attr::<VarLenUnicode>().create(name)?.write_scalar(&value)
}

/// Reads a text from an attribute.
pub(crate) fn read_text(location: &Location, name: &str) -> Result<String> {
    let value: VarLenUnicode = location.attr(name)?.read_scalar()?;
    // `as_str` would assume that the bytes are UTF-8.
    let text = std::str::from_utf8(value.as_bytes());
    text.map(str::to_owned).map_err(|_| Error::from(format!("`{name}` is not a UTF-8 text")))
}

/// Writes an integer as an attribute.
pub(crate) fn write_integer(location: &Location, name: &str, value: i64) -> Result<()> {
    location.new_attr::<i64>().create(name)?.write_scalar(&value)
}

/// Reads an integer from an attribute.
pub(crate) fn read_integer(location: &Location, name: &str) -> Result<i64> {
    location.attr(name)?.read_scalar()
}

/// Reads a length, which is an integer that is not negative.
pub(crate) fn read_length(location: &Location, name: &str) -> Result<usize> {
    let value = read_integer(location, name)?;
    usize::try_from(value).map_err(|_| Error::from(format!("`{name}` is {value}, a length was expected")))
}

/// Labels the axes of an array in ASCII, slowest first, as HDF5's dimension scales do (`H5DSset_label`).
pub(crate) fn write_labels(dataset: &Dataset, labels: &[&str]) -> Result<()> {
    let ascii = |label: &&str| VarLenAscii::from_ascii(label).map_err(|error| Error::from(error.to_string()));
    let labels = labels.iter().map(ascii).collect::<Result<Vec<_>>>()?;
    dataset.new_attr_builder().with_data(&labels).create("DIMENSION_LABELS").map(drop)
}

/// Reads the labels of the axes of an array, slowest first.
pub(crate) fn read_labels(dataset: &Dataset) -> Result<Vec<String>> {
    let labels: Vec<VarLenAscii> = dataset.attr("DIMENSION_LABELS")?.read_raw()?;
    Ok(labels.iter().map(|label| String::from_utf8_lossy(label.as_bytes()).into_owned()).collect())
}
