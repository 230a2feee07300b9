//! Changing materials for baked primitives without touching those of other primitives.

use std::collections::BTreeMap;

use gltf::json::texture::{MagFilter, MinFilter, Sampler, WrappingMode};
use gltf::json::validation::Checked::Valid;
use serde_json::{Value, json};

use super::writer::{Output, object, plain};
use crate::scene::import::json::integer;
use crate::scene::import::material::KEEP_NORMALS;
use crate::scene::model::ImageSource;
use crate::scene::textures::encode_png;

/// Width of the ramp image.
pub(super) const RAMP_TEXELS: u32 = 256;
const RAMP_NAME: &str = "umbrage ambient ramp";

/// What a primitive wants changed in its material.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Change {
    /// Mark that normals of back faces are not to be flipped.
    pub(super) keep_normals: bool,
    /// Remove that mark.
    pub(super) drop_mark: bool,
    /// Back faces have triangles of their own.
    pub(super) single_sided: bool,
    /// Occlusion from the ramp with this texture coordinate set.
    pub(super) ramp: Option<u32>,
}

/// Mesh and primitive of the output.
type Slot = (usize, usize);

/// All wishes.
#[derive(Debug, Default)]
pub(super) struct Changes {
    wishes: BTreeMap<Slot, Change>,
}

/// Whether an image is the ramp of an earlier export.
pub(super) fn is_ramp(image: &ImageSource) -> bool {
    matches!(image, ImageSource::Encoded { name, .. } if name == RAMP_NAME)
}

impl Changes {
    /// Notes what the primitive at `slot` wants.
    pub(super) fn request(&mut self, slot: (usize, usize), change: Change) {
        self.wishes.insert(slot, change);
    }

    /// Fulfils all wishes: a material is edited where every user wants the same, and copied
    /// (under the same name) where users differ.
    pub(super) fn apply(self, output: &mut Output) {
        let ramp = self.wishes.values().any(|c| c.ramp.is_some());
        let ramp = ramp.then(|| ramp_texture(output));
        let users = material_users(&output.json);
        // Wishes per material.
        let mut by_material: BTreeMap<Option<usize>, Vec<(Slot, Change)>> = BTreeMap::new();
        for (slot, change) in self.wishes {
            if change != Change::default() {
                let material = material_of(&output.json["meshes"][slot.0]["primitives"][slot.1]);
                by_material
                    .entry(material)
                    .or_default()
                    .push((slot, change));
            }
        }
        for (material, wishes) in by_material {
            let mut kinds: Vec<Change> = wishes.iter().map(|w| w.1).collect();
            kinds.sort_unstable();
            kinds.dedup();
            let everyone = material.is_some_and(|m| users.get(&m) == Some(&wishes.len()));
            let original = material.map(|m| output.json["materials"][m].clone());
            let mut made = BTreeMap::new();
            for (k, kind) in kinds.into_iter().enumerate() {
                let mut edited = original.clone().unwrap_or_else(|| json!({}));
                edit(&mut edited, kind, ramp);
                let index = match material {
                    Some(m) if everyone && k == 0 => {
                        output.json["materials"][m] = edited;
                        m
                    }
                    _ if original.as_ref() == Some(&edited) => continue,
                    _ => output.push("materials", edited),
                };
                made.insert(kind, index);
            }
            for ((mesh, p), kind) in wishes {
                if let Some(&index) = made.get(&kind) {
                    output.json["meshes"][mesh]["primitives"][p]["material"] = json!(index);
                }
            }
        }
    }
}

fn material_of(primitive: &Value) -> Option<usize> {
    integer(primitive, "material")
}

/// How many primitives use each material; material variants count as further users.
fn material_users(json: &Value) -> BTreeMap<usize, usize> {
    let mut users = BTreeMap::new();
    let meshes = json.get("meshes").and_then(Value::as_array);
    for mesh in meshes.into_iter().flatten() {
        let primitives = mesh.get("primitives").and_then(Value::as_array);
        for p in primitives.into_iter().flatten() {
            let variants = p
                .pointer("/extensions/KHR_materials_variants/mappings")
                .and_then(Value::as_array);
            let variants = variants.into_iter().flatten().filter_map(material_of);
            for m in material_of(p).into_iter().chain(variants) {
                *users.entry(m).or_default() += 1;
            }
        }
    }
    users
}

