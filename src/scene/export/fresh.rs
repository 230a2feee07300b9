//! A new document for a model that has none: grown plants, OBJ files, populations.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use gltf::json::texture::{MagFilter, MinFilter, Sampler, WrappingMode};
use gltf::json::validation::Checked::Valid;
use serde_json::{Value, json};

use super::placement::{Place, Places};
use super::writer::{Output, object, plain};
use crate::Result;
use crate::scene::geometry::{cofactors, repair_normals};
use crate::scene::gltf_document::GltfDocument;
use crate::scene::import::material::KEEP_NORMALS;
use crate::scene::model::{
    AlphaMode, Botany, ImageSource, Instance, LightKind, Material, Mesh, Model, Primitive,
    PunctualLight, Texture, TextureRef, Wrap,
};
use crate::scene::textures::{encode_png, media_type};

/// The document of `model` and where its parts stand in it.
pub(super) fn document(model: &Model) -> Result<(Arc<GltfDocument>, Places)> {
    let mut out = Output::new(&GltfDocument::default());
    let generator = format!("umbrage {}", env!("CARGO_PKG_VERSION"));
    out.json = json!({"asset": {"version": "2.0", "generator": generator}});
    out.json["scene"] = json!(0);
    out.json["scenes"] = json!([{"name": model.name, "nodes": []}]);
    for image in &model.images {
        write_image(&mut out, image)?;
    }
    for texture in &model.textures {
        write_texture(&mut out, texture);
    }
    for m in &model.materials {
        let json = material(&mut out, m);
        out.push("materials", json);
    }
    let mut places = Places::default();
    let mut written = Vec::new();
    for m in &model.meshes {
        let (index, primitives) = mesh(&mut out, m);
        written.push(index);
        places.primitives.push(primitives);
    }
    let mut roots = Vec::new();
    for instance in &model.instances {
        let place = node(&mut out, instance, model, written[instance.mesh]);
        roots.push(place.node);
        places.instances.push(Some(place));
    }
    roots.extend(lights(&mut out, &model.lights));
    out.json["scenes"][0]["nodes"] = json!(roots);
    if roots.is_empty() {
        object(&mut out.json["scenes"][0]).shift_remove("nodes");
    }
    out.json["buffers"] = json!([{"byteLength": out.bin.len()}]);
    let document = GltfDocument {
        json: out.json,
        buffers: vec![out.bin],
    };
    Ok((Arc::new(document), places))
}

fn write_image(out: &mut Output, image: &ImageSource) -> Result<()> {
    let (name, view, media) = match image {
        ImageSource::Encoded { name, bytes } => (name, out.view(bytes, None), media_type(bytes)),
        ImageSource::Rgba8 {
            name,
            width,
            height,
            pixels,
        } => {
            let png = encode_png(*width, *height, pixels)?;
            (name, out.view(&png, None), Some("image/png"))
        }
    };
    let mut json = json!({"name": name, "bufferView": view});
    json["mimeType"] = json!(media.unwrap_or("image/png"));
    out.push("images", json);
    Ok(())
}

fn write_texture(out: &mut Output, texture: &Texture) {
    let wrap = |w: Wrap| {
        Valid(match w {
            Wrap::Repeat => WrappingMode::Repeat,
            Wrap::Clamp => WrappingMode::ClampToEdge,
            Wrap::Mirror => WrappingMode::MirroredRepeat,
        })
    };
    let magnify = if texture.nearest {
        MagFilter::Nearest
    } else {
        MagFilter::Linear
    };
    let sampler = plain(Sampler {
        mag_filter: Some(Valid(magnify)),
        min_filter: Some(Valid(MinFilter::LinearMipmapLinear)),
        wrap_s: wrap(texture.wrap_u),
        wrap_t: wrap(texture.wrap_v),
        ..Sampler::default()
    });
    let samplers = out.json.get("samplers").and_then(Value::as_array);
    let same = samplers.and_then(|list| list.iter().position(|s| *s == sampler));
    let sampler = same.unwrap_or_else(|| out.push("samplers", sampler));
    out.push(
        "textures",
        json!({"sampler": sampler, "source": texture.image}),
    );
}

