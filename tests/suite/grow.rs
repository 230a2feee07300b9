//! The plant generator: exact counts, sound meshes, plausible structure, the same bits every time.

use glam::Vec3;
use umbrage::scene::grow::{
    self, GrowOptions, LeafShape, MAX_LEAVES, Parameters, Skeleton, Species, Stem, skeleton,
};
use umbrage::scene::{Botany, ImageSource, Model, Primitive};

fn options(seed: u64, leaves: u32) -> GrowOptions {
    GrowOptions {
        seed,
        leaves: Some(leaves),
        ..GrowOptions::default()
    }
}

fn plant(species: Species, seed: u64, leaves: u32) -> Model {
    grow::grow(species, &options(seed, leaves)).unwrap()
}

fn part<'a>(model: &'a Model, name: &str) -> &'a Primitive {
    let mesh = model.meshes.iter().find(|m| m.name == name);
    &mesh
        .unwrap_or_else(|| panic!("no mesh `{name}`"))
        .primitives[0]
}

fn botany(primitive: &Primitive) -> &Botany {
    primitive.botany.as_ref().unwrap()
}

/// A number that changes when any vertex or index changes by a bit.
fn fingerprint(model: &Model) -> u64 {
    let mut h = 0xcbf2_9ce4_8422_2325u64;
    let mut mix = |bits: u32| h = (h ^ u64::from(bits)).wrapping_mul(0x0000_0100_0000_01b3);
    for p in model.meshes.iter().flat_map(|m| &m.primitives) {
        p.positions.iter().flatten().for_each(|c| mix(c.to_bits()));
        p.normals.iter().flatten().for_each(|c| mix(c.to_bits()));
        p.texcoords.iter().flatten().for_each(|c| mix(c.to_bits()));
        p.colors.iter().flatten().for_each(|c| mix(c.to_bits()));
        p.indices.iter().for_each(|&i| mix(i));
    }
    h
}

#[test]
fn leaf_counts_are_exact_at_every_density() {
    for species in Species::ALL {
        for wanted in [1, 17, 1_000, 5_003, 50_000] {
            let model = plant(species, 3, wanted);
            let p = part(&model, "leaves");
            let leaves = &botany(p).leaves;
            assert_eq!(leaves.len(), wanted as usize, "{species}");
            let mut next = 0;
            for leaf in leaves {
                assert_eq!(
                    leaf.first_index, next,
                    "{species}: ranges follow each other"
                );
                next += leaf.index_count;
            }
            assert_eq!(
                next as usize,
                p.indices.len(),
                "{species}: ranges cover the mesh"
            );
        }
    }
}

#[test]
fn half_a_million_leaves_grow() {
    for species in [Species::Broadleaf, Species::Conifer] {
        let model = plant(species, 1, MAX_LEAVES);
        let p = part(&model, "leaves");
        assert_eq!(botany(p).leaves.len(), MAX_LEAVES as usize);
        let highest = p.indices.iter().max().unwrap();
        assert_eq!(*highest as usize + 1, p.positions.len(), "{species}");
        let bytes = p.positions.len() * 48 + p.indices.len() * 4;
        assert!(bytes < 800 << 20, "{species}: {bytes} bytes");
    }
}

#[test]
fn a_winter_plant_has_wood_only() {
    let model = plant(Species::Lime, 5, 0);
    assert_eq!(model.meshes.len(), 1);
    assert_eq!(model.materials.len(), 1);
    assert!(part(&model, "wood").indices.len() > 10_000);
}

#[test]
fn a_seed_gives_the_same_bits_and_another_seed_another_plant() {
    for species in Species::ALL {
        let first = fingerprint(&plant(species, 42, 2_000));
        assert_eq!(first, fingerprint(&plant(species, 42, 2_000)), "{species}");
        assert_ne!(first, fingerprint(&plant(species, 43, 2_000)), "{species}");
    }
}

