//! The device's side of a plan: uploads once, draws any of the planned views.

use super::image::Picture;
use super::plan::Plan;
use super::settings::RenderSettings;
use super::subject::Subject;
use super::view::View;
use crate::gpu::Gpu;
use crate::{Error, Result};

/// A finished view and what it took.
#[derive(Debug, Clone)]
pub struct Rendered {
    /// The picture.
    pub picture: Picture,
}

/// Everything a plan asked for, on the device.
#[derive(Debug)]
pub struct Renderer {}

impl Renderer {
    /// Uploads what `plan` says.
    ///
    /// # Errors
    /// A texture that cannot be decoded, a device out of memory.
    pub fn new(
        _gpu: &Gpu,
        _subject: &Subject<'_>,
        _settings: &RenderSettings,
        _plan: Plan,
    ) -> Result<Self> {
        Err(Error::Unsupported("rendering is not there yet".into()))
    }

    /// Draws one of the plan's views.
    ///
    /// # Errors
    /// A view that is not in the plan, a lost device.
    pub fn render_view(&mut self, _view: View) -> Result<Rendered> {
        Err(Error::Unsupported("rendering is not there yet".into()))
    }
}
