//! A document being written: its JSON and the one binary chunk.

use bytemuck::Pod;
use gltf::binary::{Glb, Header};
use gltf::json::accessor::ComponentType::{F32, U16, U32};
use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::buffer::{Target, View};
use gltf::json::validation::Checked::Valid;
use gltf::json::{Accessor, Index};
use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::scene::gltf_document::GltfDocument;
use crate::scene::import::json::integer;
use crate::scene::model::{ImageSource, Model};
use crate::scene::textures::media_type;
use crate::{Error, Result};

/// JSON and binary chunk under construction.
#[derive(Debug)]
pub(super) struct Output {
    pub(super) json: Value,
    pub(super) bin: Vec<u8>,
    /// Where each buffer of the source begins in `bin`; `None` when no view uses it.
    pub(super) bases: Vec<Option<usize>>,
}

/// `v` as an object; anything else is replaced by an empty one.
pub(super) fn object(v: &mut Value) -> &mut Map<String, Value> {
    if !v.is_object() {
        *v = json!({});
    }
    v.as_object_mut().expect("made an object above")
}

/// An object of the `gltf` crate as JSON.
pub(super) fn plain(object: impl Serialize) -> Value {
    serde_json::to_value(object).expect("its types are plain data with names as keys")
}

impl Output {
    /// Copies a document; its buffers become one.
    pub(super) fn new(document: &GltfDocument) -> Self {
        let mut out = Self {
            json: document.json.clone(),
            bin: Vec::new(),
            bases: vec![None; document.buffers.len()],
        };
        let mut views = out.json.get_mut("bufferViews").map(Value::take);
        for view in views.iter_mut().filter_map(Value::as_array_mut).flatten() {
            out.adopt(view, &document.buffers);
        }
        if let Some(views) = views {
            out.json["bufferViews"] = views;
        }
        out
    }

    /// Points a view of the source into the one buffer.
    fn adopt(&mut self, view: &mut Value, buffers: &[Vec<u8>]) {
        let buffer = integer(view, "buffer");
        let Some((i, bytes)) = buffer.and_then(|i| Some((i, buffers.get(i)?))) else {
            return;
        };
        if self.bases[i].is_none() {
            self.align();
            self.bases[i] = Some(self.bin.len());
            self.bin.extend_from_slice(bytes);
        }
        let base = self.bases[i].unwrap_or(0);
        view["buffer"] = json!(0);
        if base > 0 {
            let offset = integer(view, "byteOffset").unwrap_or(0);
            view["byteOffset"] = json!(offset.saturating_add(base));
        }
    }

    fn align(&mut self) {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
    }

    /// Puts images that lie in files of their own into the binary chunk, byte by byte.
    pub(super) fn embed_images(&mut self, model: &Model) {
        let count = self
            .json
            .get("images")
            .and_then(Value::as_array)
            .map_or(0, Vec::len);
        for i in 0..count {
            let uri = self.json["images"][i].get("uri").and_then(Value::as_str);
            let Some(uri) = uri.filter(|u| !u.starts_with("data:")).map(str::to_owned) else {
                continue;
            };
            let Some(ImageSource::Encoded { bytes, .. }) = model.images.get(i) else {
                continue;
            };
            let view = self.view(bytes, None);
            let image = object(&mut self.json["images"][i]);
            image.shift_remove("uri");
            image.insert("bufferView".into(), json!(view));
            if let Some(media) = media_type(bytes) {
                image.insert("mimeType".into(), json!(media));
            }
            image.entry("name").or_insert_with(|| json!(uri));
        }
    }

    /// Appends to a top-level array; the new index.
    pub(super) fn push(&mut self, list: &str, value: Value) -> usize {
        let array = object(&mut self.json)
            .entry(list)
            .or_insert_with(|| json!([]));
        if !array.is_array() {
            *array = json!([]);
        }
        let array = array.as_array_mut().expect("made an array above");
        array.push(value);
        array.len() - 1
    }

    /// Appends bytes as a buffer view.
    pub(super) fn view(&mut self, bytes: &[u8], target: Option<Target>) -> usize {
        self.align();
        let view = View {
            buffer: Index::new(0),
            byte_length: bytes.len().into(),
            byte_offset: Some(self.bin.len().into()),
            byte_stride: None,
            name: None,
            target: target.map(Valid),
            extensions: None,
            extras: None,
        };
        self.bin.extend_from_slice(bytes);
        self.push("bufferViews", plain(view))
    }

    fn accessor(
        &mut self,
        bytes: &[u8],
        target: Target,
        (component, kind): (ComponentType, Type),
        count: usize,
    ) -> usize {
        let view = u32::try_from(self.view(bytes, Some(target))).expect("fewer views than bytes");
        let accessor = Accessor {
            buffer_view: Some(Index::new(view)),
            byte_offset: None,
            count: count.into(),
            component_type: Valid(GenericComponentType(component)),
            extensions: None,
            extras: None,
            type_: Valid(kind),
            min: None,
            max: None,
            name: None,
            normalized: component == U16 && matches!(target, Target::ArrayBuffer),
            sparse: None,
        };
        self.push("accessors", plain(accessor))
    }

