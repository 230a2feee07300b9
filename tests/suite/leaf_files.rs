//! Leaf files, materials of models, edits.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use umbrage::leaf::edit::{Change, Channels, Edit};
use umbrage::leaf::files::{self, MapFormat};
use umbrage::leaf::import::{leaf_of_material, material_of_leaf};
use umbrage::leaf::species::{LeafSpecies, SPECIES};
use umbrage::leaf::{Face, LeafMaterial, Mode};
use umbrage::math::sampling::uniform;
use umbrage::scene::{DiffuseTransmission, Material, Model};

const SIZE: [u32; 2] = [40, 48];

fn write(leaf: &LeafMaterial, folder: &Path, format: MapFormat) -> std::path::PathBuf {
    for (name, bytes) in files::encode(leaf, "leaf", format).unwrap() {
        fs::write(folder.join(name), bytes).unwrap();
    }
    folder.join("leaf.toml")
}

fn largest_difference(a: &LeafMaterial, b: &LeafMaterial) -> f32 {
    let mut worst = 0.0_f32;
    for face in Face::ALL {
        let (sa, sb) = (a.sampler(face), b.sampler(face));
        for i in 0..(SIZE[0] * SIZE[1]) as usize {
            let (x, y) = (sa.of(i), sb.of(i));
            for c in 0..3 {
                worst = worst
                    .max((x.rho_d[c] - y.rho_d[c]).abs())
                    .max((x.rho_t[c] - y.rho_t[c]).abs())
                    .max((x.rho_s[c] - y.rho_s[c]).abs());
            }
            worst = worst.max((x.m - y.m).abs());
            worst = worst.max((a.coverage(i) - b.coverage(i)).abs());
        }
    }
    worst
}

#[test]
fn leaves_come_back_from_files() {
    let folder = tempfile::tempdir().unwrap();
    let mut leaf = LeafSpecies::parse("birch").unwrap().drawn(SIZE);
    leaf.upper.gloss = 1.5;
    let path = write(&leaf, folder.path(), MapFormat::Exr);
    let exact = files::read(&path).unwrap();
    assert_eq!(
        largest_difference(&leaf, &exact),
        0.0,
        "EXR keeps every bit"
    );
    let path = write(&leaf, folder.path(), MapFormat::Png);
    let near = files::read(&path).unwrap();
    assert!(largest_difference(&leaf, &near) < 1e-4, "PNG keeps 16 bits");
    // The paper's constants are kept, not taken anew from an edited leaf.
    leaf.mode = Mode::Paper;
    leaf.thickness_mm *= 2.0;
    let path = write(&leaf, folder.path(), MapFormat::Exr);
    let paper = files::read(&path).unwrap();
    assert_eq!(paper.upper.constants, leaf.upper.constants);
    assert_eq!(paper.mode, Mode::Paper);
}

/// What a person writes by hand.
#[test]
fn a_leaf_file_may_be_short() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("leaf.toml");
    let text = "umbrage_leaf = 1\nname = \"plain\"\nthickness = 0.2\n[upper]\n\
                reflectance = [0.1, 0.2, 0.05]\ntransmittance = [0.1, 0.15, 0.01]\n";
    fs::write(&path, text).unwrap();
    let leaf = files::read(&path).unwrap();
    let o = leaf.optics(Face::Lower);
    assert!(
        (o.rho_d[1] - 0.2).abs() < 1e-5 && (o.rho_t[1] - 0.15).abs() < 1e-5,
        "{o:?}"
    );
}