fn edit(material: &mut Value, change: Change, ramp: Option<usize>) {
    let m = object(material);
    if change.single_sided {
        m.shift_remove("doubleSided");
    }
    if let (Some(set), Some(texture)) = (change.ramp, ramp) {
        let mut info = json!({"index": texture});
        if set > 0 {
            info["texCoord"] = json!(set);
        }
        if m.insert("occlusionTexture".into(), info).is_some() {
            log::warn!("an occlusion texture of the file gives way to the baked one");
        }
    }
    if change.keep_normals {
        let extras = m.entry("extras").or_insert_with(|| json!({}));
        match extras.as_object_mut() {
            Some(extras) => {
                extras.insert(KEEP_NORMALS.into(), json!(true));
            }
            None => log::warn!("a material's extras are no object; its back faces get no mark"),
        }
    } else if let Some(extras) = m.get_mut("extras").and_then(Value::as_object_mut)
        && (change.drop_mark || change.single_sided)
        && extras.shift_remove(KEEP_NORMALS).is_some()
        && extras.is_empty()
    {
        m.shift_remove("extras");
    }
}

/// Appends the ramp: red is the coordinate u, read with linear filtering.
fn ramp_texture(output: &mut Output) -> usize {
    let position = |list: &str, key: &str, value: Value| {
        let list = output.json.get(list).and_then(Value::as_array)?;
        list.iter().position(|v| v.get(key) == Some(&value))
    };
    if let Some(image) = position("images", "name", json!(RAMP_NAME))
        && let Some(texture) = position("textures", "source", json!(image))
    {
        return texture;
    }
    let pixels: Vec<u8> = (0..=255u8).flat_map(|v| [v, v, v, 255]).collect();
    let png = encode_png(RAMP_TEXELS, 1, &pixels).expect("the ramp has its size");
    let view = output.view(&png, None);
    let image = json!({"name": RAMP_NAME, "mimeType": "image/png", "bufferView": view});
    let image = output.push("images", image);
    let sampler = plain(Sampler {
        mag_filter: Some(Valid(MagFilter::Linear)),
        min_filter: Some(Valid(MinFilter::Linear)),
        wrap_s: Valid(WrappingMode::ClampToEdge),
        wrap_t: Valid(WrappingMode::ClampToEdge),
        ..Sampler::default()
    });
    let sampler = output.push("samplers", sampler);
    output.push("textures", json!({"sampler": sampler, "source": image}))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::gltf_document::GltfDocument;

    fn output(materials: &Value, used: &[Option<usize>]) -> Output {
        let primitives: Vec<Value> = used
            .iter()
            .map(|m| m.map_or(json!({}), |m| json!({"material": m})))
            .collect();
        Output::new(&GltfDocument {
            json: json!({"materials": materials, "meshes": [{"primitives": primitives}]}),
            buffers: vec![],
        })
    }

    #[test]
    fn a_material_is_copied_only_where_its_users_differ() {
        let keep = Change {
            keep_normals: true,
            ..Change::default()
        };
        let materials = json!([{"name": "leaf", "extras": {"a": 1}}, {"name": "both"}]);
        let mut out = output(&materials, &[Some(0), Some(0), Some(1), Some(1), None]);
        let mut changes = Changes::default();
        for p in [0, 1, 2, 4] {
            changes.request((0, p), keep);
        }
        changes.apply(&mut out);
        let used = |p: usize| out.json["meshes"][0]["primitives"][p]["material"].as_u64();
        assert_eq!((used(0), used(1), used(3)), (Some(0), Some(0), Some(1)));
        assert_eq!(
            out.json["materials"][0]["extras"],
            json!({"a": 1, KEEP_NORMALS: true})
        );
        assert_eq!(out.json["materials"][1], json!({"name": "both"}));
        let copy = usize::try_from(used(2).unwrap()).unwrap();
        assert_eq!(out.json["materials"][copy]["name"], "both");
        assert_ne!(used(2), used(4));
    }

    #[test]
    fn single_sided_takes_the_mark_away_again() {
        let mut m = json!({"doubleSided": true, "extras": {KEEP_NORMALS: true}});
        let change = Change {
            single_sided: true,
            ..Change::default()
        };
        edit(&mut m, change, None);
        assert_eq!(m, json!({}));
    }
}
