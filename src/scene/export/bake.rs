//! Adding a bake to a document: attributes, colours, back faces.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::{DMat3, Vec3};
use gltf::json::accessor::{ComponentType, FLOAT};
use serde_json::{Value, json};

use super::in_place::Usage;
use super::materials::{Change, Changes};
use super::placement::{self, Places};
use super::writer::{Output, object};
use super::{BackFaces, BakedPart, Channel, ExportOptions};
use crate::scene::gltf_document::GltfDocument;
use crate::scene::import::json::integer;
use crate::scene::model::{Model, Primitive};

/// Writes `baked` into `output`, a copy of `document`.
pub(super) fn apply(
    output: &mut Output,
    document: &Arc<GltfDocument>,
    model: &Model,
    baked: &[BakedPart],
    places: &Places,
    options: &ExportOptions,
) {
    let instances: BTreeSet<usize> = baked.iter().map(|b| b.instance).collect();
    let own = placement::separate(output, document, places, &instances);
    let usage = Usage::of(document);
    let mut changes = Changes::default();
    for part in baked {
        let mesh = model.instances[part.instance].mesh;
        let slot = places.primitives[mesh][part.primitive];
        let (Some(place), Some((_, p))) = (places.instances[part.instance], slot) else {
            continue;
        };
        let Some(&mesh_out) = own.mesh.get(&part.instance) else {
            continue;
        };
        let mut editor = Editor {
            output,
            usage: own.sole.contains(&part.instance).then_some(&usage),
            changes: &mut changes,
            options,
            model,
            slot: (mesh_out, p),
        };
        let primitive = &model.meshes[mesh].primitives[part.primitive];
        editor.part(primitive, part, &place.linear);
    }
    changes.apply(output);
    placement::clean_up(output);
}

struct Editor<'a> {
    output: &'a mut Output,
    /// Present when the source's own attributes may be overwritten.
    usage: Option<&'a Usage>,
    changes: &'a mut Changes,
    options: &'a ExportOptions,
    model: &'a Model,
    /// Mesh and primitive in the output.
    slot: (usize, usize),
}