#[test]
fn broken_leaf_files_say_what_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let leaf = LeafSpecies::parse("vine").unwrap().drawn(SIZE);
    let path = write(&leaf, folder.path(), MapFormat::Png);
    let good = fs::read_to_string(&path).unwrap();
    let refused = |from: &str, to: &str, words: &[&str]| {
        assert!(good.contains(from), "{from} in {good}");
        fs::write(&path, good.replacen(from, to, 1)).unwrap();
        let error = files::read(&path).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        for word in words {
            assert!(error.to_string().contains(word), "{word} in {error}");
        }
    };
    refused(
        "thickness = 0.22",
        "thickness = -0.22",
        &["thickness", "> 0"],
    );
    refused("thickness = 0.22", "thickness = nan", &["thickness"]);
    refused("umbrage_leaf = 1", "umbrage_leaf = 9", &["version 9"]);
    refused("mode = \"exact\"", "mode = \"rough\"", &["rough"]);
    refused("name", "nom", &["nom"]);
    refused("sigma_a = [", "sigma_a = [-", &["upper", ">= 0"]);
    refused("sigma_a = ", "gamma_x = ", &["gamma_x"]);
    refused("leaf.mask.png", "none.png", &["none.png"]);
    refused("roughness = 0.3", "roughness = 2.0", &["roughness", "2"]);
    let small = LeafSpecies::parse("vine").unwrap().drawn([8, 8]);
    for (name, bytes) in files::encode(&small, "small", MapFormat::Png).unwrap() {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    refused("leaf.mask.png", "small.mask.png", &["8x8", "40x48"]);
    refused(
        "leaf.upper.specular.png",
        "small.upper.specular.png",
        &["8x8"],
    );
    fs::write(folder.path().join("text.png"), "no image").unwrap();
    refused("leaf.upper.specular.png", "text.png", &["text.png"]);
}

/// The measured colours are the means of the drawn leaves, and the leaves look like leaves: veins
/// are thicker and darker against the light.
#[test]
fn drawn_leaves_have_the_measured_colours() {
    for species in SPECIES {
        let leaf = species.drawn([96, 96]);
        leaf.check().unwrap();
        for face in Face::ALL {
            let o = leaf.optics(face);
            let wanted = species.diffuse(face);
            for c in 0..3 {
                assert!(
                    (f64::from(o.rho_d[c]) - wanted[c]).abs() < 0.01 * wanted[c] + 1e-4,
                    "{} {face:?} {c}: {o:?} {wanted:?}",
                    species.name
                );
                // One thickness for three channels: green is matched.
                let off = (f64::from(o.rho_t[c]) - species.through[c]).abs();
                assert!(
                    off < 0.1 * species.through[c] + 0.002,
                    "{} {face:?} {c}: {o:?}",
                    species.name
                );
            }
        }
        if species.name == "needle" {
            continue;
        }
        let sampler = leaf.sampler(Face::Upper);
        let through = |x: f32| sampler.at([x, 0.6]).rho_t[1];
        assert!(
            through(0.5) < 0.75 * through(0.56),
            "{}: midrib",
            species.name
        );
        let mask = leaf.mask.as_ref().unwrap();
        let share = mask.iter().sum::<f32>() / mask.len() as f32;
        assert!((0.1..0.7).contains(&share), "{}: {share}", species.name);
    }
}

/// Whatever is edited, no more comes out than fell in.
#[test]
fn random_edits_keep_the_energy() {
    for i in 0..40u32 {
        let u = |k: u32| uniform(3, 16 * i + k);
        let species = &SPECIES[i as usize % SPECIES.len()];
        let mut leaf = species.drawn([16, 16]);
        let times = |k: u32| Change::Times((10.0 * (u(k) - 0.5)).exp2());
        let edit = Edit {
            thickness: Some(times(0)),
            sigma_a: Some(Channels([times(1), times(2), times(3)])),
            sigma_s: Some(Channels([times(4), times(5), times(6)])),
            roughness: Some(times(7)),
            ..Edit::default()
        };
        edit.apply(&mut leaf).unwrap();
        for face in Face::ALL {
            let sampler = leaf.sampler(face);
            for t in 0..256 {
                let o = sampler.of(t);
                for c in 0..3 {
                    let sum = o.rho_d[c] + o.rho_t[c];
                    assert!(
                        sum <= 1.0 + 1e-6 && o.rho_d[c] >= 0.0,
                        "{}: {o:?}",
                        species.name
                    );
                }
            }
        }
    }
}

