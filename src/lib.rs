//! umbrage bakes, lights and draws foliage with Vulkan compute and graphics queues.
//!
//! The library is organised in rooms whose dependencies point one way:
//!
//! ```text
//! app -> render -> {foliage, leaf, ink} -> gpu  technique and programs over the mechanism
//!   \       \         \
//!    +-------+---------+--> scene, math, abi, error
//! reference -> math, scene, abi, error   the same kernels in f64 on the CPU, never Vulkan
//! ```
//!
//! `ARCHITECTURE.md` says why; `tests/suite/architecture.rs` enforces it.
#![deny(unsafe_code)]

pub mod abi;
pub mod app;
pub mod error;
pub mod foliage;
pub mod gpu;
pub mod ink;
pub mod leaf;
pub mod math;
pub mod reference;
pub mod render;
pub mod scene;

pub use error::{Error, Result};
