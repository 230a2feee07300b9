//! Which accessors of the source may be overwritten where they lie.
//!
//! New normals have the size of the old ones; when nothing else uses the old bytes they are
//! replaced, so that a baked file does not carry normals that nobody reads.

use gltf::json::accessor::ComponentType;
use serde_json::Value;

use crate::scene::gltf_document::GltfDocument;
use crate::scene::import::accessor::{Layout, Source};

/// Use of the accessors of a source document.
#[derive(Debug, Default)]
pub(super) struct Usage {
    references: Vec<u32>,
    layouts: Vec<Option<Layout>>,
    /// Byte ranges (buffer, start, end) of views that something other than an accessor uses.
    others: Vec<(usize, usize, usize)>,
    sparse: Vec<bool>,
}

impl Usage {
    /// Counts who refers to what in `document`.
    pub(super) fn of(document: &GltfDocument) -> Self {
        let json = &document.json;
        let list = |key: &str| {
            json.get(key)
                .and_then(Value::as_array)
                .map_or(&[][..], |v| v)
        };
        // What the importer read reads again.
        let Ok(source) = Source::new(json, &document.buffers) else {
            return Self::default();
        };
        let accessors = || source.accessors();
        let mut references = vec![0; accessors().len()];
        for v in [
            list("meshes"),
            list("skins"),
            list("animations"),
            list("nodes"),
        ]
        .concat()
        {
            count(&v, "", &mut references);
        }
        let mut by_accessor = vec![false; source.view_count()];
        for view in accessors().filter_map(|a| a.buffer_view) {
            if let Some(used) = by_accessor.get_mut(view.value()) {
                *used = true;
            }
        }
        let alone = (0..by_accessor.len()).filter(|&view| !by_accessor[view]);
        let range = |view| {
            let (buffer, start, length, _) = source.view(view).ok()?;
            Some((buffer, start, start + length))
        };
        Self {
            references,
            layouts: (0..accessors().len())
                .map(|i| source.layout(i).ok())
                .collect(),
            others: alone.filter_map(range).collect(),
            sparse: accessors().map(|a| a.sparse.is_some()).collect(),
        }
    }

    /// Where `count` elements of `width` components may be written over accessor `i`.
    pub(super) fn writable(
        &self,
        i: usize,
        component: ComponentType,
        width: usize,
        count: usize,
    ) -> Option<Layout> {
        let layout = (*self.layouts.get(i)?)?;
        let buffer = layout.buffer?;
        let fits = layout.component == component
            && layout.normalized == (component != ComponentType::F32)
            && (layout.width, layout.count) == (width, count)
            && count > 0;
        if !fits || self.references[i] != 1 || self.sparse[i] {
            return None;
        }
        let end = extent(&layout);
        let apart = |b: usize, s: usize, e: usize| b != buffer || e <= layout.start || s >= end;
        let accessors = self.layouts.iter().enumerate().filter(|(j, _)| *j != i);
        let alone = accessors.filter_map(|(_, l)| *l).all(|l| {
            l.buffer
                .is_none_or(|b| apart(b, l.start, extent(&l)) || interleaved(&layout, &l))
        });
        let alone = alone && self.others.iter().all(|&(b, s, e)| apart(b, s, e));
        alone.then_some(layout)
    }
}

fn element(l: &Layout) -> usize {
    l.width * l.component.size()
}

fn extent(l: &Layout) -> usize {
    match l.count {
        0 => l.start,
        n => l.start + (n - 1) * l.stride + element(l),
    }
}

/// Whether two layouts of equal stride never touch the same byte.
fn interleaved(a: &Layout, b: &Layout) -> bool {
    if a.stride != b.stride {
        return false;
    }
    let shift = (b.start % a.stride + a.stride - a.start % a.stride) % a.stride;
    shift >= element(a) && shift + element(b) <= a.stride
}

/// Counts every number under a key that refers to an accessor; unknown extensions may count
/// too much, which only makes an accessor less free to overwrite.
fn count(v: &Value, key: &str, references: &mut [u32]) {
    match v {
        Value::Object(members) => {
            for (k, member) in members {
                let inherited = matches!(key, "attributes" | "targets");
                count(member, if inherited { key } else { k }, references);
            }
        }
        Value::Array(list) => list.iter().for_each(|v| count(v, key, references)),
        Value::Number(_) => {
            let names = [
                "attributes",
                "targets",
                "indices",
                "input",
                "output",
                "inverseBindMatrices",
            ];
            if names.contains(&key)
                && let Some(r) = v.as_u64().and_then(|i| references.get_mut(i as usize))
            {
                *r += 1;
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::ComponentType::F32;
    use super::*;
    use serde_json::json;

    fn usage(edit: fn(&mut Value)) -> Usage {
        let mut json = json!({
            "bufferViews": [
                {"buffer": 0, "byteLength": 96, "byteStride": 24},
                {"buffer": 0, "byteOffset": 96, "byteLength": 48}],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4},
                {"bufferView": 0, "byteOffset": 12, "componentType": 5126, "type": "VEC3", "count": 4},
                {"bufferView": 1, "componentType": 5126, "type": "VEC3", "count": 4}],
            "meshes": [{"primitives": [
                {"attributes": {"POSITION": 0, "NORMAL": 1}},
                {"attributes": {"POSITION": 0, "NORMAL": 2}}]}]
        });
        edit(&mut json);
        Usage::of(&GltfDocument {
            json,
            buffers: vec![vec![0; 144]],
        })
    }

    #[test]
    fn only_bytes_that_nobody_else_reads_are_writable() {
        let u = usage(|_| ());
        assert!(
            u.writable(0, F32, 3, 4).is_none(),
            "shared by two primitives"
        );
        assert_eq!(u.writable(1, F32, 3, 4).unwrap().start, 12);
        assert_eq!(u.writable(2, F32, 3, 4).unwrap().start, 96);
        assert!(u.writable(2, F32, 1, 4).is_none() && u.writable(2, F32, 3, 3).is_none());
        let overlapping = usage(|j| j["accessors"][0]["byteOffset"] = json!(8));
        assert!(overlapping.writable(1, F32, 3, 4).is_none());
        let image = usage(|j| {
            let view = json!({"buffer": 0, "byteOffset": 140, "byteLength": 4});
            j["bufferViews"].as_array_mut().unwrap().push(view);
        });
        assert!(image.writable(2, F32, 3, 4).is_none());
        let morph = usage(|j| j["meshes"][0]["primitives"][0]["targets"] = json!([{"NORMAL": 2}]));
        assert!(morph.writable(2, F32, 3, 4).is_none());
    }
}
