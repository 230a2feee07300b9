//! A model read, flattened and split: what every command on foliage starts from.

use super::Context;
use super::bake::bake;
use super::cli::chosen::{Chosen, SettingTable};
use super::cli::commands::ModelArgs;
use super::input::{Input, Source};
use super::settings::{foliage_pattern, foliage_settings};
use super::timing::Timings;
use crate::Result;
use crate::foliage::bake::Baked;
use crate::foliage::{Settings, Split};
use crate::scene::Geometry;

/// A model in the frame that the foliage room works in.
#[derive(Debug)]
pub struct Prepared {
    /// What was read.
    pub input: Input,
    /// Its triangles.
    pub geometry: Geometry,
    /// Settings of the foliage.
    pub settings: Settings,
    pattern: Option<String>,
}

impl Prepared {
    /// Reads and flattens `source`; `model` names its textures and says what is foliage.
    ///
    /// # Errors
    /// Wrong input, or settings outside their range.
    pub fn new<T: SettingTable>(
        source: &Source,
        model: &ModelArgs,
        chosen: &Chosen<T>,
        timings: &mut Timings,
    ) -> Result<Self> {
        // What is wrong on the command line is told before a large file is read.
        foliage_settings(None, chosen)?;
        let input = timings.measure("read", || Input::load(source, &model.textures))?;
        let settings = foliage_settings(input.scene.as_ref(), chosen)?;
        let geometry = timings.measure("flatten", || Geometry::flatten(&input.model));
        for warning in &geometry.warnings {
            log::warn!("{}: {warning}", input.model.name);
        }
        let pattern =
            foliage_pattern(input.scene.as_ref(), model.foliage.as_deref()).map(str::to_owned);
        Ok(Self {
            input,
            geometry,
            settings,
            pattern,
        })
    }

    /// Foliage and covered parts.
    ///
    /// # Errors
    /// The model has no foliage; its materials are listed.
    pub fn split(&self) -> Result<Split> {
        Split::new(&self.input.model, &self.geometry, self.pattern.as_deref())
    }

    /// The same for what works without foliage, too.
    ///
    /// # Errors
    /// A pattern that is no regular expression.
    pub fn split_with_or_without(&self) -> Result<Split> {
        Split::with_or_without(&self.input.model, &self.geometry, self.pattern.as_deref())
    }

    /// The same for what draws bare plants: a pattern that nothing has is a mistake.
    ///
    /// # Errors
    /// A pattern that is no regular expression, or that no foliage has.
    pub fn split_or_bare(&self) -> Result<Split> {
        match self.pattern {
            Some(_) => self.split(),
            None => self.split_with_or_without(),
        }
    }

    /// The bake, computed or found in the cache.
    ///
    /// # Errors
    /// No foliage, or what the bake refuses.
    pub fn bake(&self, context: &Context, timings: &mut Timings) -> Result<Baked> {
        let split = timings.measure("split", || self.split())?;
        let (model, geometry) = (&self.input.model, &self.geometry);
        let baked = timings.measure("bake", || {
            bake(context, model, geometry, &split, &self.settings)
        })?;
        timings.add_passes(&baked.times);
        Ok(baked)
    }
}