fn texture_info(out: &mut Output, t: &TextureRef) -> Value {
    let mut info = json!({"index": t.texture});
    if t.texcoord > 0 {
        info["texCoord"] = json!(t.texcoord);
    }
    let [[a, b, tu], [c, d, tv]] = t.transform.map(|row| row.map(f64::from));
    if t.transform != TextureRef::new(0).transform {
        // Rows are (cos su, sin sv), (-sin su, cos sv); see the importer.
        let e = json!({
            "offset": [tu, tv], "rotation": (-c).atan2(a), "scale": [a.hypot(c), b.hypot(d)]
        });
        info["extensions"] = json!({"KHR_texture_transform": e});
        out.use_extension("KHR_texture_transform");
    }
    info
}

fn material(out: &mut Output, m: &Material) -> Value {
    let mut pbr = json!({
        "baseColorFactor": m.base_color.map(|c| f64::from(c.clamp(0.0, 1.0))),
        "metallicFactor": f64::from(m.metallic), "roughnessFactor": f64::from(m.roughness)
    });
    if let Some(t) = &m.base_color_texture {
        pbr["baseColorTexture"] = texture_info(out, t);
    }
    let mut json = json!({"name": m.name, "pbrMetallicRoughness": pbr});
    match m.alpha_mode {
        AlphaMode::Opaque => {}
        AlphaMode::Mask { cutoff } => {
            json["alphaMode"] = json!("MASK");
            json["alphaCutoff"] = json!(f64::from(cutoff));
        }
        AlphaMode::Blend => json["alphaMode"] = json!("BLEND"),
    }
    if m.double_sided {
        json["doubleSided"] = json!(true);
    }
    if m.unflipped_back_faces {
        json["extras"] = json!({KEEP_NORMALS: true});
    }
    if let Some((t, strength)) = &m.occlusion_texture {
        json["occlusionTexture"] = texture_info(out, t);
        json["occlusionTexture"]["strength"] = json!(f64::from(strength.clamp(0.0, 1.0)));
    }
    let strength = m.emissive.iter().fold(1.0f32, |s, &c| s.max(c));
    if m.emissive != [0.0; 3] {
        json["emissiveFactor"] = json!(m.emissive.map(|c| f64::from(c / strength)));
    }
    let mut extension = |name: &str, value: Value| {
        json["extensions"][name] = value;
        out.use_extension(name);
    };
    if strength > 1.0 {
        let e = json!({"emissiveStrength": f64::from(strength)});
        extension("KHR_materials_emissive_strength", e);
    }
    if m.unlit {
        extension("KHR_materials_unlit", json!({}));
    }
    diffuse_transmission(out, m, &mut json);
    json
}

fn diffuse_transmission(out: &mut Output, m: &Material, json: &mut Value) {
    let Some(d) = &m.diffuse_transmission else {
        return;
    };
    let mut e = json!({
        "diffuseTransmissionFactor": f64::from(d.factor),
        "diffuseTransmissionColorFactor": d.color.map(f64::from)
    });
    if let Some(t) = &d.texture {
        e["diffuseTransmissionTexture"] = texture_info(out, t);
    }
    if let Some(t) = &d.color_texture {
        e["diffuseTransmissionColorTexture"] = texture_info(out, t);
    }
    json["extensions"]["KHR_materials_diffuse_transmission"] = e;
    out.use_extension("KHR_materials_diffuse_transmission");
}