#[test]
fn every_triangle_and_every_vertex_is_sound() {
    for species in Species::ALL {
        let model = plant(species, 8, 4_000);
        for name in ["wood", "leaves"] {
            let p = part(&model, name);
            let n = p.positions.len();
            assert!([p.normals.len(), p.texcoords.len(), p.colors.len()] == [n; 3]);
            assert!(p.positions.iter().flatten().all(|c| c.is_finite()));
            assert!(p.texcoords.iter().flatten().all(|c| c.is_finite()));
            assert!(p.colors.iter().flatten().all(|c| (0.0..=1.0).contains(c)));
            for normal in &p.normals {
                assert!(
                    (Vec3::from(*normal).length() - 1.0).abs() < 1e-5,
                    "{species}"
                );
            }
            for t in p.indices.chunks_exact(3) {
                let [a, b, c] = [t[0], t[1], t[2]].map(|i| Vec3::from(p.positions[i as usize]));
                let cross = (b - a).cross(c - a).length();
                let longest = (b - a).length().max((c - a).length()).max((c - b).length());
                assert!(
                    cross > 1e-5 * longest * longest,
                    "{species} {name}: {a} {b} {c}"
                );
            }
        }
    }
}

#[test]
fn faces_and_normals_agree() {
    for species in Species::ALL {
        let model = plant(species, 2, 3_000);
        for name in ["wood", "leaves"] {
            let p = part(&model, name);
            let mut against = 0usize;
            for t in p.indices.chunks_exact(3) {
                let [a, b, c] = [t[0], t[1], t[2]].map(|i| Vec3::from(p.positions[i as usize]));
                let face = (b - a).cross(c - a);
                let mean: Vec3 = t.iter().map(|&i| Vec3::from(p.normals[i as usize])).sum();
                against += usize::from(face.dot(mean) <= 0.0);
            }
            // sharp bends of thin twigs turn a few slivers over
            let share = against as f64 / (p.indices.len() / 3) as f64;
            assert!(share < 0.002, "{species} {name}: {share} turned");
        }
    }
}

#[test]
fn plants_stand_at_the_origin_inside_their_stated_size() {
    for species in Species::ALL {
        for seed in 0..6 {
            let model = plant(species, seed, 6_000);
            let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            for p in model.meshes.iter().flat_map(|m| &m.primitives) {
                for q in &p.positions {
                    low = low.min(Vec3::from(*q));
                    high = high.max(Vec3::from(*q));
                }
            }
            let (height, width) = (species.height(), species.width());
            let label = format!("{species} seed {seed}: {low} .. {high}");
            assert!(low.y > -0.12 && low.y <= 0.0, "{label}");
            assert!(
                (height[0]..=height[1]).contains(&f64::from(high.y)),
                "{label}"
            );
            let across = f64::from((high.x - low.x).max(high.z - low.z));
            assert!((width[0]..=width[1]).contains(&across), "{label}");
            let lean = (0.5 * (low + high)).with_y(0.0).length();
            assert!(f64::from(lean) < 0.15 * across, "{label} leans");
        }
    }
}

fn grown(species: Species) -> (Parameters, Skeleton) {
    let p = species.parameters();
    let s = skeleton(&p, &GrowOptions::default()).unwrap();
    (p, s)
}

#[test]
fn stems_hang_together_and_taper() {
    for species in Species::ALL {
        let (p, s) = grown(species);
        assert_eq!(s.max_order + 1, p.levels, "{species}");
        for (i, stem) in s.stems.iter().enumerate() {
            assert!(stem.fractions.windows(2).all(|f| f[0] < f[1]), "{species}");
            assert!(
                stem.radii.windows(2).all(|r| r[0] >= r[1]),
                "{species} stem {i} swells"
            );
            assert!(stem.radii.iter().all(|&r| r > 0.0));
            let Some((parent, at)) = stem.parent else {
                assert_eq!(stem.order, 0);
                continue;
            };
            assert!(parent < i, "{species}: parents come first");
            let parent = &s.stems[parent];
            assert_eq!(
                stem.order,
                parent.order + u8::from(!stem.is_fork),
                "{species}"
            );
            assert!((0.0..=1.0).contains(&at));
            let gap = distance_to_axis(parent, stem.points[0]);
            assert!(
                gap < 0.02 * parent.length,
                "{species} stem {i} floats: {gap} m"
            );
            assert!(
                stem.radii[0] <= 1.5 * parent.radii[0],
                "{species} stem {i} too thick"
            );
        }
    }
}

