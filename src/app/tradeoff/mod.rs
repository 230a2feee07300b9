//! `umbrage tradeoff`.
pub mod truth;
