//! The `umbrage` program.
fn main() {}
