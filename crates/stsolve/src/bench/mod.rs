//! `stsolve bench`: the kernels on this machine, relative to its own peak and bandwidth, measured in the same run.
//!
//! | module | holds |
//! |---|---|
//! | `group` | what can be measured |
//! | `roofs` | the peak of the machine: fused multiply-adds per second, bytes per second |
//! | `stopwatch` | the best of many short bursts |
//! | `measurement` | the results: rows of text, JSON for programs |
//!
//! The kernels stand in [`simulation::bench`].

mod group;
mod measurement;
mod roofs;
mod stopwatch;

use crate::cli::BenchArguments;
use crate::commands::print;
use crate::terminal::Terminal;
pub use group::Group;
use measurement::{Growth, Measurement, Report, heading};
use rayon::{ThreadPool, ThreadPoolBuilder};
use roofs::Machine;
use simulation::Failure;
use simulation::bench::{Builder, Kernels, MessageCount, Size, builders, count_messages};

/// Measures, and prints each row as soon as it is known, or one JSON object at the end.
///
/// # Errors
/// Threads that the system refuses, a subject that cannot be set up, a stdout that cannot be written.
pub fn bench(arguments: &BenchArguments) -> Result<(), Failure> {
    let mut report = Report::default();
    let timed: Vec<Kernels> = arguments.groups().iter().filter_map(|group| group.timed()).collect();
    if !timed.is_empty() {
        time(&timed, &mut report, arguments)?;
    }
    if arguments.groups().contains(&Group::Messages) {
        count(&mut report, arguments)?;
    }
    if arguments.json { print(&report.json()) } else { Ok(()) }
}

/// Measures kernels in seconds.
fn time(timed: &[Kernels], report: &mut Report, arguments: &BenchArguments) -> Result<(), Failure> {
    let pools = [pool(1)?, pool(0)?];
    let machine = Machine::measure(&pools, arguments.seconds);
    report.machine = Some(machine);
    print_row(&heading(&machine), arguments)?;
    for dimension in arguments.dimensions() {
        for &kernels in timed {
            let mut growth = Growth::default();
            for order in arguments.orders() {
                for measurement in measure(kernels, size(arguments, dimension, order), &pools, arguments)? {
                    let row = growth.of(measurement).against(&machine);
                    print_row(&row.to_string(), arguments)?;
                    report.rows.push(row);
                }
            }
        }
    }
    Ok(())
}

/// Counts the messages of ranks.
fn count(report: &mut Report, arguments: &BenchArguments) -> Result<(), Failure> {
    print_row(MessageCount::HEADING, arguments)?;
    for dimension in arguments.dimensions() {
        for order in arguments.orders() {
            for row in count_messages(size(arguments, dimension, order)).map_err(Failure::solve)? {
                print_row(&row.to_string(), arguments)?;
                report.messages.push(row);
            }
        }
    }
    Ok(())
}

/// Prints a row of text, unless the user wants JSON.
fn print_row(row: &str, arguments: &BenchArguments) -> Result<(), Failure> {
    if arguments.json { Ok(()) } else { print(row) }
}

fn size(arguments: &BenchArguments, dimension: usize, order: usize) -> Size {
    let mesh_order = arguments.mesh_order.map_or(order, usize::from);
    let (quadrature, nodes) = (arguments.quadrature.rule(), arguments.nodes.map(usize::from));
    Size { dimension, order, mesh_order, quadrature, nodes }
}

/// A pool of threads; 0 asks for one per core.
fn pool(threads: usize) -> Result<ThreadPool, Failure> {
    ThreadPoolBuilder::new().num_threads(threads).build().map_err(Failure::bad_input)
}

/// The rows of one group at one order, without subjects that would not fit into memory.
fn measure(
    kernels: Kernels,
    size: Size,
    pools: &[ThreadPool; 2],
    arguments: &BenchArguments,
) -> Result<Vec<Measurement>, Failure> {
    let terminal = Terminal::default();
    if terminal.is_interactive() {
        terminal.print(&format!("measuring {} in {}-D, N = {}", kernels.name(), size.dimension, size.order));
    }
    let mut rows = Vec::new();
    for build in builders(kernels, size.dimension) {
        rows.extend(of(build, size, pools, arguments)?);
    }
    Ok(rows)
}

/// One subject for one thread and one for all, measured in turns, so that other load affects both alike.
fn of(
    build: Builder,
    size: Size,
    pools: &[ThreadPool; 2],
    arguments: &BenchArguments,
) -> Result<Vec<Measurement>, Failure> {
    let mut subjects = Vec::new();
    for pool in pools {
        match pool.install(|| build(size)).map_err(Failure::solve)? {
            Some(subject) => subjects.push(subject),
            None => return Ok(Vec::new()),
        }
    }
    let work = subjects[0].work();
    let best = stopwatch::in_turns(pools, arguments.seconds, work.len(), |pool, number| subjects[pool].run(number));
    let rows = work.into_iter().zip(best);
    Ok(rows.map(|(work, [one, all])| Measurement::new(size, work, one, all)).collect())
}
