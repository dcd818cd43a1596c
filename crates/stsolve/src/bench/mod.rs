//! `stsolve bench`: the kernels on this machine, relative to its own peak and bandwidth, measured in the same run.
//!
//! | module | holds |
//! |---|---|
//! | `roofs` | the peak of the machine: fused multiply-adds per second, bytes per second |
//! | `subject` | the measured kernels, and their amount of work |
//! | `messages` | what ranks send each other, beside a model |
//! | `elastic`, `elastic_solvers`, `flow`, `preconditioner`, `vectors` | the subjects |
//! | `stopwatch` | the best of many short bursts |
//! | `measurement` | the results: rows of text, JSON for programs |

mod elastic;
mod elastic_solvers;
mod flow;
mod measurement;
mod messages;
mod preconditioner;
mod roofs;
mod stopwatch;
mod subject;
mod vectors;

use crate::cli::BenchArguments;
use crate::commands::print;
use crate::terminal::Terminal;
use elastic::Elastic;
use elastic_solvers::ElasticSolvers;
use flow::Flow;
use measurement::{Growth, Measurement, Report};
use messages::MessageCount;
use preconditioner::{ByLines, Preconditioned};
use rayon::{ThreadPool, ThreadPoolBuilder};
use roofs::Machine;
use simulation::Failure;
pub use subject::Group;
use subject::{Build, Size};
use vectors::Vectors;

/// Measures, and prints each row as soon as it is known, or one JSON object at the end.
///
/// # Errors
/// Threads that the system refuses, a subject that cannot be set up, a stdout that cannot be written.
pub fn bench(arguments: &BenchArguments) -> Result<(), Failure> {
    let pools = [pool(1)?, pool(0)?];
    let machine = Machine::measure(&pools, arguments.seconds);
    let mut report = Report::new(machine);
    let (counted, timed): (Vec<Group>, Vec<Group>) = arguments.groups().iter().partition(|group| group.is_counted());
    if !timed.is_empty() {
        time(&timed, &mut report, &pools, arguments)?;
    }
    if !counted.is_empty() {
        count_messages(&mut report, arguments)?;
    }
    if arguments.json { print(&report.json()) } else { Ok(()) }
}

/// The kernels that are measured in seconds.
fn time(
    groups: &[Group],
    report: &mut Report,
    pools: &[ThreadPool; 2],
    arguments: &BenchArguments,
) -> Result<(), Failure> {
    if !arguments.json {
        print(&report.heading())?;
    }
    for dimension in arguments.dimensions() {
        for &group in groups {
            let mut growth = Growth::default();
            for order in arguments.orders() {
                for measurement in measure(group, size(arguments, dimension, order), pools, arguments)? {
                    report.rows.push(growth.of(measurement).against(&report.machine));
                    if let (false, Some(row)) = (arguments.json, report.rows.last()) {
                        print(&row.to_string())?;
                    }
                }
            }
        }
    }
    Ok(())
}

/// The messages of ranks.
fn count_messages(report: &mut Report, arguments: &BenchArguments) -> Result<(), Failure> {
    if !arguments.json {
        print(MessageCount::HEADING)?;
    }
    for dimension in arguments.dimensions() {
        for order in arguments.orders() {
            let size = size(arguments, dimension, order);
            let rows = if dimension == 2 { messages::count::<2, 4>(size) } else { messages::count::<3, 5>(size) };
            for row in rows.map_err(Failure::solve)? {
                if !arguments.json {
                    print(&row.to_string())?;
                }
                report.messages.push(row);
            }
        }
    }
    Ok(())
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

/// The rows of one group at one order; none if the subject would not fit into memory.
fn measure(
    group: Group,
    size: Size,
    pools: &[ThreadPool; 2],
    arguments: &BenchArguments,
) -> Result<Vec<Measurement>, Failure> {
    let terminal = Terminal::default();
    if terminal.is_interactive() {
        terminal.print(&format!("measuring {} in {}-D, N = {}", group.name(), size.dimension, size.order));
    }
    match (group, size.dimension) {
        (Group::Elasticity, 2) => of::<Elastic<2>>(size, pools, arguments),
        (Group::Elasticity, _) => of::<Elastic<3>>(size, pools, arguments),
        (Group::Flow, 2) => of::<Flow<2, 4>>(size, pools, arguments),
        (Group::Flow, _) => of::<Flow<3, 5>>(size, pools, arguments),
        (Group::Preconditioner, 2) => {
            three::<Preconditioned<2, 4>, ByLines<2, 4>, ElasticSolvers<2>>(size, pools, arguments)
        }
        (Group::Preconditioner, _) => {
            three::<Preconditioned<3, 5>, ByLines<3, 5>, ElasticSolvers<3>>(size, pools, arguments)
        }
        (Group::Vectors, _) => of::<Vectors>(size, pools, arguments),
        (Group::Messages, _) => Ok(Vec::new()),
    }
}

/// The rows of three subjects.
fn three<A: Build, B: Build, C: Build>(
    size: Size,
    pools: &[ThreadPool; 2],
    arguments: &BenchArguments,
) -> Result<Vec<Measurement>, Failure> {
    let mut rows = of::<A>(size, pools, arguments)?;
    rows.extend(of::<B>(size, pools, arguments)?);
    rows.extend(of::<C>(size, pools, arguments)?);
    Ok(rows)
}

/// One subject for one thread and one for all, measured in turns, so that other load affects both alike.
fn of<B: Build>(size: Size, pools: &[ThreadPool; 2], arguments: &BenchArguments) -> Result<Vec<Measurement>, Failure> {
    let mut subjects = Vec::new();
    for pool in pools {
        match pool.install(|| B::build(size)).map_err(Failure::solve)? {
            Some(subject) => subjects.push(subject),
            None => return Ok(Vec::new()),
        }
    }
    let work = subjects[0].work();
    let best = stopwatch::in_turns(pools, arguments.seconds, work.len(), |pool, number| subjects[pool].run(number));
    let rows = work.into_iter().zip(best);
    Ok(rows.map(|(work, [one, all])| Measurement::new(size, work, one, all)).collect())
}
