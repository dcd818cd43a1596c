//! The command line.

use crate::bench::Group;
use clap::{ArgAction, Args, Parser, Subcommand, ValueEnum};
use simulation::Failure;
use std::path::{Path, PathBuf};

/// Coupled space-time solver: elasticity moves a curved high-order mesh, compressible flow is solved on it.
///
/// Exit codes: 0 done, 1 the solve failed (the last good state is written), 2 bad input (nothing is written), 3 stopped early by a signal
/// (a checkpoint is written).
#[derive(Clone, Debug, Parser)]
#[command(name = "stsolve", version)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Clone, Debug, Subcommand)]
pub enum Command {
    /// Solve a case: mesh and flow, slab by slab.
    Run(RunArguments),
    /// Move the mesh alone, over the whole run, and prove that it stays valid.
    Motion(RunArguments),
    /// Validate a case and explain it: sizes, memory, cost, non-dimensional numbers, the mesh over the run, defaults taken, choices
    /// that are likely wrong. Writes nothing.
    Check {
        /// The case.
        #[command(flatten)]
        case: CaseArguments,
        /// Print JSON.
        #[arg(long)]
        json: bool,
        /// Whether to move the mesh over the run and to time the parts of a slab.
        #[arg(long, value_enum, default_value_t = Probe::Auto, value_name = "WHEN")]
        probe: Probe,
        /// The threads of trial computations.
        #[command(flatten)]
        threads: Threads,
    },
    /// Describe a result file or a mesh file of Gmsh, SU2 or CGNS.
    Info {
        /// The file.
        file: PathBuf,
        /// Print JSON: all of it.
        #[arg(long)]
        json: bool,
        /// Print also the checksums of a result and the contents of its checkpoint.
        #[arg(short, long)]
        verbose: bool,
    },
    /// Write one HTML page of a run, finished or not: pictures, curves, figures. It needs no network. Of several runs: their curves over each
    /// other, in comparison.html of the first.
    Report {
        /// The directory of the run, or those of several.
        #[arg(required = true)]
        directories: Vec<PathBuf>,
        /// What to write instead of the page.
        #[command(flatten)]
        drawing: DrawingArguments,
        /// The Q of the surfaces that show vortices in three dimensions [default: four fifths of the integral of positive Q lie above it].
        #[arg(long, value_name = "Q", value_parser = finite, allow_hyphen_values = true)]
        q_level: Option<f64>,
    },
    /// Print what differs between two runs: keys of their cases, figures, curves.
    Compare {
        /// The directory of a run.
        first: PathBuf,
        /// That of another.
        second: PathBuf,
        /// Print JSON.
        #[arg(long)]
        json: bool,
    },
    /// Measure the kernels on this machine, against its own arithmetic peak and memory bandwidth.
    Bench(BenchArguments),
    /// Print the JSON Schema of the case file: every key, its type, default and meaning.
    Schema {
        /// Print the reference of keys in Markdown instead.
        #[arg(long)]
        markdown: bool,
    },
    /// Print the script that completes the commands of stsolve in a shell.
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
}

/// A movie or a picture of a run.
#[derive(Clone, Debug, Args)]
pub struct DrawingArguments {
    /// Write a movie of this field, an animated PNG in the directory, instead of the page: `mach`, `vorticity`, `pressure`, `q_criterion`, ...
    /// [default: the first field of the page]
    #[arg(long, value_name = "FIELD", group = "drawing", num_args = 0..=1, default_missing_value = "")]
    movie: Option<String>,
    /// Write a picture of this field at the last step, a PNG in the directory, instead of the page.
    #[arg(long, value_name = "FIELD", group = "drawing", num_args = 0..=1, default_missing_value = "")]
    picture: Option<String>,
    /// Write the movie as a GIF: larger and of 256 colours, for programs that do not play an animated PNG.
    #[arg(long, requires = "movie")]
    gif: bool,
    /// The window of the movie or picture: its name in the page, for instance "whole domain", a box `X0,Y0,X1,Y1`, or in three dimensions a plane
    /// such as `z=0.5`. `cut x` is its middle position in the page [default: the first window of the page].
    #[arg(long, value_name = "WINDOW", requires = "drawing", allow_hyphen_values = true)]
    window: Option<String>,
    /// The values at the ends of the colours [default: nearly all values at all steps].
    #[arg(long, value_name = "LOWER,UPPER", requires = "drawing", allow_hyphen_values = true, value_parser = pair)]
    range: Option<[f64; 2]>,
    /// About how many pixels a row has [default: as in the page].
    #[arg(long, value_name = "PIXELS", requires = "drawing", value_parser = clap::value_parser!(u16).range(100..=4000))]
    width: Option<u16>,
    /// Leave out the edges of the cells.
    #[arg(long, requires = "drawing")]
    no_edges: bool,
}

