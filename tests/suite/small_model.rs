//! A small valid glTF of two leaves and a trunk, to be broken in one place by each test.

use serde_json::{Value, json};

/// A document and the one buffer it refers to.
#[derive(Debug, Clone)]
pub(crate) struct SmallModel {
    /// The JSON chunk.
    pub(crate) json: Value,
    /// The binary chunk: positions (36 vertices' worth of f32 at most), then u16 indices.
    pub(crate) binary: Vec<u8>,
}

/// Two quads of the material `Leaves` and one triangle of `Bark`.
pub(crate) fn small_tree() -> SmallModel {
    let quad = |x: f32, y: f32| {
        [
            [x, y, 0.0],
            [x + 1.0, y, 0.2],
            [x + 1.0, y + 1.0, 0.0],
            [x, y + 1.0, 0.1],
        ]
    };
    let mut positions: Vec<[f32; 3]> = Vec::new();
    positions.extend(quad(-1.5, 2.0));
    positions.extend(quad(0.5, 2.5));
    positions.extend([[-0.1, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 2.0, 0.0]]);
    let leaf_indices: [u16; 12] = [0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7];
    let bark_indices: [u16; 3] = [0, 1, 2];
    let mut binary: Vec<u8> = Vec::new();
    positions
        .iter()
        .flatten()
        .for_each(|v| binary.extend(v.to_le_bytes()));
    let indices_at = binary.len();
    let both = leaf_indices.iter().chain(&bark_indices);
    both.for_each(|i| binary.extend(i.to_le_bytes()));
    while !binary.len().is_multiple_of(4) {
        binary.push(0);
    }
    let json = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": "tree" }],
        "materials": [{ "name": "Leaves", "doubleSided": true }, { "name": "Bark" }],
        "meshes": [{ "primitives": [
            { "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 },
            { "attributes": { "POSITION": 2 }, "indices": 3, "material": 1 },
        ] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3",
              "min": [-1.5, 2.0, 0.0], "max": [1.5, 3.5, 0.2] },
            { "bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR" },
            { "bufferView": 0, "byteOffset": 96, "componentType": 5126, "count": 3, "type": "VEC3",
              "min": [-0.1, 0.0, 0.0], "max": [0.1, 2.0, 0.0] },
            { "bufferView": 1, "byteOffset": 24, "componentType": 5123, "count": 3, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": indices_at, "target": 34962 },
            { "buffer": 0, "byteOffset": indices_at, "byteLength": 30, "target": 34963 },
        ],
        "buffers": [{ "byteLength": binary.len() }],
    });
    SmallModel { json, binary }
}

impl SmallModel {
    /// The same model after `change`.
    pub(crate) fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }

    /// Index number `i` of the leaves becomes `value`.
    pub(crate) fn set_index(&mut self, i: usize, value: u16) {
        let at = 11 * 12 + 2 * i;
        self.binary[at..at + 2].copy_from_slice(&value.to_le_bytes());
    }

    /// Component `c` of position `i` becomes `value`.
    pub(crate) fn set_position(&mut self, i: usize, c: usize, value: f32) {
        let at = 12 * i + 4 * c;
        self.binary[at..at + 4].copy_from_slice(&value.to_le_bytes());
    }

    /// The file's bytes.
    pub(crate) fn glb(&self) -> Vec<u8> {
        let mut json = serde_json::to_vec(&self.json).unwrap();
        while !json.len().is_multiple_of(4) {
            json.push(b' ');
        }
        let length = |n: usize| u32::try_from(n).unwrap().to_le_bytes();
        let total = 12 + 8 + json.len() + 8 + self.binary.len();
        let mut out = Vec::with_capacity(total);
        out.extend(b"glTF");
        out.extend(2u32.to_le_bytes());
        out.extend(length(total));
        out.extend(length(json.len()));
        out.extend(b"JSON");
        out.extend(&json);
        out.extend(length(self.binary.len()));
        out.extend(b"BIN\0");
        out.extend(&self.binary);
        out
    }
}
