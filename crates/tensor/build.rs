//! With the feature `this-machine`: selects the instruction set of `pulp` that the compiling machine has.

use std::env::{var, var_os};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(instructions, values(\"v3\", \"v4\"))");
    // The features of another processor are not known here.
    let for_here = var("TARGET").ok() == var("HOST").ok();
    if var_os("CARGO_FEATURE_THIS_MACHINE").is_some()
        && for_here
        && let Some(set) = best_here()
    {
        println!("cargo::rustc-cfg=instructions=\"{set}\"");
    }
}

#[cfg(target_arch = "x86_64")]
fn best_here() -> Option<&'static str> {
    macro_rules! has {
        ($($feature:tt),*) => { $(std::is_x86_feature_detected!($feature))&&* };
    }
    let v3 = has!("avx", "avx2", "fma", "bmi1", "bmi2", "lzcnt", "popcnt");
    let v4 = v3 && has!("avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl");
    if v4 { Some("v4") } else { v3.then_some("v3") }
}

#[cfg(not(target_arch = "x86_64"))]
fn best_here() -> Option<&'static str> {
    None
}
