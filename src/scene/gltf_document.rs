//! The glTF document behind a model: its JSON and buffers, kept so that export changes only
//! what a bake changes.

/// A glTF file as read: JSON text as a value tree (order kept) and the resolved buffers.
#[derive(Debug, Clone, Default)]
pub struct GltfDocument {
    /// The whole JSON.
    pub json: serde_json::Value,
    /// Buffer contents in the order of `buffers`.
    pub buffers: Vec<Vec<u8>>,
}
