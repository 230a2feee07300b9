//! `umbrage info`: what a model holds, and what drawing it needs; or the devices at hand.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::info_ink;
use crate::app::cli::InfoArgs;
use crate::app::input::Input;
use crate::app::report::Table;
use crate::app::settings::{foliage_pattern, foliage_settings, picture_settings};
use crate::app::{Context, Report};
use crate::foliage::{Recipe, Split};
use crate::ink::mix::Mix;
use crate::render::plan::human_bytes;
use crate::render::{Baked, FieldGrid, Plan, Subject, SurfaceMesh, View};
use crate::scene::geometry::counted;
use crate::scene::{AlphaMode, Geometry, ImageSource, Model};
use crate::{Error, Result};

/// Describes the input, or the devices when there is none.
///
/// # Errors
/// What reading or planning finds wrong. A model without foliage is described all the same.
pub fn run(context: &Context, args: &InfoArgs) -> Result<Report> {
    let Some(source) = &args.input else {
        return device(context);
    };
    let mix = args.style.as_deref().map(Mix::named).transpose()?;
    let input = Input::load(source, &args.model.textures)?;
    let picture = picture_settings(input.scene.as_ref(), &args.picture)?;
    let settings = foliage_settings(input.scene.as_ref(), &args.settings)?;
    let pattern = foliage_pattern(input.scene.as_ref(), args.model.foliage.as_deref());
    let geometry = Geometry::flatten(&input.model);
    for warning in &geometry.warnings {
        log::warn!("{warning}");
    }
    let split = Split::new(&input.model, &geometry, pattern);
    if let (Some(mix), Some(name)) = (&mix, &args.style) {
        let mut text = String::new();
        let facts = describe_model(&mut text, &input.model, &geometry, split.as_ref());
        let plan = info_ink::describe(&mut text, name, mix, picture.size, args.ink_supersample);
        return Ok(Report::new(text, json!({ "model": facts, "plan": plan })));
    }
    let blank = Blank::new(&geometry, split.as_ref().ok());
    let plan = Plan::new(
        &blank.subject(&input.model, &geometry),
        &picture,
        &args.view,
    )?;
    let mut text = String::new();
    let facts = describe_model(&mut text, &input.model, &geometry, split.as_ref());
    let plan = describe_plan(&mut text, &plan, &args.view);
    let bake = match &split {
        Ok(split) if args.view.iter().any(|v| v.needs_bake()) => {
            describe_bake(&mut text, &Recipe::new(&geometry, split, &settings)?)
        }
        _ => Value::Null,
    };
    Ok(Report::new(
        text,
        json!({ "model": facts, "plan": plan, "bake": bake }),
    ))
}

/// Stand-ins for results of a bake: a plan asks how many there are, never what they say.
struct Blank {
    normals: Vec<glam::Vec3>,
    ambient: Vec<f32>,
    foliage_parts: Vec<bool>,
}

impl Blank {
    fn new(geometry: &Geometry, split: Option<&Split>) -> Self {
        let parts = geometry.parts.len();
        Self {
            normals: vec![glam::Vec3::Y; geometry.positions.len()],
            ambient: vec![1.0; geometry.positions.len()],
            foliage_parts: split.map_or(vec![false; parts], |s| s.foliage_parts.clone()),
        }
    }

    fn subject<'a>(&'a self, model: &'a Model, geometry: &'a Geometry) -> Subject<'a> {
        let baked = Baked {
            normals: &self.normals,
            ambient: &self.ambient,
            foliage_parts: &self.foliage_parts,
        };
        let field = FieldGrid {
            min: geometry.min,
            cell: geometry.diagonal().max(f32::MIN_POSITIVE),
            nodes: [2; 3],
            values: &[0.0; 8],
            tau: 0.0,
        };
        let surface = SurfaceMesh {
            positions: &[],
            normals: &[],
            indices: &[],
        };
        Subject {
            baked: Some(baked),
            field: Some(field),
            surface: Some(surface),
            ..Subject::new(model, geometry)
        }
    }
}