impl DrawingArguments {
    /// What to draw, with surfaces of Q at `q_level`, and whether the last step alone; `None` for the page.
    pub fn scenario(&self, q_level: Option<f64>) -> Option<(report::Scenario<'_>, bool)> {
        let field = self.movie.as_ref().or(self.picture.as_ref())?;
        let scenario = report::Scenario {
            field,
            window: self.window.as_deref(),
            q_level,
            range: self.range,
            width: self.width.map(usize::from),
            without_edges: self.no_edges,
            format: if self.gif { report::MovieFormat::Gif } else { report::MovieFormat::Png },
        };
        Some((scenario, self.picture.is_some()))
    }
}

/// A number that is finite.
fn finite(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| "a finite number is expected".into())
}

/// Two numbers with a comma between them.
fn pair(text: &str) -> Result<[f64; 2], String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|word| word.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some([lower, upper]) => Ok([*lower, *upper]),
        _ => Err("two numbers with a comma between them are expected, such as -1,1".into()),
    }
}

/// When `check` makes trial computations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Probe {
    /// If they take some seconds at most.
    Auto,
    /// Always, even if they take long.
    Always,
    /// Never.
    Never,
}

/// A case, with changes.
#[derive(Clone, Debug, Args)]
pub struct CaseArguments {
    /// The case file (TOML).
    pub case: PathBuf,
    /// Replace a value of the case file, for instance `--set flow.order=6`.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

/// How many threads a command uses.
#[derive(Clone, Copy, Debug, Args)]
pub struct Threads {
    /// How many threads to use [default: one per core].
    #[arg(long = "threads", value_name = "N", value_parser = clap::value_parser!(u16).range(1..=i64::from(simulation::MOST_THREADS)))]
    count: Option<u16>,
}

impl Threads {
    /// That many threads for everything that follows, or `default` where the command line gives none.
    ///
    /// # Errors
    /// If threads cannot be started.
    pub fn set(self, default: Option<usize>) -> Result<(), Failure> {
        let Some(threads) = self.count.map(usize::from).or(default) else { return Ok(()) };
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().map_err(Failure::bad_input)
    }
}

/// The options of `run` and `motion`.
#[derive(Clone, Debug, Args)]
pub struct RunArguments {
    /// The case.
    #[command(flatten)]
    pub case: CaseArguments,
    /// Where to write [default: as in the case, or `runs/NAME` for a case NAME.toml].
    #[arg(long, value_name = "DIRECTORY")]
    pub output: Option<PathBuf>,
    /// How many threads.
    #[command(flatten)]
    pub threads: Threads,
    /// Continue from the checkpoint in the output directory.
    #[arg(long)]
    pub resume: bool,
    /// Replace the run that the output directory holds.
    #[arg(long, conflicts_with = "resume")]
    pub force: bool,
    /// Of several processes, also write the logs of the others: `log_1.jsonl`, `log_2.jsonl`, ... beside `log.jsonl`.
    #[arg(long)]
    pub log_ranks: bool,
    /// How much to print.
    #[command(flatten)]
    pub verbosity: Verbosity,
}

impl RunArguments {
    /// The command that shows the run in `directory`.
    pub fn to_report(directory: &Path) -> String {
        format!("look at it: stsolve report {}", quoted(&directory.to_string_lossy()))
    }

    /// The command line that calls `command` again with this case and its changes, for `directory` and with `option`, quoted for a shell.
    pub fn again(&self, command: &str, directory: &Path, option: &str) -> String {
        let set = self.case.set.iter().flat_map(|change| ["--set".into(), quoted(change)]);
        let words =
            ["stsolve".into(), command.into(), quoted(&self.case.case.to_string_lossy())].into_iter().chain(set);
        let output = ["--output".into(), quoted(&directory.to_string_lossy()), option.into()];
        words.chain(output).collect::<Vec<_>>().join(" ")
    }
}

/// A word for a shell.
pub fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "_-./=:,+".contains(c);
    if !word.is_empty() && word.chars().all(plain) { word.into() } else { format!("'{}'", word.replace('\'', r"'\''")) }
}

