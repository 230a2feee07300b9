//! glTF materials, textures and images.

use std::path::Path;
use std::sync::Arc;

use gltf::json;
use gltf::json::extensions::texture::TextureTransform;
use gltf::json::texture::{Info, MagFilter, Sampler, WrappingMode};
use gltf::json::validation::Checked;
use serde::Deserialize;
use serde_json::Value;

use super::accessor::Source;
use super::container::uri_bytes;
use super::json::{Check, Of, at, extension, known, label, list, name, typed};
use crate::scene::model::{
    AlphaMode, DiffuseTransmission, ImageSource, Material, Texture, TextureRef, Wrap,
};

/// All images, their bytes still encoded.
pub(super) fn images(json: &Value, source: &Source<'_>, folder: &Path) -> Check<Vec<ImageSource>> {
    let mut out = Vec::new();
    let images: Vec<(json::Image, _)> = list(json, "images", "image")?;
    for (i, (image, v)) in images.iter().enumerate() {
        let title = name("image", i, v);
        out.push(one_image(image, title, source, folder).of(|| label("image", i, v))?);
    }
    Ok(out)
}

fn one_image(
    image: &json::Image,
    mut title: String,
    source: &Source<'_>,
    folder: &Path,
) -> Check<ImageSource> {
    let bytes = match (&image.uri, image.buffer_view) {
        (_, Some(view)) => {
            let view = at(view, "bufferView", source.view_count())?;
            source.view_bytes(view)?.to_vec()
        }
        (Some(uri), None) => {
            if image.name.is_none() && !uri.starts_with("data:") {
                uri.clone_into(&mut title);
            }
            uri_bytes(uri, folder)?.0
        }
        (None, None) => return Err("has neither uri nor bufferView".into()),
    };
    Ok(ImageSource::Encoded {
        name: title,
        bytes: Arc::from(bytes),
    })
}

/// Textures, and where each of the document's stands in the list (`None`: its image has a
/// format that only an unsupported extension gives).
#[derive(Debug, Default)]
pub(super) struct Textures {
    pub(super) list: Vec<Texture>,
    slots: Vec<Option<usize>>,
    pub(super) warnings: Vec<String>,
}

impl Textures {
    pub(super) fn read(json: &Value, images: usize) -> Check<Self> {
        let samplers: Vec<(Sampler, _)> = list(json, "samplers", "sampler")?;
        let textures: Vec<(json::Texture, _)> = list(json, "textures", "texture")?;
        let mut out = Self::default();
        for (i, (texture, v)) in textures.iter().enumerate() {
            // The crate gives a texture without a source the last index there is.
            if texture.source.value() == u32::MAX as usize {
                out.slots.push(None);
                continue;
            }
            let read = || -> Check<Texture> {
                let image = at(texture.source, "source", images)?;
                let sampler = match texture.sampler {
                    Some(s) => &samplers[at(s, "sampler", samplers.len())?].0,
                    None => &Sampler::default(),
                };
                Ok(Texture {
                    image,
                    wrap_u: wrap(sampler.wrap_s),
                    wrap_v: wrap(sampler.wrap_t),
                    nearest: sampler.mag_filter == Some(Checked::Valid(MagFilter::Nearest)),
                })
            };
            out.slots.push(Some(out.list.len()));
            out.list.push(read().of(|| label("texture", i, v))?);
        }
        let missing = out.slots.iter().filter(|s| s.is_none()).count();
        if missing > 0 {
            out.warnings.push(format!(
                "{missing} textures without a readable image are left out"
            ));
        }
        Ok(out)
    }

    /// What a material's member `key` refers to; `None` also for a missing image.
    fn reference(&self, info: Option<&Info>, key: &str) -> Check<Option<TextureRef>> {
        let Some(info) = info else {
            return Ok(None);
        };
        let i = at(info.index, "index", self.slots.len()).of(|| key.to_owned())?;
        let Some(texture) = self.slots[i] else {
            return Ok(None);
        };
        let mut out = TextureRef::new(texture);
        let mut set = info.tex_coord;
        let extensions = info.extensions.as_ref();
        if let Some(t) = extensions.and_then(|e| e.texture_transform.as_ref()) {
            set = t.tex_coord.unwrap_or(set);
            out.transform = transform(t);
        }
        // Sets beyond the second are rare (light maps); the first is the nearest answer.
        out.texcoord = u32::from(set == 1);
        Ok(Some(out))
    }
}