    fn attribute(
        &mut self,
        bytes: &[u8],
        component: ComponentType,
        n: usize,
        count: usize,
    ) -> usize {
        let kind = [Type::Scalar, Type::Vec2, Type::Vec3, Type::Vec4][n - 1];
        self.accessor(bytes, Target::ArrayBuffer, (component, kind), count)
    }

    /// An attribute of floats.
    pub(super) fn floats<T: Pod, const N: usize>(&mut self, values: &[[T; N]]) -> usize {
        assert_eq!(size_of::<T>(), 4, "a float has four bytes");
        let bytes = bytemuck::cast_slice(values.as_flattened());
        self.attribute(bytes, F32, N, values.len())
    }

    /// An attribute of normalised 16-bit integers.
    pub(super) fn unorm16<T: Pod, const N: usize>(&mut self, values: &[[T; N]]) -> usize {
        assert_eq!(size_of::<T>(), 2, "a 16-bit integer has two bytes");
        let bytes = bytemuck::cast_slice(values.as_flattened());
        self.attribute(bytes, U16, N, values.len())
    }

    /// Triangle indices, 16-bit where they fit (65535 is reserved).
    pub(super) fn indices(&mut self, indices: &[u32]) -> usize {
        let small = indices.iter().all(|&i| i < 65535);
        let short: Vec<u16>;
        let (bytes, component) = if small {
            short = indices.iter().map(|&i| i as u16).collect();
            (bytemuck::cast_slice(&short), U16)
        } else {
            (bytemuck::cast_slice(indices), U32)
        };
        let target = Target::ElementArrayBuffer;
        self.accessor(bytes, target, (component, Type::Scalar), indices.len())
    }

    /// Names an extension in `extensionsUsed`.
    pub(super) fn use_extension(&mut self, name: &str) {
        let used = self.json.get("extensionsUsed").and_then(Value::as_array);
        if !used.is_some_and(|u| u.iter().any(|n| n == name)) {
            self.push("extensionsUsed", json!(name));
        }
    }

    /// Strikes an extension from `extensionsUsed` and `extensionsRequired`.
    pub(super) fn drop_extension(&mut self, name: &str) {
        for key in ["extensionsUsed", "extensionsRequired"] {
            let Some(list) = self.json.get_mut(key).and_then(Value::as_array_mut) else {
                continue;
            };
            list.retain(|n| n != name);
            if list.is_empty() {
                object(&mut self.json).shift_remove(key);
            }
        }
    }

    /// The GLB.
    pub(super) fn finish(mut self) -> Result<Vec<u8>> {
        self.align();
        let mut buffer = match self.json.get("buffers").and_then(|b| b.get(0)) {
            Some(first) => first.clone(),
            None => json!({}),
        };
        let members = object(&mut buffer);
        members.shift_remove("uri");
        members.insert("byteLength".into(), json!(self.bin.len()));
        if self.bin.is_empty() {
            object(&mut self.json).shift_remove("buffers");
        } else {
            self.json["buffers"] = json!([buffer]);
        }
        let text = serde_json::to_vec(&self.json)
            .map_err(|e| Error::usage(format!("the glTF cannot be written as JSON: {e}")))?;
        // The crate writes the length of a larger file without its upper bits.
        let length = 12 + 8 + text.len().next_multiple_of(4) + 8 + self.bin.len();
        if u32::try_from(length).is_err() {
            return Err(Error::Unsupported(format!(
                "the model needs {length} bytes; a GLB holds 4 GiB"
            )));
        }
        let glb = Glb {
            header: Header {
                magic: *b"glTF",
                version: 2,
                length: 0, // The writer counts for itself.
            },
            json: text.into(),
            bin: (!self.bin.is_empty()).then(|| self.bin.into()),
        };
        let whole = glb.to_vec();
        whole.map_err(|e| Error::usage(format!("the GLB cannot be written: {e}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_buffers_become_one_aligned_chunk() {
        let document = GltfDocument {
            json: json!({
                "asset": {"version": "2.0"},
                "buffers": [{"byteLength": 3, "uri": "a.bin", "name": "n"}, {"byteLength": 9}, {"byteLength": 2}],
                "bufferViews": [
                    {"buffer": 0, "byteOffset": 1, "byteLength": 2},
                    {"buffer": 2, "byteLength": 2}]
            }),
            buffers: vec![vec![1, 2, 3], vec![9; 9], vec![7, 8]],
        };
        let out = Output::new(&document);
        assert_eq!(out.bin, [1, 2, 3, 0, 7, 8]);
        assert_eq!(out.bases, [Some(0), None, Some(4)]);
        let glb = out.finish().unwrap();
        assert_eq!(glb.len() % 4, 0);
        let size = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
        let json: Value = serde_json::from_slice(&glb[20..20 + size]).unwrap();
        assert_eq!(json["buffers"], json!([{"byteLength": 8, "name": "n"}]));
        assert_eq!(
            json["bufferViews"][1],
            json!({"buffer": 0, "byteLength": 2, "byteOffset": 4})
        );
    }
}