/// Writes a mesh; its index, and where its primitives stand. Primitives without triangles
/// cannot be written (accessors have at least one element).
fn mesh(out: &mut Output, m: &Mesh) -> (Option<usize>, Vec<Option<(usize, usize)>>) {
    let index = out
        .json
        .get("meshes")
        .and_then(Value::as_array)
        .map_or(0, Vec::len);
    let mut list = Vec::new();
    let mut slots = Vec::new();
    for p in &m.primitives {
        if p.indices.is_empty() || p.positions.is_empty() {
            slots.push(None);
            continue;
        }
        slots.push(Some((index, list.len())));
        list.push(primitive(out, p));
    }
    if list.is_empty() {
        return (None, slots);
    }
    out.push("meshes", json!({"name": m.name, "primitives": list}));
    (Some(index), slots)
}

fn primitive(out: &mut Output, p: &Primitive) -> Value {
    let position = out.floats(&p.positions);
    let points = || p.positions.iter().map(|&q| Vec3::from(q));
    let lo = points()
        .fold(Vec3::INFINITY, Vec3::min)
        .as_dvec3()
        .to_array();
    let hi = points()
        .fold(Vec3::NEG_INFINITY, Vec3::max)
        .as_dvec3()
        .to_array();
    out.json["accessors"][position]["min"] = json!(lo);
    out.json["accessors"][position]["max"] = json!(hi);
    let mut attributes = json!({"POSITION": position});
    if !p.normals.is_empty() {
        let positions: Vec<Vec3> = points().collect();
        let mut normals: Vec<Vec3> = p
            .normals
            .iter()
            .map(|&n| Vec3::from(n).normalize_or_zero())
            .collect();
        repair_normals(&positions, &mut normals, &p.indices);
        let normals: Vec<[f32; 3]> = normals.iter().map(Vec3::to_array).collect();
        attributes["NORMAL"] = json!(out.floats(&normals));
    }
    if !p.texcoords.is_empty() {
        attributes["TEXCOORD_0"] = json!(out.floats(&p.texcoords));
    }
    if !p.texcoords1.is_empty() && !p.texcoords.is_empty() {
        attributes["TEXCOORD_1"] = json!(out.floats(&p.texcoords1));
    }
    if !p.colors.is_empty() {
        let colors: Vec<_> = p
            .colors
            .iter()
            .map(|c| c.map(|v| v.clamp(0.0, 1.0)))
            .collect();
        attributes["COLOR_0"] = json!(out.floats(&colors));
    }
    let scalar = |values: &[f32]| -> Vec<[f32; 1]> { values.iter().map(|&v| [v]).collect() };
    if !p.ambient.is_empty() {
        attributes["_AMBIENT"] = json!(out.floats(&scalar(&p.ambient)));
    }
    let mut json = json!({"material": p.material});
    if let Some(botany) = &p.botany {
        if let Some(order) = branch_order(botany, p) {
            attributes["_BRANCH_ORDER"] = json!(out.floats(&scalar(&order)));
        }
        if !botany.leaves.is_empty() {
            json["extras"] = json!({"umbrage_leaves": botany.leaves.len()});
        }
    }
    json["attributes"] = attributes;
    json["indices"] = json!(out.indices(&p.indices));
    json
}

/// Branching order per vertex: of the branch itself, or of the twig that bears the leaf.
fn branch_order(botany: &Botany, p: &Primitive) -> Option<Vec<f32>> {
    let n = p.positions.len();
    if botany.branch_order.len() == n {
        return Some(botany.branch_order.iter().map(|&o| f32::from(o)).collect());
    }
    if botany.leaves.is_empty() {
        return None;
    }
    let mut order = vec![0.0; n];
    for leaf in &botany.leaves {
        let first = leaf.first_index as usize;
        let range = first..first.saturating_add(leaf.index_count as usize);
        for &i in p.indices.get(range).unwrap_or_default() {
            order[i as usize] = f32::from(leaf.order);
        }
    }
    Some(order)
}

