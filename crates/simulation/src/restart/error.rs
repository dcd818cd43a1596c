//! Why a case cannot start from a result.

use std::path::PathBuf;

/// Why a case cannot start from a result.
#[derive(Debug, thiserror::Error)]
pub enum RestartError {
    /// The file does not exist.
    #[error("`restart.from` names `{path}`, which does not exist; it is looked for beside the case file")]
    Missing {
        /// The path of the file.
        path: PathBuf,
    },
    /// The case in the file cannot be read.
    #[error("the case in `{path}` cannot be read, perhaps it is of another version of the program: {reason}")]
    Unreadable {
        /// The result file.
        path: PathBuf,
        /// The mismatch.
        reason: String,
    },
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] output::OutputError),
    /// A quantity that must be equal is not.
    #[error("this case cannot start from `{path}`: {quantity} there: {there}; here: {here}")]
    Differs {
        /// The result file.
        path: PathBuf,
        /// The quantity.
        quantity: &'static str,
        /// Its value in the file.
        there: String,
        /// Its value in this case.
        here: String,
    },
    /// The boundary would jump.
    #[error(
        "this case cannot start from `{path}`: at t = {time} the point at {position:?} is displaced by {there:?} there, and the motion of \
         this case puts it at {here:?}, {distance:.3e} away; change `[motion]`, and the constants and tables in it, so that the motion \
         goes on from there, or start anew"
    )]
    MotionJumps {
        /// The result file.
        path: PathBuf,
        /// The time reached there.
        time: f64,
        /// A point of the mesh at rest.
        position: Vec<f64>,
        /// Its displacement in the file.
        there: Vec<f64>,
        /// Its displacement in this case.
        here: Vec<f64>,
        /// Their distance.
        distance: f64,
    },
    /// A body would jump.
    #[error(
        "this case cannot start from `{path}`: at t = {time} the coordinate `{coordinate}` of the body `{body}` is {there} there, and its motion in \
         this case is {here}; change `bodies.{body}.{coordinate}.motion`, and the constants and tables in it, so that it goes on from there, or \
         start anew"
    )]
    BodyJumps {
        /// The result file.
        path: PathBuf,
        /// The time reached there.
        time: f64,
        /// The body.
        body: String,
        /// Its coordinate.
        coordinate: &'static str,
        /// Its value in the file.
        there: f64,
        /// Its value in this case.
        here: f64,
    },
    /// A support of a structure would jump.
    #[error(
        "this case cannot start from `{path}`: at t = {time} the support of the structure at {position:?} is displaced by {there:?} there, and \
         this case puts it at {here:?}; change `structure.boundary`, and the constants and tables in it, so that it goes on from there, or \
         start anew"
    )]
    SupportJumps {
        /// The result file.
        path: PathBuf,
        /// The time reached there.
        time: f64,
        /// The point of the structure at rest.
        position: Vec<f64>,
        /// Its displacement in the file.
        there: Vec<f64>,
        /// Its displacement in this case.
        here: Vec<f64>,
    },
    /// The time reached by the run is outside this case.
    #[error(
        "this case cannot start from `{path}`: the run there stands at t = {time}, this case covers t = {start} to {end}; {remedy}"
    )]
    Time {
        /// The result file.
        path: PathBuf,
        /// The time reached there.
        time: f64,
        /// The start of this case.
        start: f64,
        /// Its end.
        end: f64,
        /// The key to change.
        remedy: &'static str,
    },
}