fn distance_to_axis(stem: &Stem, q: glam::DVec3) -> f64 {
    stem.points
        .windows(2)
        .map(|s| {
            let d = s[1] - s[0];
            let t = ((q - s[0]).dot(d) / d.length_squared()).clamp(0.0, 1.0);
            (s[0] + d * t - q).length()
        })
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn orders_per_vertex_and_per_leaf_are_in_range() {
    for species in Species::ALL {
        let levels = species.parameters().levels;
        let model = plant(species, 4, 3_000);
        let wood = part(&model, "wood");
        let orders = &botany(wood).branch_order;
        assert_eq!(orders.len(), wood.positions.len());
        for order in 0..levels {
            assert!(
                orders.contains(&order),
                "{species}: no stem of order {order}"
            );
        }
        assert!(orders.iter().all(|&o| o < levels));
        for t in wood.indices.chunks_exact(3) {
            assert!(
                t.iter()
                    .all(|&i| orders[i as usize] == orders[t[0] as usize])
            );
        }
        let leaves = &botany(part(&model, "leaves")).leaves;
        let outer = leaves.iter().filter(|l| l.order + 1 == levels).count();
        assert!(leaves.iter().all(|l| l.order < levels));
        assert!(
            2 * outer > leaves.len(),
            "{species}: {outer} leaves on twigs"
        );
    }
}

#[test]
fn leaf_frames_are_orthonormal_and_meet_their_tips() {
    for species in Species::ALL {
        let model = plant(species, 6, 3_000);
        let p = part(&model, "leaves");
        for leaf in &botany(p).leaves {
            let (t, n) = (Vec3::from(leaf.tangent), Vec3::from(leaf.normal));
            assert!((t.length() - 1.0).abs() < 1e-5 && (n.length() - 1.0).abs() < 1e-5);
            assert!(t.dot(n).abs() < 1e-5, "{species}");
            let range = leaf.first_index as usize..(leaf.first_index + leaf.index_count) as usize;
            let tip = Vec3::from(leaf.base) + t * leaf.length;
            let gap = p.indices[range.clone()]
                .iter()
                .map(|&i| (Vec3::from(p.positions[i as usize]) - tip).length())
                .fold(f32::INFINITY, f32::min);
            assert!(
                gap < 1e-4 * leaf.length.max(0.1),
                "{species}: tip off by {gap}"
            );
            let area: Vec3 = p.indices[range]
                .chunks_exact(3)
                .map(|t| {
                    let [a, b, c] = [t[0], t[1], t[2]].map(|i| Vec3::from(p.positions[i as usize]));
                    (b - a).cross(c - a)
                })
                .sum();
            assert!(
                area.normalize().dot(n) > 0.8,
                "{species}: normal is not the upper side"
            );
        }
    }
}

#[test]
fn leaves_grow_on_wood() {
    for species in Species::ALL {
        let (p, s) = grown(species);
        let model = plant(species, GrowOptions::default().seed, 1_000);
        // the skeleton may have more twigs than the thinly leaved plant, never other ones
        for leaf in botany(part(&model, "leaves")).leaves.iter().step_by(23) {
            let base = Vec3::from(leaf.base).as_dvec3();
            let near = s
                .stems
                .iter()
                .filter(|stem| stem.order == leaf.order)
                .map(|stem| distance_to_axis(stem, base) - stem.radii[0])
                .fold(f64::INFINITY, f64::min);
            assert!(
                near < 1e-4,
                "{species}: a leaf floats {near} m off ({} levels)",
                p.levels
            );
        }
    }
}

#[test]
fn every_leaf_is_one_connected_piece() {
    for species in Species::ALL {
        let model = plant(species, 6, 60);
        let p = part(&model, "leaves");
        for leaf in &botany(p).leaves {
            let range = leaf.first_index as usize..(leaf.first_index + leaf.index_count) as usize;
            let triangles: Vec<&[u32]> = p.indices[range].chunks_exact(3).collect();
            let mut reached = vec![false; triangles.len()];
            reached[0] = true;
            for _ in 0..triangles.len() {
                for i in 0..triangles.len() {
                    reached[i] |= (0..triangles.len()).any(|k| {
                        reached[k] && triangles[k].iter().any(|v| triangles[i].contains(v))
                    });
                }
            }
            assert!(reached.iter().all(|&r| r), "{species}");
        }
    }
}

#[test]
fn total_leaf_area_keeps_when_density_changes() {
    let area = |leaves| {
        let model = plant(Species::Broadleaf, 1, leaves);
        let p = part(&model, "leaves");
        let mut sum = 0.0;
        for t in p.indices.chunks_exact(3) {
            let [a, b, c] =
                [t[0], t[1], t[2]].map(|i| Vec3::from(p.positions[i as usize]).as_dvec3());
            sum += 0.5 * (b - a).cross(c - a).length();
        }
        sum
    };
    let (few, many) = (area(2_000), area(40_000));
    assert!(
        (few / many - 1.0).abs() < 0.05,
        "{few} m2 against {many} m2"
    );
}

#[test]
fn materials_tell_foliage_from_wood() {
    for species in Species::ALL {
        let model = plant(species, 1, 100);
        let leaf = &model.materials[part(&model, "leaves").material];
        let bark = &model.materials[part(&model, "wood").material];
        let is_needle = species.parameters().leaf.shape == LeafShape::NeedleSpray;
        assert!(
            leaf.name
                .contains(if is_needle { "needle" } else { "leaf" })
        );
        assert!(!bark.name.contains("leaf") && !bark.double_sided);
        assert!(leaf.double_sided);
        let through = leaf.diffuse_transmission.as_ref().unwrap().factor;
        assert!((0.05..0.6).contains(&through));
        for image in &model.images {
            let ImageSource::Rgba8 {
                width,
                height,
                pixels,
                ..
            } = image
            else {
                panic!("grown textures are drawn");
            };
            assert_eq!(pixels.len(), (width * height * 4) as usize);
            assert!((256..=512).contains(width) && (256..=512).contains(height));
        }
    }
}

#[test]
fn wrong_options_and_tables_are_refused_by_name() {
    let refused = |o: GrowOptions| grow::grow(Species::Shrub, &o).unwrap_err().to_string();
    let many = refused(options(1, MAX_LEAVES + 1));
    assert!(many.contains("leaves") && many.contains("500001"), "{many}");
    for detail in [0.0, -1.0, 100.0, f32::NAN] {
        let message = refused(GrowOptions {
            detail,
            ..GrowOptions::default()
        });
        assert!(message.contains("detail"), "{message}");
    }
    let mut table = Species::Lime.parameters();
    table.level[1].curve_res = 0;
    let message = grow::grow_with("lime", &table, &GrowOptions::default()).unwrap_err();
    assert!(message.to_string().contains("1CurveRes"), "{message}");
    table = Species::Lime.parameters();
    table.ratio = f64::NAN;
    assert!(grow::grow_with("lime", &table, &GrowOptions::default()).is_err());
}

#[test]
fn the_embedded_plant_is_the_default_broadleaf() {
    let model = grow::embedded();
    let count = Species::Broadleaf.parameters().leaf.count;
    assert_eq!(botany(part(&model, "leaves")).leaves.len(), count as usize);
}