/// Writes a placement as a node; its index and the linear part of its transform. A transform
/// that glTF nodes cannot say (shear, flat scales) moves into a copy of the mesh.
fn node(out: &mut Output, instance: &Instance, model: &Model, mesh: Option<usize>) -> Place {
    let to_world = &instance.local_to_world;
    let (scale, rotation, translation) = to_world.to_scale_rotation_translation();
    let again = DAffine3::from_scale_rotation_translation(scale, rotation, translation);
    let size = to_world
        .matrix3
        .to_cols_array()
        .iter()
        .fold(0.0f64, |m, v| m.max(v.abs()));
    let plain = again.is_finite() && again.matrix3.abs_diff_eq(to_world.matrix3, 1e-9 * size);
    let mut json = json!({"name": instance.name});
    if translation != DVec3::ZERO {
        json["translation"] = json!(translation.to_array());
    }
    if plain && rotation.angle_between(DQuat::IDENTITY) > 0.0 {
        json["rotation"] = json!(rotation.normalize().to_array());
    }
    if plain && scale != DVec3::ONE {
        json["scale"] = json!(scale.to_array());
    }
    let mesh = if plain {
        mesh
    } else {
        self::mesh(
            out,
            &transformed(&model.meshes[instance.mesh], &to_world.matrix3),
        )
        .0
    };
    if let Some(mesh) = mesh {
        json["mesh"] = json!(mesh);
    }
    Place {
        node: out.push("nodes", json),
        gpu_instance: None,
        linear: if plain {
            to_world.matrix3
        } else {
            DMat3::IDENTITY
        },
    }
}

/// A copy of a mesh with `linear` applied to its vertices.
fn transformed(mesh: &Mesh, linear: &DMat3) -> Mesh {
    let to_normal = cofactors(linear);
    let turn = |m: &DMat3, v: [f32; 3]| *m * Vec3::from(v).as_dvec3();
    let mut out = mesh.clone();
    for p in &mut out.primitives {
        for q in &mut p.positions {
            *q = turn(linear, *q).as_vec3().to_array();
        }
        for n in &mut p.normals {
            *n = turn(&to_normal, *n)
                .normalize_or_zero()
                .as_vec3()
                .to_array();
        }
        if linear.determinant() < 0.0 {
            p.indices.chunks_exact_mut(3).for_each(|t| t.swap(1, 2));
        }
    }
    out
}

fn lights(out: &mut Output, lights: &[PunctualLight]) -> Vec<usize> {
    const NAME: &str = "KHR_lights_punctual";
    let mut nodes = Vec::new();
    let mut list = Vec::new();
    for light in lights {
        let intensity = light.color.iter().fold(0.0f32, |s, &c| s.max(c));
        let color = light
            .color
            .map(|c| f64::from(if intensity > 0.0 { c / intensity } else { 1.0 }));
        let mut json = json!({"color": color, "intensity": f64::from(intensity)});
        json["type"] = json!(match light.kind {
            LightKind::Directional => "directional",
            LightKind::Point => "point",
            LightKind::Spot { .. } => "spot",
        });
        if let LightKind::Spot { inner, outer } = light.kind {
            let (inner, outer) = (f64::from(inner), f64::from(outer));
            json["spot"] = json!({"innerConeAngle": inner, "outerConeAngle": outer});
        }
        if light.range.is_finite() && light.kind != LightKind::Directional {
            json["range"] = json!(f64::from(light.range));
        }
        let turn =
            DQuat::from_rotation_arc(DVec3::NEG_Z, light.direction.normalize_or(DVec3::NEG_Z));
        let node = json!({
            "name": format!("light {}", list.len()),
            "translation": light.position.to_array(), "rotation": turn.to_array(),
            "extensions": {NAME: {"light": list.len()}}
        });
        nodes.push(out.push("nodes", node));
        list.push(json);
    }
    if !list.is_empty() {
        out.json["extensions"] = json!({NAME: {"lights": list}});
        out.use_extension(NAME);
    }
    nodes
}
