//! Settings from their defaults, the scene file and the command line, in this order.

use super::cli::chosen::{Chosen, SettingTable};
use super::cli::tables;
use crate::foliage::{self, Settings};
use crate::render::{self, RenderSettings};
use crate::scene::SceneFile;
use crate::{Error, Result};

/// Settings of the foliage.
///
/// # Errors
/// An unknown name or a value outside its range: the option, or file, table and key.
pub fn foliage_settings<T: SettingTable>(
    scene: Option<&SceneFile>,
    chosen: &Chosen<T>,
) -> Result<Settings> {
    let mut settings = Settings::default();
    if let Some(scene) = scene {
        for (name, value) in &scene.foliage {
            put_foliage(&mut settings, name, &value.to_string())
                .map_err(|e| in_scene(scene, "foliage", name, &e))?;
        }
    }
    for (name, value) in chosen.values() {
        put_foliage(&mut settings, name, value).map_err(|e| on_command_line(name, &e))?;
    }
    Ok(settings)
}

/// Settings of the picture.
///
/// A scene whose baked files leave it to the viewer to turn normals over on the back of leaves
/// (`back_faces = "flipped"`) is drawn as such a viewer draws it.
///
/// # Errors
/// An unknown name or a value outside its range: the option, or file, table and key.
pub fn picture_settings<T: SettingTable>(
    scene: Option<&SceneFile>,
    chosen: &Chosen<T>,
) -> Result<RenderSettings> {
    let mut settings = RenderSettings::default();
    if let Some(scene) = scene {
        let flipped = foliage::BackFaces::Flipped.name();
        settings.flip_back_faces = scene.foliage.iter().any(|(name, value)| {
            name.replace('-', "_") == "back_faces" && value.to_string() == flipped
        });
        for (name, value) in &scene.picture {
            put_picture(&mut settings, name, &value.to_string())
                .map_err(|e| in_scene(scene, "picture", name, &e))?;
        }
    }
    for (name, value) in chosen.values() {
        put_picture(&mut settings, name, value).map_err(|e| on_command_line(name, &e))?;
    }
    Ok(settings)
}

fn put_foliage(settings: &mut Settings, name: &str, value: &str) -> Result<()> {
    let wanted = name.replace('-', "_");
    let taken = || foliage::SETTINGS.iter().filter(|s| tables::is_taken(s));
    match taken().find(|s| s.name == wanted) {
        Some(info) => settings.put(info, value),
        None => Err(unknown(taken().map(|s| s.name.to_owned()))),
    }
}

fn put_picture(settings: &mut RenderSettings, name: &str, value: &str) -> Result<()> {
    let wanted = name.replace('_', "-");
    match render::SETTINGS.iter().find(|s| s.name == wanted) {
        Some(info) => (info.set)(settings, value),
        None => {
            let names = render::SETTINGS.iter().map(|s| s.name.replace('-', "_"));
            Err(unknown(names))
        }
    }
}

fn unknown(names: impl Iterator<Item = String>) -> Error {
    let names: Vec<String> = names.collect();
    Error::usage(format!(
        "there is no such setting; there are {}",
        names.join(", ")
    ))
}

fn in_scene(scene: &SceneFile, table: &str, name: &str, error: &Error) -> Error {
    Error::file(&scene.path, format!("[{table}] {name}: {error}"))
}

fn on_command_line(name: &str, error: &Error) -> Error {
    Error::usage(format!("--{name}: {error}"))
}

/// What is foliage: the command line before the scene file.
#[must_use]
pub fn foliage_pattern<'a>(
    scene: Option<&'a SceneFile>,
    given: Option<&'a str>,
) -> Option<&'a str> {
    given.or_else(|| scene?.foliage_pattern.as_deref())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::app::cli::tables::{FoliageTable, PictureTable};

    fn scene(text: &str) -> SceneFile {
        let text = format!("{text}\n[[plants]]\nmodel = 'a.glb'");
        SceneFile::parse(&text, Path::new("wood.toml")).unwrap()
    }

    #[test]
    fn what_is_wrong_in_a_scene_is_told_by_file_table_and_key() {
        for (text, expected) in [
            (
                "[foliage]\nrho = -1",
                "wood.toml: [foliage] rho: must be above 0, not -1",
            ),
            (
                "[foliage]\nk_min = 'dark'",
                "wood.toml: [foliage] k_min: \"dark\" is not a number",
            ),
            ("[foliage]\ncells = '1e3'", "wood.toml: [foliage] cells: "),
            (
                "[foliage]\nencoding = 'length'",
                "wood.toml: [foliage] encoding: there is no such setting; there are ",
            ),
            ("[foliage]\nroh = 1", "rho, rho_ambient"),
        ] {
            let chosen = Chosen::<FoliageTable>::default();
            let error = foliage_settings(Some(&scene(text)), &chosen).expect_err(text);
            assert!(error.to_string().contains(expected), "{text}: {error}");
        }
        for (text, expected) in [
            ("[picture]\nsize = 3", "wood.toml: [picture] size: "),
            (
                "[picture]\nsise = '3x4'",
                "wood.toml: [picture] sise: there is no such",
            ),
            ("[picture]\nsise = '3x4'", "shadow_size"),
        ] {
            let chosen = Chosen::<PictureTable>::default();
            let error = picture_settings(Some(&scene(text)), &chosen).expect_err(text);
            assert!(error.to_string().contains(expected), "{text}: {error}");
            assert!(
                !error.to_string().contains("--"),
                "no option was given: {error}"
            );
        }
    }

    #[test]
    fn scenes_write_names_with_either_stroke_and_say_how_backs_are_drawn() {
        let scene =
            scene("[picture]\nshadow_size = 512\nfov = 20\n[foliage]\nback_faces = 'flipped'");
        let picture = picture_settings(Some(&scene), &Chosen::<PictureTable>::default()).unwrap();
        assert_eq!((picture.shadow_size, picture.fov), (512, 20.0), "read");
        assert!(picture.flip_back_faces, "drawn as the baked files are");
    }
}
