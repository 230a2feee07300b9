//! umbrage bakes, lights and draws foliage with Vulkan.
#![deny(unsafe_code)]

pub mod abi;
pub mod app;
pub mod error;
pub mod gpu;
pub mod math;
pub mod scene;

pub use error::{Error, Result};