/// The options of `bench`.
#[derive(Clone, Debug, Args)]
pub struct BenchArguments {
    /// Print one JSON object.
    #[arg(long)]
    pub json: bool,
    /// Which kernels to measure [default: all].
    #[arg(long, value_name = "GROUP", value_delimiter = ',')]
    kernel: Vec<Group>,
    /// Which orders N, such as `4,8` [default: 2 to 16].
    #[arg(long, value_name = "N", value_delimiter = ',', value_parser = clap::value_parser!(u16).range(2..=16))]
    orders: Vec<u16>,
    /// Which dimension, 2 or 3 [default: both].
    #[arg(long, value_name = "D", value_parser = clap::value_parser!(u16).range(2..=3))]
    dimension: Option<u16>,
    /// About how many nodes per direction, in 3-D at most 64 [default: 128 in 2-D, 32 in 3-D; 226 and 33 for elasticity].
    #[arg(long, value_name = "NODES", value_parser = clap::value_parser!(u16).range(4..=256))]
    pub nodes: Option<u16>,
    /// Order of the mesh under the flow [default: the order of the flow].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=16))]
    pub mesh_order: Option<u16>,
    /// The quadrature of the flow.
    #[arg(long, value_name = "RULE", value_enum, default_value_t = Rule::Conserving)]
    pub quadrature: Rule,
    /// For how many seconds to repeat each kernel; the shortest time counts.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.2, value_parser = seconds)]
    pub seconds: f64,
}

/// The quadrature of a measured flow, see `flow.quadrature` of a case.
#[derive(Clone, Copy, Debug, ValueEnum)]
#[value(rename_all = "snake_case")]
pub enum Rule {
    /// As `flow.quadrature = "conserving"`.
    Conserving,
    /// As "collocated".
    Collocated,
    /// As "collocated_lobatto".
    CollocatedLobatto,
}

impl Rule {
    /// Its points.
    pub(crate) fn rule(self) -> fem::Quadrature {
        match self {
            Rule::Conserving => fem::Quadrature::Conserving,
            Rule::Collocated => fem::Quadrature::Collocated(fem::PointFamily::Gauss),
            Rule::CollocatedLobatto => fem::Quadrature::Collocated(fem::PointFamily::Lobatto),
        }
    }
}

/// A finite duration of at most an hour.
fn seconds(text: &str) -> Result<f64, String> {
    let accepted = |seconds: &f64| (0.0..=3600.0).contains(seconds);
    text.parse().ok().filter(accepted).ok_or_else(|| "a number of seconds from 0 to 3600 is expected".into())
}

impl BenchArguments {
    /// The kernels to measure.
    pub(crate) fn groups(&self) -> &[Group] {
        if self.kernel.is_empty() { Group::value_variants() } else { &self.kernel }
    }
    /// The orders, from low to high.
    pub(crate) fn orders(&self) -> Vec<usize> {
        let mut orders: Vec<usize> = self.orders.iter().map(|&order| order.into()).collect();
        orders.sort_unstable();
        if orders.is_empty() { (2..=16).collect() } else { orders }
    }
    /// The dimensions.
    pub(crate) fn dimensions(&self) -> Vec<usize> {
        self.dimension.map_or(vec![2, 3], |dimension| vec![dimension.into()])
    }
}

/// How much to print.
#[derive(Clone, Copy, Debug, Default, Args)]
pub struct Verbosity {
    /// Print nothing but errors.
    #[arg(short, long, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Print more: every Newton step; twice: every Krylov solve.
    #[arg(short, long, action = ArgAction::Count)]
    pub verbose: u8,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn the_command_to_resume_survives_a_shell() {
        let line = ["stsolve", "run", "my case.toml", "--set", "time.end=2", "--set", "title=it's"];
        let Command::Run(arguments) = Arguments::parse_from(line).command else { panic!("not a run") };
        assert_eq!(RunArguments::to_report(Path::new("a b")), "look at it: stsolve report 'a b'");
        assert_eq!(
            arguments.again("run", Path::new("runs/a"), "--resume"),
            r"stsolve run 'my case.toml' --set time.end=2 --set 'title=it'\''s' --output runs/a --resume"
        );
    }
}