fn wrap(mode: Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

/// `KHR_texture_transform` as the upper rows of translation x rotation x scale.
fn transform(t: &TextureTransform) -> [[f32; 3]; 2] {
    let ([ou, ov], [su, sv]) = (t.offset.0, t.scale.0);
    let (s, c) = t.rotation.0.sin_cos();
    [[c * su, s * sv, ou], [-s * su, c * sv, ov]]
}

/// All materials.
pub(super) fn materials(json: &Value, textures: &Textures) -> Check<Vec<Material>> {
    let mut out = Vec::new();
    let materials: Vec<(json::Material, _)> = list(json, "materials", "material")?;
    for (i, (m, v)) in materials.iter().enumerate() {
        let title = name("material", i, v);
        out.push(one_material(m, v, title, textures).of(|| label("material", i, v))?);
    }
    Ok(out)
}

fn one_material(
    m: &json::Material,
    v: &Value,
    name: String,
    textures: &Textures,
) -> Check<Material> {
    let pbr = &m.pbr_metallic_roughness;
    let none = json::extensions::material::Material::default();
    let extensions = m.extensions.as_ref().unwrap_or(&none);
    let base_color_texture = pbr.base_color_texture.as_ref();
    let strength = &extensions.emissive_strength;
    let strength = strength.as_ref().map_or(1.0, |e| e.emissive_strength.0);
    let mut out = Material {
        name,
        base_color: pbr.base_color_factor.0,
        base_color_texture: textures.reference(base_color_texture, "baseColorTexture")?,
        roughness: pbr.roughness_factor.0,
        metallic: pbr.metallic_factor.0,
        alpha_mode: match known(m.alpha_mode, v, "alphaMode")? {
            json::material::AlphaMode::Opaque => AlphaMode::Opaque,
            json::material::AlphaMode::Mask => AlphaMode::Mask {
                cutoff: m.alpha_cutoff.unwrap_or_default().0,
            },
            json::material::AlphaMode::Blend => AlphaMode::Blend,
        },
        double_sided: m.double_sided,
        unlit: extensions.unlit.is_some(),
        emissive: m.emissive_factor.0.map(|f| f * strength),
        diffuse_transmission: diffuse_transmission(v, textures)?,
        occlusion_texture: None,
        unflipped_back_faces: unflipped(v),
    };
    if let Some(gloss) = &extensions.pbr_specular_glossiness {
        out.base_color = gloss.diffuse_factor.0;
        let texture = gloss.diffuse_texture.as_ref();
        out.base_color_texture = textures.reference(texture, "diffuseTexture")?;
        out.roughness = 1.0 - gloss.glossiness_factor.0;
        out.metallic = 0.0;
    }
    if let Some(occlusion) = &m.occlusion_texture {
        // Read once more as any other texture: the crate's own type leaves out its transform.
        let info = typed(&v["occlusionTexture"])?;
        let reference = textures.reference(Some(&info), "occlusionTexture")?;
        out.occlusion_texture = reference.map(|r| (r, occlusion.strength.0));
    }
    Ok(out)
}

/// umbrage's own mark on a material whose normals must not be turned on back faces.
pub(in crate::scene) const KEEP_NORMALS: &str = "umbrage_keep_normals_on_back_faces";

fn unflipped(m: &Value) -> bool {
    m.get("extras").and_then(|e| e.get(KEEP_NORMALS)) == Some(&Value::Bool(true))
}

/// `KHR_materials_diffuse_transmission`, which the crate does not know.
#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Transmission {
    diffuse_transmission_factor: f32,
    diffuse_transmission_texture: Option<Info>,
    diffuse_transmission_color_factor: [f32; 3],
    diffuse_transmission_color_texture: Option<Info>,
}

impl Default for Transmission {
    fn default() -> Self {
        Self {
            diffuse_transmission_factor: 0.0,
            diffuse_transmission_texture: None,
            diffuse_transmission_color_factor: [1.0; 3],
            diffuse_transmission_color_texture: None,
        }
    }
}

fn diffuse_transmission(v: &Value, textures: &Textures) -> Check<Option<DiffuseTransmission>> {
    const NAME: &str = "KHR_materials_diffuse_transmission";
    let Some(e) = extension(v, NAME) else {
        return Ok(None);
    };
    let e: Transmission = typed(e).of(|| NAME.to_owned())?;
    let texture = |info: &Option<Info>, key| textures.reference(info.as_ref(), key);
    Ok(Some(DiffuseTransmission {
        factor: e.diffuse_transmission_factor,
        texture: texture(
            &e.diffuse_transmission_texture,
            "diffuseTransmissionTexture",
        )?,
        color: e.diffuse_transmission_color_factor,
        color_texture: texture(
            &e.diffuse_transmission_color_texture,
            "diffuseTransmissionColorTexture",
        )?,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_texture_transform_scales_then_turns_then_shifts() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let t = json!({"offset": [0.5, 0.25], "rotation": quarter, "scale": [2.0, 3.0]});
        let m = transform(&typed(&t).unwrap());
        // (1, 0) scaled is (2, 0); turned by +90 degrees it is (0, -2) with v down.
        let uv = [m[0][0] + m[0][2], m[1][0] + m[1][2]];
        assert!(
            (uv[0] - 0.5).abs() < 1e-6 && (uv[1] + 1.75).abs() < 1e-6,
            "{uv:?}"
        );
    }
}
