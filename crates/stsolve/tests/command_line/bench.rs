//! `stsolve bench` measures what it is asked for.

use crate::outcome;
use std::path::Path;

/// The smallest measurement of every group: counted quantities are present and positive; seconds are not tested.
#[test]
fn bench_as_json_has_the_roofs_and_a_row_per_kernel() {
    let arguments = ["bench", "--json", "--orders", "2", "--dimension", "2", "--nodes", "8", "--seconds", "0"];
    let (code, stdout, stderr) = outcome(Path::new("."), &arguments);
    let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((code, stderr.as_str()), (0, ""));
    for roof in ["gflops_one", "gflops_all", "gbytes_one", "gbytes_all"] {
        assert!(json["machine"][roof].as_f64().unwrap() > 0.0, "{roof}");
    }
    let rows = json["rows"].as_array().unwrap();
    let of = |kernel: &str| rows.iter().find(|row| row["kernel"] == kernel).unwrap();
    // The peak was once a twentieth of that of the kernels: the crate that measured it was not optimised.
    let peak = json["machine"]["gflops_one"].as_f64().unwrap();
    assert!(cfg!(debug_assertions) || peak > of("product")["gflops"].as_f64().unwrap(), "{peak}");
    for kernel in ["elasticity operator", "residual", "product", "FGMRES vectors"] {
        assert!(of(kernel)["gflops"].as_f64().unwrap() > 0.0, "{kernel}");
    }
    for kernel in ["product with mesh", "preconditioner", "preconditioner set-up", "elasticity solve"] {
        assert!(of(kernel)["million_per_second"].as_f64().unwrap() > 0.0, "{kernel}");
    }
    // 4 x 4 cells, 2 nodes in time, 4 components, 2 x 2 nodes.
    assert_eq!(of("residual")["unknowns"], 512.0);
}

/// What ranks send is within 5 % of the model of docs/src/clusters.md.
#[test]
fn bench_counts_messages_beside_their_model() {
    let (code, stdout, _) = outcome(Path::new("."), &["bench", "--json", "--kernel", "messages", "--orders", "3,4"]);
    assert_eq!(code, 0);
    let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    let rows = json["messages"].as_array().unwrap();
    assert_eq!(rows.len(), 2 * 2 * 4);
    for row in rows {
        let of = |quantity: &str| ["counted", "model"].map(|which| row[which][quantity].as_f64().unwrap());
        let ([messages, most], [bytes, model]) = (of("messages"), of("bytes"));
        assert!((bytes - model).abs() <= 0.05 * model, "{row}");
        // A rank of which all cells at a cut come first has nothing for the neighbour on the way back.
        let fewest = if row["kernel"] == "application, blocks" { most / 2.0 } else { most };
        assert!((fewest..=most).contains(&messages), "{row}");
    }
}

#[test]
fn bench_refuses_what_it_cannot_measure() {
    for (option, value) in [("--orders", "1"), ("--orders", "17"), ("--kernel", "gpu"), ("--seconds", "nan")] {
        let arguments = ["bench", option, value];
        let (code, _, stderr) = outcome(Path::new("."), &arguments);
        assert_eq!(code, 2);
        assert!(stderr.contains(value), "{stderr}");
    }
}