fn describe_model(
    text: &mut String,
    model: &Model,
    geometry: &Geometry,
    split: Result<&Split, &Error>,
) -> Value {
    let size = geometry.max - geometry.min;
    let origin = geometry.origin;
    let vertices = geometry.positions.len();
    let triangles = geometry.indices.len() / 3;
    let _ = writeln!(
        text,
        "{}: {}, {}, {}, {}, {}",
        model.name,
        counted(model.meshes.len(), "mesh", "meshes"),
        counted(model.instances.len(), "instance", "instances"),
        counted(vertices, "vertex", "vertices"),
        counted(triangles, "triangle", "triangles"),
        counted(model.lights.len(), "light", "lights"),
    );
    let _ = writeln!(
        text,
        "box {:.3} x {:.3} x {:.3} m around {:.3}, {:.3}, {:.3}\n",
        size.x, size.y, size.z, origin.x, origin.y, origin.z
    );
    let materials = describe_materials(text, model, geometry, split.ok());
    let images = describe_images(text, model);
    let foliage = match split {
        Ok(split) => {
            let count = split.foliage_vertices.len();
            let _ = writeln!(text, "foliage: {count} of {vertices} vertices\n");
            json!({ "vertices": count, "triangles": split.foliage_indices.len() / 3 })
        }
        Err(error) => {
            let _ = writeln!(text, "foliage: none: {error}\n");
            Value::Null
        }
    };
    let warnings = [&model.warnings[..], &geometry.warnings[..]].concat();
    json!({
        "name": model.name, "meshes": model.meshes.len(), "instances": model.instances.len(),
        "vertices": vertices, "triangles": triangles, "lights": model.lights.len(),
        "size_m": size.to_array(), "centre_m": origin.to_array(),
        "materials": materials, "images": images, "foliage": foliage,
        "warnings": warnings,
    })
}

fn describe_materials(
    text: &mut String,
    model: &Model,
    geometry: &Geometry,
    split: Option<&Split>,
) -> Value {
    let mut table = Table::new(&[
        "material",
        "foliage",
        "alpha",
        "sides",
        "texture",
        "triangles",
    ]);
    let mut rows = Vec::new();
    for (i, material) in model.materials.iter().enumerate() {
        let parts = || {
            geometry
                .parts
                .iter()
                .enumerate()
                .filter(move |(_, p)| p.material == i)
        };
        let triangles: usize = parts().map(|(_, p)| p.index_count / 3).sum();
        let foliage = split.is_some_and(|s| parts().any(|(k, _)| s.foliage_parts[k]));
        let alpha = match material.alpha_mode {
            AlphaMode::Opaque => "opaque".to_owned(),
            AlphaMode::Mask { cutoff } => format!("mask {cutoff}"),
            AlphaMode::Blend => "blend".to_owned(),
        };
        let sides = if material.double_sided { 2 } else { 1 };
        let texture = material
            .base_color_texture
            .map(|t| image_name(&model.images[model.textures[t.texture].image]));
        let yes = if foliage { "yes" } else { "no" };
        let shown = texture.unwrap_or("-");
        table.row(&[&material.name, &yes, &alpha, &sides, &shown, &triangles]);
        rows.push(json!({
            "name": material.name, "foliage": foliage, "alpha": alpha, "sides": sides,
            "texture": texture, "triangles": triangles,
        }));
    }
    let _ = writeln!(text, "{table}");
    rows.into()
}

fn image_name(image: &ImageSource) -> &str {
    match image {
        ImageSource::Encoded { name, .. } | ImageSource::Rgba8 { name, .. } => name,
    }
}

