//! `[parallel]`

use super::one_of::{self, OneOf};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize};
use std::borrow::Cow;

/// Work on several machines: `mpirun -n 4 stsolve run CASE`, of a program that is built with MPI.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Parallel {
    /// The number of blocks into which the cells of a flow are cut. The processes share them evenly, so at least one per process is needed.
    /// Results depend on the blocks within the tolerance of Newton's method. They do not depend on the number of processes or threads.
    pub blocks: usize,
    /// The number of groups of cells that the preconditioner `"blocks"` eliminates one after the other, in all blocks at the same time.
    /// `"exact"` keeps the order of elimination of a mesh in one block. More groups save iterations if there are many blocks, but cost
    /// messages: each group takes some rounds of messages in a sweep. Default: 1, or `"exact"` if blocks have fewer than 40 cells, many of which
    /// are at cuts.
    pub stages: Option<Stages>,
}

impl Default for Parallel {
    fn default() -> Self {
        Parallel { blocks: 1, stages: None }
    }
}

/// A number of stages.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Stages {
    /// So many groups of cells.
    Number(usize),
    /// `exact`: as many as keep the order.
    Name(String),
}

impl OneOf for Stages {
    type Entry = ();
    const EXPECTED: &'static str = "a whole number from 1, or \"exact\"";
    const OF_TEXT: fn(String) -> Self = Stages::Name;
    const OF_WHOLE: Option<fn(usize) -> Self> = Some(Stages::Number);
}

impl<'de> Deserialize<'de> for Stages {
    fn deserialize<S: Deserializer<'de>>(deserializer: S) -> Result<Self, S::Error> {
        one_of::deserialize(deserializer)
    }
}

impl JsonSchema for Stages {
    fn schema_name() -> Cow<'static, str> {
        "Stages".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": ["string", "integer"], "description": "A whole number from 1, or \"exact\"." })
    }
}
