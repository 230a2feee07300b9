//! Settings from their defaults, the scene file and the command line, in this order.

use super::cli::chosen::{Chosen, SettingTable};
use crate::Result;
use crate::foliage::Settings;
use crate::render::RenderSettings;
use crate::scene::SceneFile;

/// Settings of the foliage.
///
/// # Errors
/// An unknown name or a value outside its range.
pub fn foliage_settings<T: SettingTable>(
    scene: Option<&SceneFile>,
    chosen: &Chosen<T>,
) -> Result<Settings> {
    let mut settings = Settings::default();
    for (name, value) in scene.iter().flat_map(|s| &s.foliage) {
        settings.set(name, &value.to_string())?;
    }
    for (name, value) in chosen.values() {
        settings.set(name, value)?;
    }
    settings.check()?;
    Ok(settings)
}

/// Settings of the picture.
///
/// # Errors
/// An unknown name or a value outside its range.
pub fn picture_settings<T: SettingTable>(
    scene: Option<&SceneFile>,
    chosen: &Chosen<T>,
) -> Result<RenderSettings> {
    let mut settings = RenderSettings::default();
    for (name, value) in scene.iter().flat_map(|s| &s.picture) {
        settings.set(&name.replace('_', "-"), &value.to_string())?;
    }
    for (name, value) in chosen.values() {
        settings.set(name, value)?;
    }
    settings.check()?;
    Ok(settings)
}

/// What is foliage: the command line before the scene file.
#[must_use]
pub fn foliage_pattern<'a>(
    scene: Option<&'a SceneFile>,
    given: Option<&'a str>,
) -> Option<&'a str> {
    given.or_else(|| scene?.foliage_pattern.as_deref())
}
