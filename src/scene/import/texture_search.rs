//! Finding a material's colour texture among the images beside a model, by name.
//!
//! Old plant libraries ship OBJ files whose MTL names no image, beside `Tree_Bark.jpg` and
//! `Birch_Leaves_Green.png`. Names are compared word by word.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Words that say nothing about which material an image is for.
const NEUTRAL: &[&str] = &[
    "albedo",
    "alpha",
    "base",
    "basecolor",
    "col",
    "color",
    "colour",
    "diff",
    "diffuse",
    "green",
    "mat",
    "material",
    "map",
    "plant",
    "rgba",
    "tex",
    "texture",
    "tree",
];

/// Words of images that are not colours.
const NOT_COLOR: &[&str] = &[
    "ao",
    "arm",
    "bump",
    "disp",
    "displacement",
    "gloss",
    "height",
    "mask",
    "metal",
    "metallic",
    "metalness",
    "nor",
    "norm",
    "normal",
    "normals",
    "nrm",
    "occlusion",
    "opacity",
    "orm",
    "rough",
    "roughness",
    "spec",
    "specular",
    "sss",
    "translucency",
];

/// What the search found.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Found {
    /// The one best image.
    One(PathBuf),
    /// Several fit equally well.
    Several(Vec<PathBuf>),
    /// Nothing fits.
    Nothing,
}

/// PNG and JPEG files in `folder`, sorted.
pub(super) fn images_in(folder: &Path) -> Vec<PathBuf> {
    let is_image = |p: &PathBuf| {
        p.extension()
            .and_then(|e| e.to_str())
            .is_some_and(|e| ["png", "jpg", "jpeg"].contains(&e.to_ascii_lowercase().as_str()))
    };
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut out: Vec<PathBuf> = entries.map(|e| e.path()).filter(is_image).collect();
    out.sort();
    out
}

/// The image for `material` of the model called `stem`.
pub(super) fn find(images: &[PathBuf], material: &str, stem: &str) -> Found {
    let wanted = words(material);
    let model = words(stem);
    let telling = |set: &BTreeSet<String>| -> BTreeSet<String> {
        let neutral = |w: &&String| !NEUTRAL.contains(&w.as_str());
        set.iter().filter(neutral).cloned().collect()
    };
    if telling(&wanted).is_empty() {
        return Found::Nothing;
    }
    // Fewest words foreign to material and model first, then most words shared with the model.
    let mut ranked: Vec<((usize, usize, usize), &PathBuf)> = Vec::new();
    for path in images {
        let name = path
            .file_stem()
            .and_then(|s| s.to_str())
            .unwrap_or_default();
        let have = words(name);
        if have.iter().any(|w| NOT_COLOR.contains(&w.as_str()))
            || !telling(&wanted).is_subset(&have)
        {
            continue;
        }
        let foreign = telling(&have)
            .iter()
            .filter(|w| !wanted.contains(*w) && !model.contains(*w))
            .count();
        let shared = have.intersection(&model).count();
        let inexact = usize::from(!name.eq_ignore_ascii_case(material));
        ranked.push(((inexact, foreign, usize::MAX - shared), path));
    }
    let Some(best) = ranked.iter().map(|r| r.0).min() else {
        return Found::Nothing;
    };
    let mut winners: Vec<PathBuf> = ranked
        .into_iter()
        .filter(|r| r.0 == best)
        .map(|r| r.1.clone())
        .collect();
    if winners.len() == 1 {
        Found::One(winners.remove(0))
    } else {
        Found::Several(winners)
    }
}

/// Lower-case words, split at signs, digits and inner capitals; leaves become leaf.
fn words(name: &str) -> BTreeSet<String> {
    let mut out = BTreeSet::new();
    let mut word = String::new();
    let mut previous_lower = false;
    for c in name.chars().chain(std::iter::once(' ')) {
        if !c.is_alphabetic() || (c.is_uppercase() && previous_lower) {
            let w = std::mem::take(&mut word);
            if !w.is_empty() {
                out.insert(match w.as_str() {
                    "leaves" | "leafs" => "leaf".into(),
                    "needles" => "needle".into(),
                    "branches" => "branch".into(),
                    _ => w,
                });
            }
        }
        previous_lower = c.is_lowercase();
        if c.is_alphabetic() {
            word.extend(c.to_lowercase());
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn images(names: &[&str]) -> Vec<PathBuf> {
        names.iter().map(PathBuf::from).collect()
    }

    #[test]
    fn names_of_a_real_library_are_resolved() {
        let kit = images(&[
            "Birch_Bark.png",
            "Birch_Leaves_Green.png",
            "Pine_Leaves.png",
            "Tree_Bark.jpg",
            "Tree_Leaves.png",
            "Tree_Leaves_normal.png",
        ]);
        let found = |material, stem| match find(&kit, material, stem) {
            Found::One(p) => p.to_string_lossy().into_owned(),
            other => format!("{other:?}"),
        };
        assert_eq!(found("Birch_Leaves", "Birch_1"), "Birch_Leaves_Green.png");
        assert_eq!(found("Birch_Bark", "Birch_1"), "Birch_Bark.png");
        assert_eq!(found("Bark", "Tree_3"), "Tree_Bark.jpg");
        assert_eq!(found("Bark", "Pine_2"), "Tree_Bark.jpg");
        assert_eq!(found("Bark", "Birch_2"), "Birch_Bark.png");
        assert_eq!(found("Tree_Leaves", "Tree_3"), "Tree_Leaves.png");
        assert_eq!(found("PineLeaf", "x"), "Pine_Leaves.png");
        assert_eq!(find(&kit, "Stone", "Tree_3"), Found::Nothing);
        assert_eq!(find(&kit, "Material", "Tree_3"), Found::Nothing);
    }

    #[test]
    fn equal_candidates_are_reported_not_guessed() {
        let kit = images(&["Ash_Bark.png", "Elm_Bark.png"]);
        assert_eq!(find(&kit, "Bark", "oak"), Found::Several(kit.clone()));
    }
}