fn describe_images(text: &mut String, model: &Model) -> Value {
    if model.images.is_empty() {
        return json!([]);
    }
    let mut table = Table::new(&["image", "stored"]);
    let mut rows = Vec::new();
    for image in &model.images {
        let bytes = match image {
            ImageSource::Encoded { bytes, .. } => bytes.len(),
            ImageSource::Rgba8 { pixels, .. } => pixels.len(),
        } as u64;
        let name = image_name(image);
        table.row(&[&name, &human_bytes(bytes)]);
        rows.push(json!({ "name": name, "bytes": bytes }));
    }
    let _ = writeln!(text, "{table}");
    rows.into()
}

fn describe_plan(text: &mut String, plan: &Plan, views: &[View]) -> Value {
    let names: Vec<&str> = views.iter().map(|v| v.name()).collect();
    let total = human_bytes(plan.bytes());
    let _ = writeln!(
        text,
        "plan of {}: {total} on the device\n",
        names.join(", ")
    );
    let mut table = Table::new(&["pass", "writes"]);
    for pass in &plan.passes {
        table.row(&[&pass.label, &pass.writes.join(", ")]);
    }
    let _ = writeln!(text, "{table}");
    let mut table = Table::new(&["resource", "what", "bytes"]);
    let mut resources = Vec::new();
    for image in &plan.images {
        let [w, h] = image.extent;
        let what = format!(
            "{w}x{h}, {} levels, {} samples",
            image.levels, image.samples
        );
        table.row(&[&image.label, &what, &human_bytes(image.bytes())]);
        resources.push(json!({ "name": image.label, "what": what, "bytes": image.bytes() }));
    }
    for buffer in &plan.buffers {
        table.row(&[&buffer.label, &"buffer", &human_bytes(buffer.bytes)]);
        resources.push(json!({ "name": buffer.label, "what": "buffer", "bytes": buffer.bytes }));
    }
    let _ = write!(text, "{table}");
    let passes = plan
        .passes
        .iter()
        .map(|p| json!({ "name": p.label, "writes": p.writes }));
    json!({
        "views": names, "bytes": plan.bytes(), "passes": passes.collect::<Value>(),
        "resources": resources,
    })
}

/// What a bake would run and allocate; the implicit surface's size is only known in it.
fn describe_bake(text: &mut String, recipe: &Recipe) -> Value {
    let bytes = recipe.bytes();
    let _ = writeln!(
        text,
        "\nbake: {} passes, {} on the device\n",
        recipe.passes.len(),
        human_bytes(bytes)
    );
    let mut table = Table::new(&["resource of the bake", "bytes"]);
    for resource in &recipe.resources {
        let bytes = human_bytes(resource.bytes);
        let at_least = if resource.exact { "" } else { "at least " };
        table.row(&[&resource.name, &format!("{at_least}{bytes}")]);
    }
    let _ = write!(text, "{table}");
    let resources = recipe.resources.iter();
    let resources =
        resources.map(|r| json!({ "name": r.name, "bytes": r.bytes, "exact": r.exact }));
    json!({ "bytes": bytes, "passes": recipe.passes, "resources": resources.collect::<Value>() })
}

fn device(context: &Context) -> Result<Report> {
    let gpu = context.gpu()?;
    let info = gpu.info();
    let mut table = Table::new(&["device", "value"]);
    let limits = &info.limits;
    let rows: [(&str, String); 8] = [
        ("index", info.index.to_string()),
        ("name", info.name.clone()),
        ("driver", format!("{} {}", info.driver, info.driver_info)),
        ("type", info.device_type.to_owned()),
        ("Vulkan", info.api_version.clone()),
        ("subgroup", info.subgroup_size.to_string()),
        ("storage range", human_bytes(limits.max_storage_range)),
        ("memory", human_bytes(limits.device_memory)),
    ];
    for (name, value) in &rows {
        table.row(&[name, value]);
    }
    let json: serde_json::Map<String, Value> = rows
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value.into()))
        .collect();
    Ok(Report::new(table.to_string(), Value::Object(json)))
}
