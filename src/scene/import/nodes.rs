//! The node graph: placements of meshes and lights in world coordinates.

use glam::{DAffine3, DMat3, DQuat, DVec3};
use gltf::json::accessor::Accessor;
use gltf::json::extensions::scene::khr_lights_punctual::{Light, Spot, Type};
use gltf::json::{Index, Node};
use serde::Deserialize;
use serde_json::Value;

use super::accessor::Source;
use super::json::{Check, Of, array, at, extension, known, label, list, name, typed};
use crate::scene::model::{Instance, LightKind, PunctualLight};

/// A node and its JSON.
type Item<'a> = (Node, &'a Value);

/// What the scene places.
#[derive(Debug, Default)]
pub(super) struct Placed {
    pub(super) instances: Vec<Instance>,
    pub(super) lights: Vec<PunctualLight>,
    pub(super) skinned: usize,
    pub(super) hidden: usize,
}

/// Walks the default scene (or the first, or all roots when there is no scene).
pub(super) fn place(json: &Value, source: &Source<'_>, meshes: usize) -> Check<Placed> {
    let nodes: Vec<Item<'_>> = list(json, "nodes", "node")?;
    let children = tree(&nodes)?;
    let mut stack: Vec<(usize, DAffine3)> = roots(json, nodes.len(), &children)?
        .into_iter()
        .rev()
        .map(|i| (i, DAffine3::IDENTITY))
        .collect();
    let mut walk = Walk {
        source,
        lights: extension(json, "KHR_lights_punctual")
            .map_or_else(|| Ok(vec![]), |e| list(e, "lights", "light"))?,
        meshes,
        seen: vec![false; nodes.len()],
        out: Placed::default(),
    };
    while let Some((i, parent)) = stack.pop() {
        let read = walk.node(i, &nodes[i], parent);
        if let Some(world) = read.of(|| label("node", i, nodes[i].1))? {
            stack.extend(children[i].iter().rev().map(|&c| (c, world)));
        }
    }
    Ok(walk.out)
}

/// Children of every node; a node with two parents or in a cycle is an error.
fn tree(nodes: &[Item<'_>]) -> Check<Vec<Vec<usize>>> {
    let mut parent = vec![None; nodes.len()];
    let mut children = Vec::with_capacity(nodes.len());
    for (i, (node, v)) in nodes.iter().enumerate() {
        let mut list = Vec::new();
        for &c in node.children.iter().flatten() {
            let c = at(c, "children", nodes.len()).of(|| label("node", i, v))?;
            if let Some(other) = parent[c].replace(i) {
                return Err(format!(
                    "node {c} is a child of node {other} and of node {i}"
                ));
            }
            list.push(c);
        }
        children.push(list);
    }
    // With one parent each, whatever is not reached from a root is in or below a cycle.
    let mut reached = vec![false; nodes.len()];
    let mut stack: Vec<usize> = (0..nodes.len()).filter(|&i| parent[i].is_none()).collect();
    while let Some(i) = stack.pop() {
        reached[i] = true;
        stack.extend(&children[i]);
    }
    match reached.iter().position(|r| !r) {
        Some(i) => Err(format!(
            "node {i} is its own ancestor: the node graph has a cycle"
        )),
        None => Ok(children),
    }
}

fn roots(json: &Value, nodes: usize, children: &[Vec<usize>]) -> Check<Vec<usize>> {
    // Without the crate's type for scenes, which wants `nodes` to be there.
    let scenes = array(json, "scenes")?;
    let scene = match json.get("scene") {
        Some(v) => at(
            typed::<Index<Value>>(v).of(|| "\"scene\"".into())?,
            "scene",
            scenes.len(),
        )?,
        None => 0,
    };
    if let Some(v) = scenes.get(scene) {
        let read = |n| at(typed::<Index<Node>>(n)?, "nodes", nodes);
        let list = array(v, "nodes").and_then(|l| l.iter().map(read).collect());
        return list.of(|| label("scene", scene, v));
    }
    let mut is_child = vec![false; nodes];
    for &c in children.iter().flatten() {
        is_child[c] = true;
    }
    Ok((0..nodes).filter(|&i| !is_child[i]).collect())
}

struct Walk<'a> {
    source: &'a Source<'a>,
    lights: Vec<(Light, &'a Value)>,
    meshes: usize,
    seen: Vec<bool>,
    out: Placed,
}

impl Walk<'_> {
    /// Places what `node` bears; its world transform, or `None` when it is hidden.
    fn node(&mut self, i: usize, item: &Item<'_>, parent: DAffine3) -> Check<Option<DAffine3>> {
        let (node, v) = item;
        if std::mem::replace(&mut self.seen[i], true) {
            return Err("is reached twice from the scene".into());
        }
        let visibility = extension(v, "KHR_node_visibility");
        if visibility.is_some_and(|v| v.get("visible") == Some(&Value::Bool(false))) {
            self.out.hidden += 1;
            return Ok(None);
        }
        let world = parent * local(v)?;
        if !world.is_finite() {
            return Err("its transform is not finite".into());
        }
        if let Some(mesh) = node.mesh {
            let mesh = at(mesh, "mesh", self.meshes)?;
            self.mesh(i, item, mesh, world)?;
        }
        let lit = node.extensions.as_ref();
        if let Some(e) = lit.and_then(|e| e.khr_lights_punctual.as_ref()) {
            let k = at(e.light, "light", self.lights.len())?;
            let (light, v) = &self.lights[k];
            let light = punctual(light, v, world).of(|| label("light", k, v))?;
            self.out.lights.push(light);
        }
        Ok(Some(world))
    }

    fn mesh(&mut self, i: usize, item: &Item<'_>, mesh: usize, world: DAffine3) -> Check<()> {
        let (node, v) = item;
        let title = name("node", i, v);
        if let Some(e) = extension(v, "EXT_mesh_gpu_instancing") {
            let transforms = instancing(e, self.source).of(|| "EXT_mesh_gpu_instancing".into())?;
            for (k, t) in transforms.iter().enumerate() {
                self.out.instances.push(Instance {
                    name: format!("{title} #{k}"),
                    mesh,
                    local_to_world: world * *t,
                    source: Some((i, Some(k))),
                });
            }
            return Ok(());
        }
        // A skinned mesh ignores its node's transform (glTF 2.0, 3.7.3.3).
        let skinned = node.skin.is_some();
        self.out.skinned += usize::from(skinned);
        self.out.instances.push(Instance {
            name: title,
            mesh,
            local_to_world: if skinned { DAffine3::IDENTITY } else { world },
            source: Some((i, None)),
        });
        Ok(())
    }
}

