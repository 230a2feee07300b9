//! Several styles in one picture: a region looks as in a picture of its style alone.

use std::collections::HashSet;

use glam::{DAffine3, DVec3, Vec3};
use regex::Regex;
use umbrage::foliage::{Leaves, Primitive, Split};
use umbrage::gpu::Gpu;
use umbrage::ink::leaves::LeafTriangles;
use umbrage::ink::mix::{Mask, Mix, MixPlan, Part, Span};
use umbrage::ink::plan::{Attribute, PASSES};
use umbrage::ink::plant::Plant;
use umbrage::ink::renderer::{Drawing, InkRenderer, InkScene};
use umbrage::ink::style::Style;
use umbrage::ink::view::View;
use umbrage::reference::ink as twin;
use umbrage::scene::grow::{self, GrowOptions, Species};
use umbrage::scene::textures::Rgba8;
use umbrage::scene::{Camera, Geometry, Model, Population};

use crate::fixture;
use crate::place::Place;

const SIZE: [u32; 2] = [320, 200];
/// Pixels that a pass of the styles below can see at most: the silhouettes' reach, and a line.
const REACH: i64 = 8;

/// Three shrubs in a row that goes away from the camera; the last has materials of its own.
fn row() -> Model {
    let options = GrowOptions {
        seed: 1,
        leaves: Some(500),
        ..GrowOptions::default()
    };
    let shrub = grow::grow(Species::Shrub, &options).unwrap();
    let at = |x: f64, z: f64| DAffine3::from_translation(DVec3::new(x, 0.0, z));
    let places = [at(-1.6, 0.0), at(0.0, -1.5), at(1.6, -3.0)];
    let mut dry = shrub.clone();
    for material in &mut dry.materials {
        material.name.insert_str(0, "dry ");
    }
    let plants = [(&shrub, places[0]), (&shrub, places[1]), (&dry, places[2])];
    let mut merged = Population::merge("row", &plants);
    for (range, name) in merged.instances.iter().zip(["left", "middle", "right"]) {
        for instance in range.clone() {
            merged.model.instances[instance].name = format!("{name} shrub");
        }
    }
    merged.model
}

struct Stage {
    model: Model,
    geometry: Geometry,
    split: Split,
    view: View,
}

impl Stage {
    fn new() -> Self {
        let model = row();
        let geometry = Geometry::flatten(&model);
        let split = Split::new(&model, &geometry, None).unwrap();
        let camera = Camera {
            eye: geometry.origin + DVec3::new(0.0, 0.6, 6.0),
            forward: DVec3::new(0.0, -0.05, -1.0).normalize(),
            fov: 40.0,
            aspect: f64::from(SIZE[0]) / f64::from(SIZE[1]),
            near: 0.01,
            roll: 0.0,
        };
        let sun = Vec3::new(0.5, 0.7, 0.5).normalize();
        let view = View::new(camera, geometry.origin, SIZE, sun, &geometry.positions);
        Self {
            model,
            geometry,
            split,
            view,
        }
    }

    /// Draws with the ids read back.
    fn draw(&self, gpu: &Gpu, mix: &Mix) -> Drawing {
        self.draw_changed(gpu, mix, |_| ())
    }

    /// Draws after `change` of the plant.
    fn draw_changed(&self, gpu: &Gpu, mix: &Mix, change: impl FnOnce(&mut Plant)) -> Drawing {
        let indices = &self.split.foliage_indices;
        let leaves = Leaves::new(&self.geometry.positions, indices, Primitive::Leaf);
        let triangles = LeafTriangles {
            indices,
            first: &leaves.first,
            triangles: &leaves.triangles,
        };
        let (model, geometry) = (&self.model, &self.geometry);
        let foliage = &self.split.foliage_parts;
        let mut plant = Plant::new(model, geometry, triangles, foliage, None, &mix.styles).unwrap();
        change(&mut plant);
        let scene = InkScene {
            model,
            geometry,
            plant: &plant,
        };
        let renderer = InkRenderer::new(gpu, &scene, mix, &self.view, 1).unwrap();
        renderer
            .draw_with(&scene, &self.view, &[Attribute::Ids])
            .unwrap()
    }
}

