//! The node graph: placements of meshes and lights in world coordinates.

use glam::{DAffine3, DMat3, DQuat, DVec3};
use serde_json::Value;

use super::accessor::Source;
use super::json::{
    Check, Of, array, as_index, extension, index, label, name, number, numbers, text,
};
use crate::scene::model::{Instance, LightKind, PunctualLight};

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
    let nodes = array(json, "nodes")?;
    let children = tree(nodes)?;
    let mut stack: Vec<(usize, DAffine3)> = roots(json, nodes.len(), &children)?
        .into_iter()
        .rev()
        .map(|i| (i, DAffine3::IDENTITY))
        .collect();
    let mut walk = Walk {
        source,
        lights: extension(json, "KHR_lights_punctual")
            .map_or(Ok(&[][..]), |e| array(e, "lights"))?,
        meshes,
        seen: vec![false; nodes.len()],
        out: Placed::default(),
    };
    while let Some((i, parent)) = stack.pop() {
        let node = &nodes[i];
        if let Some(world) = walk.node(i, node, parent).of(|| label("node", i, node))? {
            stack.extend(children[i].iter().rev().map(|&c| (c, world)));
        }
    }
    Ok(walk.out)
}

/// Children of every node; a node with two parents or in a cycle is an error.
fn tree(nodes: &[Value]) -> Check<Vec<Vec<usize>>> {
    let mut parent = vec![None; nodes.len()];
    let mut children = Vec::with_capacity(nodes.len());
    for (i, node) in nodes.iter().enumerate() {
        let mut list = Vec::new();
        for c in array(node, "children").of(|| label("node", i, node))? {
            let c = as_index(c, "children", nodes.len()).of(|| label("node", i, node))?;
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
    let scenes = array(json, "scenes")?;
    let scene = index(json, "scene", scenes.len())?.unwrap_or(0);
    if let Some(scene_object) = scenes.get(scene) {
        return array(scene_object, "nodes")?
            .iter()
            .map(|n| as_index(n, "nodes", nodes))
            .collect::<Check<_>>()
            .of(|| label("scene", scene, scene_object));
    }
    let mut is_child = vec![false; nodes];
    for &c in children.iter().flatten() {
        is_child[c] = true;
    }
    Ok((0..nodes).filter(|&i| !is_child[i]).collect())
}

struct Walk<'a> {
    source: &'a Source<'a>,
    lights: &'a [Value],
    meshes: usize,
    seen: Vec<bool>,
    out: Placed,
}

impl Walk<'_> {
    /// Places what `node` bears; its world transform, or `None` when it is hidden.
    fn node(&mut self, i: usize, node: &Value, parent: DAffine3) -> Check<Option<DAffine3>> {
        if std::mem::replace(&mut self.seen[i], true) {
            return Err("is reached twice from the scene".into());
        }
        let visibility = extension(node, "KHR_node_visibility");
        if visibility.is_some_and(|v| v.get("visible") == Some(&Value::Bool(false))) {
            self.out.hidden += 1;
            return Ok(None);
        }
        let world = parent * local(node)?;
        if !world.is_finite() {
            return Err("its transform is not finite".into());
        }
        if let Some(mesh) = index(node, "mesh", self.meshes)? {
            self.mesh(i, node, mesh, world)?;
        }
        if let Some(e) = extension(node, "KHR_lights_punctual") {
            let light = index(e, "light", self.lights.len())?.ok_or("\"light\" is missing")?;
            let v = &self.lights[light];
            let light = punctual(v, world).of(|| label("light", light, v))?;
            self.out.lights.push(light);
        }
        Ok(Some(world))
    }

    fn mesh(&mut self, i: usize, node: &Value, mesh: usize, world: DAffine3) -> Check<()> {
        let title = name("node", i, node);
        if let Some(e) = extension(node, "EXT_mesh_gpu_instancing") {
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
        let skinned = node.get("skin").is_some();
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

/// Local transform of a node.
fn local(node: &Value) -> Check<DAffine3> {
    if let Some(m) = numbers::<16>(node, "matrix")? {
        let column = |c: usize| DVec3::new(m[4 * c], m[4 * c + 1], m[4 * c + 2]);
        return Ok(DAffine3 {
            matrix3: DMat3::from_cols(column(0), column(1), column(2)),
            translation: column(3),
        });
    }
    let t = numbers(node, "translation")?.unwrap_or([0.0; 3]);
    let s = numbers(node, "scale")?.unwrap_or([1.0; 3]);
    let r = numbers(node, "rotation")?.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    Ok(DAffine3::from_scale_rotation_translation(
        s.into(),
        unit(DQuat::from_array(r))?,
        t.into(),
    ))
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
    let none = Value::Null;
    let attributes = e.get("attributes").unwrap_or(&none);
    let get = |key| index(attributes, key, source.len());
    let (t, r, s) = (get("TRANSLATION")?, get("ROTATION")?, get("SCALE")?);
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

fn punctual(light: &Value, world: DAffine3) -> Check<PunctualLight> {
    let kind = match text(light, "type")?.ok_or("\"type\" is missing")? {
        "directional" => LightKind::Directional,
        "point" => LightKind::Point,
        "spot" => {
            let none = Value::Null;
            let spot = light.get("spot").unwrap_or(&none);
            let outer = number(spot, "outerConeAngle")?.unwrap_or(std::f64::consts::FRAC_PI_4);
            LightKind::Spot {
                inner: number(spot, "innerConeAngle")?.unwrap_or(0.0) as f32,
                outer: outer as f32,
            }
        }
        other => return Err(format!("type {other} does not exist")),
    };
    let intensity = number(light, "intensity")?.unwrap_or(1.0);
    let color = numbers(light, "color")?.unwrap_or([1.0; 3]);
    Ok(PunctualLight {
        kind,
        color: color.map(|c| (c * intensity) as f32),
        position: world.translation,
        direction: (world.matrix3 * DVec3::NEG_Z).normalize_or(DVec3::NEG_Z),
        range: number(light, "range")?.map_or(f32::INFINITY, |r| r as f32),
    })
}
