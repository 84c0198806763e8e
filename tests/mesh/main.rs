//! Meshes: their promises as structures, and their error against the exact density.

#![expect(
    clippy::unwrap_used,
    reason = "a fixture that cannot be read fails the test"
)]

mod checks;
#[expect(dead_code, reason = "other tests take more of it")]
#[path = "../common/mod.rs"]
mod common;
mod corners;
mod fewest;
mod growth;
mod halving;
mod outlines;
mod profiles;
mod random;
mod sinks;
mod strips;