/// Two styles of different clusters, leaves, lines and strokes, without a bake.
fn styles() -> [Style; 2] {
    let style = |text: &str| {
        let head = "format_version = 1\ndescription = \"x\"\n";
        Style::parse(&format!("{head}{text}")).unwrap()
    };
    [
        style(
            "seed = 3\n[leaves]\ncluster_radius = 0.05\nsize = 1.4\nkept = 0.6\nshape = 0.4\n\
             [contour]\nstrength = 1.0\nthreshold = 0.01\n\
             [shading]\nstrength = 0.8\ncolour = 0.7\ncrown = 0.0\ndepth = 0.0\n",
        ),
        style(
            "seed = 4\n[leaves]\ncluster_radius = 0.09\ndisplacement = 0.7\nfacing = 0.5\n\
             orientation = 0.8\nsize = 2.0\n\
             [contour]\nstrength = 0.8\nthreshold = 0.03\nwidth = 2.0\ndetail = 2.0\n\
             [silhouette]\nstrength = 0.9\nwidth = 5.0\n[hatching]\nstrength = 1.0\n\
             [shading]\nstrength = 0.0\ncrown = 0.0\ndepth = 0.0\nambient = 0.2\n",
        ),
    ]
}

fn everything(style: usize) -> Part {
    Part {
        style,
        objects: None,
        materials: None,
        distance: None,
        window: None,
        mask: None,
    }
}

/// The rules that there are, each claiming some of the row for the second style.
fn rules() -> Vec<(&'static str, Part)> {
    // White on the right, and of another size than the picture.
    let (width, height) = (160, 100);
    let pixel = |i: usize| if i % width < 70 { [0; 4] } else { [255; 4] };
    let image = Rgba8 {
        width: width as u32,
        height: height as u32,
        pixels: (0..width * height).flat_map(pixel).collect(),
    };
    let mask = Mask {
        name: "mask".into(),
        image,
        values: [0.5, 1.0],
    };
    vec![
        (
            "objects",
            Part {
                objects: Some(Regex::new("right|middle").unwrap()),
                ..everything(1)
            },
        ),
        (
            "materials",
            Part {
                materials: Some(Regex::new("^dry").unwrap()),
                ..everything(1)
            },
        ),
        (
            "distance",
            Part {
                distance: Some(Span::Metres([0.0, 5.3])),
                ..everything(1)
            },
        ),
        (
            "mask",
            Part {
                mask: Some(mask),
                ..everything(1)
            },
        ),
    ]
}

fn mix(styles: Vec<Style>, parts: Vec<Part>) -> Mix {
    Mix {
        names: (0..styles.len()).map(|k| format!("s{k}")).collect(),
        styles,
        parts,
    }
}

/// Style of every pixel; none where nothing is.
fn owners(drawing: &Drawing) -> Vec<Option<u32>> {
    let (_, bytes) = &drawing.attributes[0];
    let ids: Vec<[f32; 2]> = bytemuck::pod_collect_to_vec(bytes);
    ids.iter()
        .map(|id| (id[0] > 0.0).then(|| twin::style_of(f64::from(id[0]))))
        .collect()
}

/// Whether all pixels about one are `own` or nothing.
fn is_inside(owners: &[Option<u32>], own: u32, at: i64) -> bool {
    let [w, h] = SIZE.map(i64::from);
    let (x, y) = (at % w, at / w);
    (-REACH..=REACH).all(|dy| {
        (-REACH..=REACH).all(|dx| {
            let (qx, qy) = ((x + dx).clamp(0, w - 1), (y + dy).clamp(0, h - 1));
            owners[(qy * w + qx) as usize].is_none_or(|o| o == own)
        })
    })
}

/// Pixels of `own` away from the border in both pictures, and how many of them differ from the
/// picture of the style alone.
fn compare(mixed: &Drawing, same: &Drawing, own: u32, alone: &Drawing) -> (usize, usize) {
    let (a, b) = (owners(mixed), owners(same));
    let pixel = |d: &Drawing, i: usize| d.pixels[8 * i..8 * i + 8].to_vec();
    let inside: Vec<usize> = (0..a.len())
        .filter(|&i| a[i] == Some(own))
        .filter(|&i| is_inside(&a, own, i as i64) && is_inside(&b, own, i as i64))
        .collect();
    let differ = inside
        .iter()
        .filter(|&&i| pixel(mixed, i) != pixel(alone, i));
    (inside.len(), differ.count())
}

