//! Several placed plants as one model, so that one density field covers them all: a small tree
//! darkens beside a large one (Luft, Balzer, Deussen 2007, section 5).

use std::ops::Range;

use glam::DAffine3;

use super::model::{ImageSource, Material, Model, TextureRef};

/// A merged model and which of its instances came from which plant.
#[derive(Debug, Clone, Default)]
pub struct Population {
    /// Everything, in world coordinates of the scene.
    pub model: Model,
    /// Range of [`Model::instances`] of each plant, in order.
    pub instances: Vec<Range<usize>>,
    /// Range of [`Model::materials`] of each plant; the same for those that are one model.
    pub materials: Vec<Range<usize>>,
}

impl Population {
    /// Merges `plants`, each moved to its place. A model that stands in several places has its
    /// meshes, materials and images once.
    #[must_use]
    pub fn merge(name: &str, plants: &[(&Model, DAffine3)]) -> Self {
        let mut out = Self::default();
        out.model.name = name.to_owned();
        let mut known: Vec<(&Model, usize, Range<usize>)> = Vec::new();
        for (plant, to_scene) in plants {
            let (meshes, materials) = match known.iter().find(|k| std::ptr::eq(k.0, *plant)) {
                Some((_, meshes, materials)) => (*meshes, materials.clone()),
                None => {
                    let first = (out.model.meshes.len(), out.model.materials.len());
                    append(&mut out.model, plant);
                    let materials = first.1..out.model.materials.len();
                    known.push((plant, first.0, materials.clone()));
                    (first.0, materials)
                }
            };
            let first = out.model.instances.len();
            place(&mut out.model, plant, to_scene, meshes);
            out.instances.push(first..out.model.instances.len());
            out.materials.push(materials);
        }
        out
    }
}

/// Adds what the plant is made of.
fn append(into: &mut Model, plant: &Model) {
    let [materials, textures, images] =
        [into.materials.len(), into.textures.len(), into.images.len()];
    let images_of_plant = plant.images.iter().map(|image| of_plant(image, plant));
    into.images.extend(images_of_plant);
    for texture in &plant.textures {
        let mut texture = *texture;
        texture.image += images;
        into.textures.push(texture);
    }
    for material in &plant.materials {
        let mut material = material.clone();
        shift_textures(&mut material, textures);
        into.materials.push(material);
    }
    for mesh in &plant.meshes {
        let mut mesh = mesh.clone();
        for primitive in &mut mesh.primitives {
            primitive.material += materials;
            // The merged model has no document of its own.
            primitive.source = None;
        }
        into.meshes.push(mesh);
    }
    for warning in &plant.warnings {
        into.warnings.push(format!("{}: {warning}", plant.name));
    }
}

/// Adds the plant at its place; its meshes are `into`'s from `meshes` on.
fn place(into: &mut Model, plant: &Model, to_scene: &DAffine3, meshes: usize) {
    for instance in &plant.instances {
        let mut instance = instance.clone();
        instance.mesh += meshes;
        instance.local_to_world = *to_scene * instance.local_to_world;
        instance.source = None;
        into.instances.push(instance);
    }
    for light in &plant.lights {
        let mut light = *light;
        light.position = to_scene.transform_point3(light.position);
        light.direction = to_scene
            .transform_vector3(light.direction)
            .normalize_or(light.direction);
        into.lights.push(light);
    }
}

/// The image, named with the file of its plant: the merged model has none.
fn of_plant(image: &ImageSource, plant: &Model) -> ImageSource {
    let mut image = image.clone();
    if let Some(path) = &plant.path {
        let (ImageSource::Encoded { name, .. } | ImageSource::Rgba8 { name, .. }) = &mut image;
        *name = format!("{} of {}", name, path.display());
    }
    image
}

fn shift_textures(material: &mut Material, by: usize) {
    let shift = |t: &mut TextureRef| t.texture += by;
    if let Some(t) = &mut material.base_color_texture {
        shift(t);
    }
    if let Some((t, _)) = &mut material.occlusion_texture {
        shift(t);
    }
    if let Some(transmission) = &mut material.diffuse_transmission {
        let own = [&mut transmission.texture, &mut transmission.color_texture];
        own.into_iter().flatten().for_each(shift);
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3};

    use super::*;
    use crate::scene::{Geometry, Instance, Mesh, Primitive, Texture};

    fn plant() -> Model {
        let material = Material {
            base_color_texture: Some(TextureRef::new(0)),
            ..Material::default()
        };
        let primitive = Primitive {
            positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            indices: vec![0, 1, 2],
            source: Some((0, 0)),
            ..Primitive::default()
        };
        Model {
            name: "plant".into(),
            meshes: vec![Mesh {
                name: "mesh".into(),
                primitives: vec![primitive],
            }],
            instances: vec![Instance {
                name: "node".into(),
                mesh: 0,
                local_to_world: DAffine3::IDENTITY,
                source: Some((0, None)),
            }],
            materials: vec![material],
            textures: vec![Texture::default()],
            images: vec![ImageSource::Rgba8 {
                name: "image".into(),
                width: 1,
                height: 1,
                pixels: [255; 4].as_slice().into(),
            }],
            ..Model::default()
        }
    }

    #[test]
    fn references_follow_their_plant() {
        let (plant, other) = (plant(), plant());
        let away = DAffine3::from_translation(DVec3::new(10.0, 0.0, 0.0));
        let two = Population::merge("two", &[(&plant, DAffine3::IDENTITY), (&other, away)]);
        assert_eq!(two.instances, [0..1, 1..2], "one instance each");
        let second = &two.model.meshes[two.model.instances[1].mesh].primitives[0];
        assert_eq!(second.material, 1, "the second plant's own material");
        let texture = two.model.materials[1].base_color_texture.unwrap();
        assert_eq!(two.model.textures[texture.texture].image, 1, "own image");
        let geometry = Geometry::flatten(&two.model);
        let gap = geometry.positions[3] - geometry.positions[0];
        assert_eq!(gap, Vec3::new(10.0, 0.0, 0.0), "moved to its place");
    }

    #[test]
    fn a_model_in_two_places_is_kept_once() {
        let plant = plant();
        let away = DAffine3::from_translation(DVec3::new(10.0, 0.0, 0.0));
        let two = Population::merge("two", &[(&plant, DAffine3::IDENTITY), (&plant, away)]);
        assert_eq!(two.instances, [0..1, 1..2], "one instance each");
        assert_eq!(two.materials, [0..1, 0..1], "the same materials");
        let m = &two.model;
        let counts = [m.meshes.len(), m.materials.len(), m.images.len()];
        assert_eq!(counts, [1, 1, 1], "once");
        assert_eq!(Geometry::flatten(m).positions.len(), 6, "at both places");
    }
}
