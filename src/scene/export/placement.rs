//! Which node and which mesh of the document each instance of the model is, and making a mesh
//! its own where a bake differs from placement to placement.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::DMat3;
use serde_json::{Value, json};

use super::writer::{Output, object};
use crate::scene::gltf_document::GltfDocument;
use crate::scene::import::accessor::Source;
use crate::scene::import::json::{extension, integer};
use crate::scene::import::nodes::instancing;
use crate::scene::model::Model;

const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// Where the instances and primitives of a model stand in a document.
#[derive(Debug, Default)]
pub(super) struct Places {
    /// Per instance: its node, and which GPU instance of it; `None` when it is not written.
    pub(super) instances: Vec<Option<Place>>,
    /// Per mesh and primitive of the model: mesh and primitive of the document.
    pub(super) primitives: Vec<Vec<Option<(usize, usize)>>>,
}

/// One instance in the document.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) node: usize,
    pub(super) gpu_instance: Option<usize>,
    /// Linear part of local to world.
    pub(super) linear: DMat3,
}

impl Places {
    /// Places of a model read from glTF.
    pub(super) fn of_source(model: &Model) -> Self {
        let place = |i: &crate::scene::Instance| {
            let (node, gpu_instance) = i.source?;
            Some(Place {
                node,
                gpu_instance,
                linear: i.local_to_world.matrix3,
            })
        };
        let primitives = |m: &crate::scene::Mesh| m.primitives.iter().map(|p| p.source).collect();
        Self {
            instances: model.instances.iter().map(place).collect(),
            primitives: model.meshes.iter().map(primitives).collect(),
        }
    }
}

/// The mesh that each baked instance may edit.
#[derive(Debug)]
pub(super) struct OwnMeshes {
    /// Mesh index in the output, by instance of the model.
    pub(super) mesh: BTreeMap<usize, usize>,
    /// Instances whose mesh is the source's own and used nowhere else.
    pub(super) sole: BTreeSet<usize>,
}

/// Gives each instance of `baked` a mesh of its own.
pub(super) fn separate(
    output: &mut Output,
    document: &Arc<GltfDocument>,
    places: &Places,
    baked: &BTreeSet<usize>,
) -> OwnMeshes {
    let source = &document.json;
    let mesh_of = |node: usize| integer(source.get("nodes")?.get(node)?, "mesh");
    let first_child = expand_gpu_instances(output, document, places, baked);
    // Nodes of the source that use each mesh, and those among them that the bake rewrites.
    let nodes = source
        .get("nodes")
        .and_then(Value::as_array)
        .map_or(0, Vec::len);
    let mut users: BTreeMap<usize, usize> = BTreeMap::new();
    for mesh in (0..nodes).filter_map(mesh_of) {
        *users.entry(mesh).or_default() += 1;
    }
    let baked_places = || {
        baked
            .iter()
            .filter_map(|&i| Some((i, places.instances[i]?)))
    };
    let mut rewritten: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for (_, place) in baked_places() {
        if let Some(mesh) = mesh_of(place.node) {
            rewritten.entry(mesh).or_default().insert(place.node);
        }
    }
    let mut out = OwnMeshes {
        mesh: BTreeMap::new(),
        sole: BTreeSet::new(),
    };
    let mut kept = BTreeSet::new();
    for (instance, place) in baked_places() {
        let Some(mesh) = mesh_of(place.node) else {
            continue;
        };
        // The first placement keeps the source's mesh when nobody else needs it as it was.
        let all = rewritten[&mesh].len() == users[&mesh];
        let own = if all && kept.insert(mesh) {
            if users[&mesh] == 1 && place.gpu_instance.is_none() {
                out.sole.insert(instance);
            }
            mesh
        } else {
            output.push("meshes", source["meshes"][mesh].clone())
        };
        let node = match place.gpu_instance {
            None => place.node,
            Some(k) => first_child[&place.node] + k,
        };
        output.json["nodes"][node]["mesh"] = json!(own);
        out.mesh.insert(instance, own);
    }
    out
}

/// Turns the GPU instances of baked nodes into child nodes; the first child of each node.
fn expand_gpu_instances(
    output: &mut Output,
    document: &GltfDocument,
    places: &Places,
    baked: &BTreeSet<usize>,
) -> BTreeMap<usize, usize> {
    let mut first_child = BTreeMap::new();
    let gpu = |&i: &usize| places.instances[i].filter(|p| p.gpu_instance.is_some());
    let nodes: BTreeSet<usize> = baked.iter().filter_map(gpu).map(|p| p.node).collect();
    let Ok(source) = Source::new(&document.json, &document.buffers) else {
        return first_child;
    };
    for node in nodes {
        let original = &document.json["nodes"][node];
        let transforms = extension(original, INSTANCING)
            .and_then(|e| instancing(e, &source).ok())
            .expect("the importer read these instances");
        let name = original
            .get("name")
            .and_then(Value::as_str)
            .unwrap_or("instance");
        let children: Vec<usize> = transforms
            .iter()
            .enumerate()
            .map(|(k, t)| {
                let (scale, rotation, translation) = t.to_scale_rotation_translation();
                let child = json!({
                    "name": format!("{name} #{k}"),
                    "translation": translation.to_array(),
                    "rotation": rotation.normalize().to_array(),
                    "scale": scale.to_array(),
                    "mesh": original["mesh"],
                });
                output.push("nodes", child)
            })
            .collect();
        let parent = object(&mut output.json["nodes"][node]);
        parent.shift_remove("mesh");
        if let Some(e) = parent.get_mut("extensions").and_then(Value::as_object_mut) {
            e.shift_remove(INSTANCING);
            if e.is_empty() {
                parent.shift_remove("extensions");
            }
        }
        first_child.extend(children.first().map(|&c| (node, c)));
        let list = parent.entry("children").or_insert_with(|| json!([]));
        if let Some(list) = list.as_array_mut() {
            list.extend(children.into_iter().map(|c| json!(c)));
        }
    }
    first_child
}

/// Strikes the instancing extension from the lists when no node has it any more.
pub(super) fn clean_up(output: &mut Output) {
    let nodes = output.json.get("nodes").and_then(Value::as_array);
    let mut nodes = nodes.into_iter().flatten();
    if !nodes.any(|n| extension(n, INSTANCING).is_some()) {
        output.drop_extension(INSTANCING);
    }
}