/// The style without lines, strokes and light: leaves stand where they stood.
fn bare(style: &Style) -> Style {
    let mut style = style.clone();
    (style.contour.strength, style.silhouette.strength) = (0.0, 0.0);
    (style.hatching.strength, style.shading.strength) = (0.0, 0.0);
    style
}

#[test]
fn a_region_is_that_of_its_style_alone_whatever_the_rule() {
    let (gpu, stage) = (fixture::gpu(), Stage::new());
    let [a, b] = styles();
    let alone = [&a, &b].map(|s| stage.draw(&gpu, &Mix::single(s.clone())));
    for (rule, part) in rules() {
        let mixed = mix(vec![a.clone(), b.clone()], vec![part.clone()]);
        let mixed = stage.draw(&gpu, &mixed);
        // The same partition, with every leaf where the style in question puts it. Clusters that
        // decide are those of the first style: for the second one a third is the rest.
        let same_a = mix(vec![bare(&a), bare(&a)], vec![part.clone()]);
        let rest = vec![part.clone(), everything(2)];
        let same_b = mix(vec![bare(&a), bare(&b), bare(&b)], rest);
        for (own, same) in [(0, same_a), (1, same_b)] {
            let same = stage.draw(&gpu, &same);
            let of = |style: usize| compare(&mixed, &same, own, &alone[style]);
            let (inside, differ) = of(own as usize);
            assert!(inside > 400, "{rule}, style {own}: {inside} pixels inside");
            assert_eq!(differ, 0, "{rule}, style {own}: of {inside} pixels");
            // The comparison sees what it is about.
            let (_, other) = of(1 - own as usize);
            assert!(5 * other > inside, "{rule}: styles differ in {other}");
        }
        let styles: HashSet<_> = owners(&mixed).into_iter().flatten().collect();
        assert_eq!(styles, HashSet::from([0, 1]), "{rule}: both are there");
    }
}

#[test]
fn clusters_of_another_style_would_be_seen() {
    let (gpu, stage) = (fixture::gpu(), Stage::new());
    let [a, mut b] = styles();
    b.hatching.strength = 0.0;
    let (_, part) = rules().remove(0);
    let alone = stage.draw(&gpu, &Mix::single(b.clone()));
    let both = mix(vec![a.clone(), b.clone()], vec![part.clone()]);
    let same = mix(
        vec![bare(&a), bare(&b), bare(&b)],
        vec![part, everything(2)],
    );
    let same = stage.draw(&gpu, &same);
    let right = stage.draw(&gpu, &both);
    assert_eq!(compare(&right, &same, 1, &alone).1, 0);
    let wrong = stage.draw_changed(&gpu, &both, |plant| plant.set_of_style[1] = 0);
    let (inside, differ) = compare(&wrong, &same, 1, &alone);
    assert!(20 * differ > inside, "{differ} of {inside} pixels");
}

#[test]
fn a_further_style_adds_its_own_passes_and_nothing_else() {
    let (gpu, stage) = (fixture::gpu(), Stage::new());
    let [a, mut b] = styles();
    // Hatching is no pass of its own.
    b.hatching.strength = 0.0;
    let (_, part) = rules().remove(0);
    let both = mix(vec![a.clone(), b.clone()], vec![part]);
    let ran = |mix: &Mix| {
        let drawn = stage.draw(&gpu, mix).passes.into_iter().map(|p| p.label);
        let kind = |label: &String| label.split(',').next().unwrap_or_default().to_owned();
        drawn
            .filter(|l| PASSES.contains(&kind(l).as_str()))
            .collect::<Vec<_>>()
    };
    let together = ran(&both);
    assert_eq!(
        together,
        MixPlan::new(&both).passes(),
        "the plan is what ran"
    );
    let first = ran(&Mix::single(a));
    let second = ran(&Mix::single(b));
    let counted = |pass: &str, list: &[String]| list.iter().filter(|l| l.starts_with(pass)).count();
    assert_eq!(counted("ink stage 1", &together), 1, "stage 1 runs once");
    let own = PASSES.iter().position(|p| *p == "ink contour").unwrap();
    for pass in &PASSES[own..] {
        let apart = counted(pass, &first) + counted(pass, &second);
        assert_eq!(counted(pass, &together), apart, "{pass}");
    }
}