#[test]
fn edits_say_what_they_mean() {
    assert_eq!("1.5x".parse::<Change>().unwrap(), Change::Times(1.5));
    assert_eq!(" 0.3".parse::<Change>().unwrap(), Change::To(0.3));
    for bad in ["", "x", "-1", "-1x", "nanx", "inf", "two"] {
        assert!(bad.parse::<Change>().is_err(), "{bad}");
    }
    assert!("1,2".parse::<Channels>().is_err());
    let mut leaf = LeafSpecies::parse("birch").unwrap().drawn(SIZE);
    let before = leaf.optics(Face::Upper);
    let edit = Edit {
        sigma_a: Some("1x,3x,1x".parse().unwrap()),
        face: Some(Face::Upper),
        ..Edit::default()
    };
    let lower = leaf.optics(Face::Lower);
    edit.apply(&mut leaf).unwrap();
    let after = leaf.optics(Face::Upper);
    assert!(after.rho_d[1] < before.rho_d[1] && after.rho_t[1] < before.rho_t[1]);
    assert!((after.rho_d[0] - before.rho_d[0]).abs() < 1e-3, "red stays");
    assert_eq!(leaf.optics(Face::Lower), lower, "the lower side stays");
    let edit = Edit {
        size: Some([20, 24]),
        ..Edit::default()
    };
    edit.apply(&mut leaf).unwrap();
    assert_eq!(leaf.size(), Some([20, 24]));
    for bad in [[0, 4], [4, 100_000]] {
        let edit = Edit {
            size: Some(bad),
            ..Edit::default()
        };
        assert!(edit.apply(&mut leaf.clone()).is_err());
    }
}

#[test]
fn materials_become_leaves() {
    let model = Model::default();
    let mut material = Material {
        name: "leaf".into(),
        base_color: [0.2, 0.4, 0.1, 1.0],
        roughness: 0.5,
        ..Material::default()
    };
    let plain = leaf_of_material(&model, &material)
        .unwrap()
        .optics(Face::Upper);
    assert!((plain.rho_d[1] - 0.4).abs() < 1e-4, "{plain:?}");
    assert!(
        (plain.rho_t[1] - 0.44).abs() < 1e-4 && plain.rho_t[2] < 0.02,
        "{plain:?}"
    );
    assert!((plain.m - 0.25).abs() < 1e-6);
    material.diffuse_transmission = Some(DiffuseTransmission {
        factor: 0.25,
        texture: None,
        color: [0.4, 0.8, 0.04],
        color_texture: None,
    });
    let o = leaf_of_material(&model, &material)
        .unwrap()
        .optics(Face::Lower);
    for c in 0..3 {
        assert!(
            (o.rho_d[c] - 0.75 * material.base_color[c]).abs() < 1e-4,
            "{o:?}"
        );
        assert!(
            (o.rho_t[c] - 0.25 * [0.4, 0.8, 0.04][c]).abs() < 1e-4,
            "{o:?}"
        );
    }
    // White paint: scaled to what a leaf may give back.
    material.base_color = [1.0; 4];
    material.diffuse_transmission = None;
    let o = leaf_of_material(&model, &material)
        .unwrap()
        .optics(Face::Upper);
    assert!((0..3).all(|c| o.rho_d[c] + o.rho_t[c] < 0.96), "{o:?}");
}

/// What `light` makes of a material is what `leaf` does: `(1 - f) base` and `f tint`, as
/// `KHR_materials_diffuse_transmission` defines them, over what is visible of the texture.
#[test]
fn light_and_leaf_read_materials_alike() {
    use umbrage::leaf::optics::Optics;
    use umbrage::scene::{AlphaMode, ImageSource, Texture, TextureRef};
    let mut model = Model::default();
    // A green half that is seen and a red one that is not; then a grey tint.
    for texels in [[[60, 180, 30, 255], [250, 0, 0, 10]], [[188; 4], [188; 4]]] {
        model.images.push(ImageSource::Rgba8 {
            name: "half".into(),
            width: 2,
            height: 1,
            pixels: texels.concat().into(),
        });
        model.textures.push(Texture {
            image: model.images.len() - 1,
            ..Texture::default()
        });
    }
    let mut material = Material {
        name: "leaf".into(),
        base_color: [0.9, 0.8, 0.7, 1.0],
        base_color_texture: Some(TextureRef::new(0)),
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        metallic: 1.0,
        diffuse_transmission: Some(DiffuseTransmission {
            factor: 0.3,
            texture: None,
            color: [0.5, 0.9, 0.2],
            color_texture: Some(TextureRef::new(1)),
        }),
        ..Material::default()
    };
    let linear = umbrage::math::colour::srgb8_to_linear;
    let light = Optics::of_material(&model, &material).unwrap();
    let leaf = leaf_of_material(&model, &material).unwrap();
    let leaf = leaf.optics(Face::Upper);
    for c in 0..3 {
        let base = [0.9, 0.8, 0.7][c] * linear([60, 180, 30][c]);
        let rho_d = 0.7 * base;
        let rho_t = 0.3 * [0.5, 0.9, 0.2][c] * linear(188);
        assert!(
            (light.rho_d_front[c] - rho_d).abs() < 1e-5,
            "{c}: {light:?}"
        );
        assert!((light.rho_d_back[c] - rho_d).abs() < 1e-5, "{c}: {light:?}");
        assert!((light.rho_t[c] - rho_t).abs() < 1e-5, "{c}: {light:?}");
        // The leaf is a slab that is inverted by a table.
        assert!(
            (leaf.rho_d[c] - rho_d).abs() < 2e-3,
            "{c}: {leaf:?} {rho_d}"
        );
        assert!(
            (leaf.rho_t[c] - rho_t).abs() < 2e-3,
            "{c}: {leaf:?} {rho_t}"
        );
    }
    material.diffuse_transmission = None;
    let light = Optics::of_material(&model, &material).unwrap();
    assert_eq!(light.rho_t, [0.0; 3], "nothing is told");
}