impl Editor<'_> {
    fn part(&mut self, primitive: &Primitive, part: &BakedPart, linear: &DMat3) {
        let n = primitive.positions.len();
        let mut change = Change::default();
        if let Some(normals) = &part.normals {
            assert_eq!(normals.len(), n, "one normal per vertex");
            self.attribute("NORMAL", &to_local(normals, linear));
        }
        if let Some(ambient) = &part.ambient {
            assert_eq!(ambient.len(), n, "one ambient coefficient per vertex");
            self.ambient(primitive, ambient, &mut change);
        }
        let material = &self.model.materials[primitive.material];
        if part.foliage {
            match self.options.back_faces {
                BackFaces::Unflipped => change.keep_normals = true,
                BackFaces::Flipped => change.drop_mark = true,
                BackFaces::Duplicate if material.double_sided => {
                    let doubled = with_reversed(&primitive.indices);
                    let indices = self.output.indices(&doubled);
                    let p = object(self.json());
                    p.insert("indices".into(), json!(indices));
                    p.shift_remove("mode");
                    change.single_sided = true;
                }
                BackFaces::Duplicate => {}
            }
        }
        // A compressed copy of the attributes would still hold the old normals.
        if let Some(e) = self
            .json()
            .get_mut("extensions")
            .and_then(Value::as_object_mut)
        {
            e.shift_remove("KHR_draco_mesh_compression");
            if e.is_empty() {
                object(self.json()).shift_remove("extensions");
            }
        }
        self.changes.request(self.slot, change);
    }

    fn json(&mut self) -> &mut Value {
        let (mesh, primitive) = self.slot;
        &mut self.output.json["meshes"][mesh]["primitives"][primitive]
    }

    fn ambient(&mut self, primitive: &Primitive, ambient: &[f32], change: &mut Change) {
        let ambient: Vec<f32> = ambient.iter().map(|a| a.clamp(0.0, 1.0)).collect();
        if self.options.ambient_attribute {
            let values: Vec<[f32; 1]> = ambient.iter().map(|&a| [a]).collect();
            self.attribute("_AMBIENT", &values);
        }
        if let Some(channel) = self.options.color_channel {
            self.color(primitive, &ambient, channel);
        }
        if self.options.occlusion_texture {
            let set = self.ramp_set(primitive);
            // Texel centres of the ramp's ends stand for 0 and 1.
            let texels = super::materials::RAMP_TEXELS as f32;
            let to_u = |&a: &f32| [(0.5 + (texels - 1.0) * a) / texels, 0.5];
            let values: Vec<[f32; 2]> = ambient.iter().map(to_u).collect();
            self.attribute(&format!("TEXCOORD_{set}"), &values);
            change.ramp = Some(set);
        }
    }

    /// The texture coordinate set for the ramp: that of an earlier export, else the first free
    /// one after `TEXCOORD_0` (sets must be numbered without gaps).
    fn ramp_set(&mut self, primitive: &Primitive) -> u32 {
        let material = &self.model.materials[primitive.material];
        let earlier = material.occlusion_texture.is_some_and(|(t, _)| {
            super::materials::is_ramp(&self.model.images[self.model.textures[t.texture].image])
        });
        if let (true, Some((t, _))) = (earlier, material.occlusion_texture) {
            return t.texcoord;
        }
        let attributes = &self.json()["attributes"];
        (0..)
            .find(|set| attributes.get(format!("TEXCOORD_{set}")).is_none())
            .expect("a primitive has finitely many sets")
    }

    fn color(&mut self, primitive: &Primitive, ambient: &[f32], channel: Channel) {
        let mut colors = primitive.colors.clone();
        colors.resize(ambient.len(), [1.0; 4]);
        let c = match channel {
            Channel::R => 0,
            Channel::G => 1,
            Channel::B => 2,
            Channel::A => 3,
        };
        for (color, &a) in colors.iter_mut().zip(ambient) {
            color[c] = a;
        }
        // Float colours of the source stay floats; 8 and 16 bits both fit 16 bits exactly.
        let old = integer(&self.json()["attributes"], "COLOR_0");
        let accessor = old.and_then(|i| self.output.json.get("accessors")?.get(i));
        let component = accessor.and_then(|a| integer(a, "componentType"));
        let was_float = component == Some(FLOAT as usize);
        if was_float {
            self.attribute("COLOR_0", &colors);
        } else {
            let quantised = unorm16(&colors);
            self.write("COLOR_0", ComponentType::U16, &quantised);
        }
    }

    /// Sets an attribute of floats.
    fn attribute<const N: usize>(&mut self, name: &str, values: &[[f32; N]]) {
        self.write(name, ComponentType::F32, values);
    }

    /// Sets an attribute: over the old bytes where nobody else reads them, else appended.
    fn write<T: bytemuck::Pod, const N: usize>(
        &mut self,
        name: &str,
        component: ComponentType,
        values: &[[T; N]],
    ) {
        let old = integer(&self.json()["attributes"], name);
        let layout = old.and_then(|i| self.usage?.writable(i, component, N, values.len()));
        let base = layout.and_then(|l| self.output.bases[l.buffer?]);
        if let (Some(i), Some(layout), Some(base)) = (old, layout, base) {
            for (k, value) in values.iter().enumerate() {
                let at = base + layout.start + k * layout.stride;
                let bytes = bytemuck::cast_slice(value);
                self.output.bin[at..at + bytes.len()].copy_from_slice(bytes);
            }
            let accessor = object(&mut self.output.json["accessors"][i]);
            accessor.shift_remove("min");
            accessor.shift_remove("max");
            return;
        }
        let accessor = match component {
            ComponentType::F32 => self.output.floats(values),
            _ => self.output.unorm16(values),
        };
        object(&mut self.json()["attributes"]).insert(name.to_owned(), json!(accessor));
    }
}

/// Values in \[0,1\] as normalised 16-bit integers.
fn unorm16(values: &[[f32; 4]]) -> Vec<[u16; 4]> {
    let quantise = |c: f32| (c.clamp(0.0, 1.0) * 65535.0).round() as u16;
    values.iter().map(|v| v.map(quantise)).collect()
}

/// World normals in the node's frame: normals go to the world by the inverse transpose, so
/// they come back by the transpose.
fn to_local(normals: &[Vec3], linear: &DMat3) -> Vec<[f32; 3]> {
    let back = linear.transpose();
    normals
        .iter()
        .map(|n| {
            let local = (back * n.as_dvec3()).normalize_or(n.as_dvec3());
            local.normalize_or(glam::DVec3::Y).as_vec3().to_array()
        })
        .collect()
}

/// Every triangle, then every triangle reversed.
fn with_reversed(indices: &[u32]) -> Vec<u32> {
    let reversed = indices.chunks_exact(3).flat_map(|t| [t[0], t[2], t[1]]);
    indices.iter().copied().chain(reversed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_return_from_a_stretched_mirrored_frame() {
        let linear = DMat3::from_cols_array(&[-2.0, 0.0, 0.0, 0.5, 3.0, 0.0, 0.0, 0.0, 0.1]);
        let local = Vec3::new(0.3, -0.8, 0.5).normalize();
        let world = (linear.inverse().transpose() * local.as_dvec3()).normalize();
        let [back] = to_local(&[world.as_vec3()], &linear)[..] else {
            panic!("one normal in, one out")
        };
        assert!((Vec3::from(back) - local).length() < 1e-6);
        assert_eq!(to_local(&[Vec3::ZERO], &linear), [[0.0, 1.0, 0.0]]);
    }

    #[test]
    fn reversed_triangles_use_the_same_vertices() {
        assert_eq!(with_reversed(&[0, 1, 2]), [0, 1, 2, 0, 2, 1]);
    }
}