/// The transform of a node as the crate has it, but in f64: a plant at 5 000 000 m would
/// stand half a metre beside its place.
#[derive(Deserialize)]
struct Transform {
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

/// Local transform of a node.
fn local(node: &Value) -> Check<DAffine3> {
    let t: Transform = typed(node)?;
    if let Some(m) = t.matrix {
        let column = |c: usize| DVec3::new(m[4 * c], m[4 * c + 1], m[4 * c + 2]);
        return Ok(DAffine3 {
            matrix3: DMat3::from_cols(column(0), column(1), column(2)),
            translation: column(3),
        });
    }
    Ok(DAffine3::from_scale_rotation_translation(
        t.scale.unwrap_or([1.0; 3]).into(),
        unit(DQuat::from_array(
            t.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]),
        ))?,
        t.translation.unwrap_or([0.0; 3]).into(),
    ))
}

/// `EXT_mesh_gpu_instancing`; attributes of other programs are left alone.
#[derive(Deserialize)]
struct Instancing {
    attributes: InstanceAttributes,
}

#[derive(Deserialize)]
#[serde(rename_all = "UPPERCASE")]
struct InstanceAttributes {
    translation: Option<Index<Accessor>>,
    rotation: Option<Index<Accessor>>,
    scale: Option<Index<Accessor>>,
}

fn unit(q: DQuat) -> Check<DQuat> {
    let length = q.length();
    if length.is_finite() && length > 1e-9 {
        Ok(q / length)
    } else {
        Err("\"rotation\" has length zero".into())
    }
}

/// Transforms of `EXT_mesh_gpu_instancing`, relative to the node.
pub(in crate::scene) fn instancing(e: &Value, source: &Source<'_>) -> Check<Vec<DAffine3>> {
    let a = typed::<Instancing>(e)?.attributes;
    let get = |i: Option<_>, key| i.map(|i| source.at(i, key)).transpose();
    let t = get(a.translation, "TRANSLATION")?;
    let (r, s) = (get(a.rotation, "ROTATION")?, get(a.scale, "SCALE")?);
    let mut count = None;
    for i in [t, r, s].into_iter().flatten() {
        let n = source.layout(i)?.count;
        if *count.get_or_insert(n) != n {
            return Err("its attributes differ in count".into());
        }
    }
    let n = count.ok_or("has none of TRANSLATION, ROTATION, SCALE")?;
    let t = t.map_or_else(|| Ok(vec![[0.0; 3]; n]), |i| source.vectors::<3>(i))?;
    let r = r.map_or_else(
        || Ok(vec![[0.0, 0.0, 0.0, 1.0]; n]),
        |i| source.vectors::<4>(i),
    )?;
    let s = s.map_or_else(|| Ok(vec![[1.0; 3]; n]), |i| source.vectors::<3>(i))?;
    let one = |k: usize| {
        let m = DAffine3::from_scale_rotation_translation(
            DVec3::from(s[k].map(f64::from)),
            unit(DQuat::from_array(r[k].map(f64::from)))?,
            DVec3::from(t[k].map(f64::from)),
        );
        if m.is_finite() {
            Ok(m)
        } else {
            Err("is not finite".to_owned())
        }
    };
    (0..n)
        .map(|k| one(k).of(|| format!("instance {k}")))
        .collect()
}

fn punctual(light: &Light, v: &Value, world: DAffine3) -> Check<PunctualLight> {
    let kind = match known(light.type_, v, "type")? {
        Type::Directional => LightKind::Directional,
        Type::Point => LightKind::Point,
        Type::Spot => {
            let angles = |s: &Spot| (s.inner_cone_angle, s.outer_cone_angle);
            let none = (0.0, std::f32::consts::FRAC_PI_4);
            let (inner, outer) = light.spot.as_ref().map_or(none, angles);
            LightKind::Spot { inner, outer }
        }
    };
    Ok(PunctualLight {
        kind,
        color: light.color.map(|c| c * light.intensity),
        position: world.translation,
        direction: (world.matrix3 * DVec3::NEG_Z).normalize_or(DVec3::NEG_Z),
        range: light.range.unwrap_or(f32::INFINITY),
    })
}