#[test]
fn pictures_do_not_depend_on_threads_or_on_the_run() {
    let place = Place::new();
    let draw = |out: &str, threads: &str| {
        let what = ["render", "grow:shrub:2:600", "-o", out, "--style", "mixed"];
        let more = ["--size", "96x96", "--cells", "20", "--validate"];
        let output = place.umbrage_with(&[&what[..], &more].concat(), "RAYON_NUM_THREADS", threads);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        std::fs::read(place.path(out)).unwrap()
    };
    let first = draw("a.png", "1");
    assert_eq!(first, draw("b.png", "3"), "with three threads");
}

#[test]
fn a_mix_on_the_command_line_names_styles_and_files_beside_it() {
    let place = Place::new();
    let mask: Vec<u8> = (0..8 * 8)
        .flat_map(|i| if i % 8 < 4 { [0, 0, 0, 255] } else { [255; 4] })
        .collect();
    let mask = umbrage::scene::textures::encode_png(8, 8, &mask).unwrap();
    place.write("styles/half.png", mask);
    let fine = "format_version = 1\ndescription = \"x\"\n[contour]\nstrength = 0.7\n";
    place.write("styles/fine.toml", fine);
    let mix = place.write(
        "styles/mix.toml",
        "format_version = 1\ndescription = \"x\"\ndefault = \"outline\"\n\
         [[part]]\nstyle = \"fine.toml\"\nmask = \"half.png\"\n\
         [[part]]\nstyle = \"own\"\nmaterials = \"leaf\"\nshare = [0.0, 0.5]\n\
         [styles.own.contour]\nstrength = 1.0\nwidth = 2.0\n",
    );
    let what = ["render", "grow:shrub:2:300", "-o", "a.png", "--style", &mix];
    let report = place.json(&[&what[..], &["--size", "80x80", "--validate"]].concat());
    let passes: Vec<_> = report["passes"].as_array().unwrap().iter().collect();
    assert_eq!(passes.len(), 10, "{passes:?}");
    assert!(
        passes.iter().any(|p| *p == "ink contour, fine"),
        "{passes:?}"
    );
    assert_eq!(report["styles"][2], "own");
}

#[test]
fn wrong_mixes_are_refused_with_one_line() {
    let place = Place::new();
    let image = |w: u32, h: u32| {
        let pixels = vec![255; (w * h * 4) as usize];
        umbrage::scene::textures::encode_png(w, h, &pixels).unwrap()
    };
    place.write("tall.png", image(10, 20));
    let refused = |name: &str, text: &str, words: &[&str]| {
        let head = "format_version = 1\ndescription = \"x\"\ndefault = \"outline\"\n";
        let file = place.write(name, format!("{head}{text}"));
        let what = [
            "render",
            "grow:shrub:2:300",
            "-o",
            "a.png",
            "--style",
            &file,
        ];
        place.assert_refused(&[&what[..], &["--size", "80x80"]].concat(), words);
    };
    let part = |more: &str| format!("[[part]]\nstyle = \"minimal\"\n{more}\n");
    refused(
        "unknown.toml",
        "[[part]]\nstyle = \"nobody\"\nobjects = \"a\"\n",
        &["unknown.toml", "nobody", "minimal"],
    );
    refused("key.toml", &part("object = \"a\""), &["key.toml", "object"]);
    refused(
        "nothing.toml",
        &part("objects = \"elephant\""),
        &["part 1", "elephant", "there are"],
    );
    refused(
        "material.toml",
        &part("materials = \"steel\""),
        &["part 1", "steel", "there are"],
    );
    refused(
        "tall.toml",
        &part("mask = \"tall.png\""),
        &["tall.png", "10 x 20", "80 x 80"],
    );
    refused(
        "gone.toml",
        &part("mask = \"gone.png\""),
        &["gone.toml", "gone.png"],
    );
    let overlapping = part("distance = [0, 20]") + &part("distance = [10, 30]");
    refused("overlap.toml", &overlapping, &["part 2", "overlap"]);
    let many: String = (1..=8)
        .map(|k| {
            format!("[[part]]\nstyle = \"s{k}\"\nobjects = \"{k}\"\n[styles.s{k}]\nseed = {k}\n")
        })
        .collect();
    refused("many.toml", &many, &["many.toml", "s8", "at most 8"]);
}
