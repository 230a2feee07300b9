//! Writing models that no glTF file is behind: OBJ files, grown plants, surfaces.

use glam::{DAffine3, DMat3, DVec3, Vec3};
use umbrage::scene::export::{ExportOptions, SurfaceMesh, gltf, surface};
use umbrage::scene::grow::{GrowOptions, Species, grow};
use umbrage::scene::{Geometry, Model, textures};

use crate::export_fixture::{encodings, octahedron, open, reopen, stand_in};
use crate::model_fixture::shared;

#[test]
fn a_model_without_a_document_is_written_whole() {
    let mut model = open(shared("quaternius/Tree_3.obj"));
    // Far away, turned, sheared: what scene files and populations can ask for.
    let shear = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 2.0]);
    let places = [
        DAffine3::from_scale_rotation_translation(
            DVec3::splat(2.0),
            glam::DQuat::from_rotation_y(1.0),
            DVec3::new(500_000.25, 0.0, 5_000_000.5),
        ),
        DAffine3::from_mat3_translation(shear, DVec3::new(500_010.0, 0.0, 5_000_000.0)),
    ];
    let original = model.instances.remove(0);
    for to_world in places {
        let mut instance = original.clone();
        instance.local_to_world = to_world;
        model.instances.push(instance);
    }
    let (g, normals, ambient, parts) = stand_in(&model);
    for (name, options) in encodings() {
        let (again, _) = reopen(&gltf(&model, &parts, &options).unwrap());
        let h = Geometry::flatten(&again);
        assert!((g.origin - h.origin).length() < 1e-3, "{name}");
        for (a, b) in g.parts.iter().zip(&h.parts) {
            let (old, new) = (&model.materials[a.material], &again.materials[b.material]);
            assert_eq!((&old.name, old.alpha_mode), (&new.name, new.alpha_mode));
            for (i, j) in a.vertices().zip(b.vertices()) {
                let apart =
                    g.origin + g.positions[i].as_dvec3() - h.origin - h.positions[j].as_dvec3();
                assert!(apart.length() < 1e-5, "{name}");
                if old.name.contains("Leaves") {
                    assert!((h.normals[j] - normals[i]).length() < 1e-5, "{name}");
                }
                if options.ambient_attribute {
                    assert!((h.ambient[j] - ambient[i]).abs() < 1e-6, "{name}");
                }
            }
        }
    }
}

#[test]
fn a_grown_plant_keeps_its_material_and_tells_its_branching_order() {
    let options = GrowOptions {
        leaves: Some(500),
        ..GrowOptions::default()
    };
    let plant = grow(Species::ALL[0], &options).unwrap();
    let (again, json) = reopen(&gltf(&plant, &[], &ExportOptions::default()).unwrap());
    assert_eq!(again.materials.len(), plant.materials.len());
    for (a, b) in plant.materials.iter().zip(&again.materials) {
        assert_eq!(
            (&a.name, a.alpha_mode, a.double_sided),
            (&b.name, b.alpha_mode, b.double_sided)
        );
        let factor =
            |m: &umbrage::scene::Material| m.diffuse_transmission.as_ref().map(|d| d.factor);
        assert_eq!(factor(a), factor(b));
        let image = |model: &Model, m: &umbrage::scene::Material| {
            let t = m.base_color_texture?.texture;
            Some(textures::decode(&model.images[model.textures[t].image]).unwrap())
        };
        assert_eq!(image(&plant, a), image(&again, b));
    }
    let (g, h) = (Geometry::flatten(&plant), Geometry::flatten(&again));
    assert_eq!((&g.indices, &g.texcoords), (&h.indices, &h.texcoords));
    for mesh in json["meshes"].as_array().unwrap() {
        for p in mesh["primitives"].as_array().unwrap() {
            assert!(p["attributes"].get("_BRANCH_ORDER").is_some());
        }
    }
}

#[test]
fn a_surface_is_a_file_of_its_own_and_bad_ones_are_refused() {
    let (positions, indices) = octahedron();
    let mesh = SurfaceMesh {
        name: "shell",
        origin: DVec3::new(1.0, 2.0, 5e6),
        positions: &positions,
        normals: &positions,
        indices: &indices,
    };
    let (model, _) = reopen(&surface(&mesh).unwrap());
    let g = Geometry::flatten(&model);
    assert_eq!(
        (g.origin, g.positions.len(), g.indices.len()),
        (mesh.origin, 6, 24)
    );
    assert!(
        surface(&SurfaceMesh {
            indices: &[],
            ..mesh
        })
        .is_err()
    );
    assert!(
        surface(&SurfaceMesh {
            indices: &[0, 1, 6],
            ..mesh
        })
        .is_err()
    );
    let bad = [Vec3::NAN; 6];
    assert!(
        surface(&SurfaceMesh {
            positions: &bad,
            ..mesh
        })
        .is_err()
    );
}