/// A leaf as a glTF material, and that material as a leaf: the same colours from both sides.
#[test]
fn leaves_become_materials_and_leaves_again() {
    for name in ["goldenrod", "birch-autumn"] {
        let leaf = LeafSpecies::parse(name).unwrap().drawn(SIZE);
        let mut model = Model::default();
        let material = material_of_leaf(&leaf, &mut model).unwrap();
        let factor = material.diffuse_transmission.as_ref().unwrap().factor;
        assert!((0.0..=1.0).contains(&factor));
        let again = leaf_of_material(&model, &material).unwrap();
        let o = again.optics(Face::Upper);
        let sides = Face::ALL.map(|f| leaf.optics(f));
        for c in 0..3 {
            let mean = 0.5 * (sides[0].rho_d[c] + sides[1].rho_d[c]);
            assert!(
                (o.rho_d[c] - mean).abs() < 0.02 * mean + 0.002,
                "{name} {c}: {o:?} {sides:?}"
            );
            let mean = 0.5 * (sides[0].rho_t[c] + sides[1].rho_t[c]);
            assert!(
                (o.rho_t[c] - mean).abs() < 0.03 * mean + 0.002,
                "{name} {c}: {o:?} {sides:?}"
            );
        }
        // Veins stay thicker than the blade.
        let (was, is) = (leaf.sampler(Face::Upper), again.sampler(Face::Upper));
        for place in [[0.5, 0.6], [0.57, 0.6]] {
            let (a, b) = (was.at(place).rho_t[1], is.at(place).rho_t[1]);
            assert!((a - b).abs() < 0.15 * a, "{name} {place:?}: {a} {b}");
        }
    }
}

/// Plants of the generator wear the measured leaves.
#[test]
fn grown_plants_have_measured_leaves() {
    use umbrage::scene::grow::{GrowOptions, Species, grow};
    for species in Species::ALL {
        let options = GrowOptions {
            leaves: Some(200),
            ..GrowOptions::default()
        };
        let model = grow(species, &options).unwrap();
        let names: Vec<String> = model
            .materials
            .iter()
            .map(|m| leaf_of_material(&model, m).unwrap().name)
            .collect();
        let known = LeafSpecies::of_plant(species.name()).unwrap().name;
        assert_eq!(names[0], "bark");
        assert_eq!(names[1], known);
    }
}

#[test]
fn unsound_leaves_are_refused() {
    let good = LeafSpecies::parse("maize").unwrap().drawn(SIZE);
    let refused = |change: fn(&mut LeafMaterial), word: &str| {
        let mut leaf = good.clone();
        change(&mut leaf);
        let error = leaf.check().unwrap_err().to_string();
        assert!(
            error.contains("maize") && error.contains(word),
            "{word} in {error}"
        );
    };
    refused(|l| l.thickness_mm = 0.0, "thickness");
    refused(|l| l.upper.sigma_s[2] = f64::NAN, "sigma_s");
    refused(|l| l.lower.m = 0.0, "roughness");
    refused(|l| l.upper.rho_s[0] = 1.2, "rho_s");
    refused(|l| l.mask = Some(Arc::from(vec![1.0; 3])), "mask has 3");
    refused(
        |l| Arc::make_mut(l.upper.maps.as_mut().unwrap()).gamma_delta[41][3] = -1.5,
        "column 1, row 1",
    );
}
