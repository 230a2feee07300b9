//! glTF materials, textures and images.

use std::path::Path;
use std::sync::Arc;

use serde_json::Value;

use super::accessor::Source;
use super::container::uri_bytes;
use super::json::{
    Check, Of, array, extension, flag, index, integer, label, name, number, numbers, text,
};
use crate::scene::model::{
    AlphaMode, DiffuseTransmission, ImageSource, Material, Texture, TextureRef, Wrap,
};

/// All images, their bytes still encoded.
pub(super) fn images(json: &Value, source: &Source<'_>, folder: &Path) -> Check<Vec<ImageSource>> {
    let mut out = Vec::new();
    for (i, image) in array(json, "images")?.iter().enumerate() {
        out.push(one_image(i, image, source, folder).of(|| label("image", i, image))?);
    }
    Ok(out)
}

fn one_image(i: usize, image: &Value, source: &Source<'_>, folder: &Path) -> Check<ImageSource> {
    let mut title = name("image", i, image);
    let bytes = match (
        text(image, "uri")?,
        index(image, "bufferView", source.view_count())?,
    ) {
        (_, Some(view)) => source.view_bytes(view)?.to_vec(),
        (Some(uri), None) => {
            if image.get("name").is_none() && !uri.starts_with("data:") {
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
        let samplers = array(json, "samplers")?;
        let mut out = Self::default();
        for (i, texture) in array(json, "textures")?.iter().enumerate() {
            let read = || -> Check<Option<Texture>> {
                let Some(image) = index(texture, "source", images)? else {
                    return Ok(None);
                };
                let sampler = index(texture, "sampler", samplers.len())?;
                let none = Value::Null;
                let sampler = sampler.map_or(&none, |s| &samplers[s]);
                let wrap = |key| -> Check<Wrap> {
                    Ok(match integer(sampler, key)? {
                        Some(33071) => Wrap::Clamp,
                        Some(33648) => Wrap::Mirror,
                        _ => Wrap::Repeat,
                    })
                };
                Ok(Some(Texture {
                    image,
                    wrap_u: wrap("wrapS")?,
                    wrap_v: wrap("wrapT")?,
                    nearest: integer(sampler, "magFilter")? == Some(9728),
                }))
            };
            let texture = read().of(|| label("texture", i, texture))?;
            out.slots.push(texture.map(|t| {
                out.list.push(t);
                out.list.len() - 1
            }));
        }
        let missing = out.slots.iter().filter(|s| s.is_none()).count();
        if missing > 0 {
            out.warnings.push(format!(
                "{missing} textures without a readable image are left out"
            ));
        }
        Ok(out)
    }

    fn reference(&self, v: &Value, key: &str) -> Check<Option<TextureRef>> {
        let Some(info) = v.get(key) else {
            return Ok(None);
        };
        let read = || -> Check<Option<TextureRef>> {
            let i = index(info, "index", self.slots.len())?.ok_or("\"index\" is missing")?;
            let Some(texture) = self.slots[i] else {
                return Ok(None);
            };
            let mut out = TextureRef::new(texture);
            let mut set = integer(info, "texCoord")?.unwrap_or(0);
            if let Some(t) = extension(info, "KHR_texture_transform") {
                set = integer(t, "texCoord")?.unwrap_or(set);
                out.transform = transform(t)?;
            }
            // Sets beyond the second are rare (light maps); the first is the nearest answer.
            out.texcoord = u32::from(set == 1);
            Ok(Some(out))
        };
        read().of(|| key.to_owned())
    }
}

/// `KHR_texture_transform` as the upper rows of translation x rotation x scale.
fn transform(t: &Value) -> Check<[[f32; 3]; 2]> {
    let [ou, ov] = numbers(t, "offset")?.unwrap_or([0.0; 2]);
    let [su, sv] = numbers(t, "scale")?.unwrap_or([1.0; 2]);
    let (s, c) = number(t, "rotation")?.unwrap_or(0.0).sin_cos();
    Ok([
        [(c * su) as f32, (s * sv) as f32, ou as f32],
        [(-s * su) as f32, (c * sv) as f32, ov as f32],
    ])
}

/// All materials.
pub(super) fn materials(json: &Value, textures: &Textures) -> Check<Vec<Material>> {
    let mut out = Vec::new();
    for (i, m) in array(json, "materials")?.iter().enumerate() {
        out.push(one_material(i, m, textures).of(|| label("material", i, m))?);
    }
    Ok(out)
}

fn one_material(i: usize, m: &Value, textures: &Textures) -> Check<Material> {
    let none = Value::Null;
    let pbr = m.get("pbrMetallicRoughness").unwrap_or(&none);
    let gloss = extension(m, "KHR_materials_pbrSpecularGlossiness");
    let mut out = Material {
        name: name("material", i, m),
        base_color: floats(numbers(pbr, "baseColorFactor")?.unwrap_or([1.0; 4])),
        base_color_texture: textures.reference(pbr, "baseColorTexture")?,
        roughness: number(pbr, "roughnessFactor")?.unwrap_or(1.0) as f32,
        metallic: number(pbr, "metallicFactor")?.unwrap_or(1.0) as f32,
        alpha_mode: alpha_mode(m)?,
        double_sided: flag(m, "doubleSided")?,
        unlit: extension(m, "KHR_materials_unlit").is_some(),
        emissive: emissive(m)?,
        diffuse_transmission: diffuse_transmission(m, textures)?,
        occlusion_texture: None,
        unflipped_back_faces: unflipped(m),
    };
    if let Some(gloss) = gloss {
        out.base_color = floats(numbers(gloss, "diffuseFactor")?.unwrap_or([1.0; 4]));
        out.base_color_texture = textures.reference(gloss, "diffuseTexture")?;
        out.roughness = 1.0 - number(gloss, "glossinessFactor")?.unwrap_or(1.0) as f32;
        out.metallic = 0.0;
    }
    if let Some(reference) = textures.reference(m, "occlusionTexture")? {
        let strength = number(&m["occlusionTexture"], "strength")?.unwrap_or(1.0);
        out.occlusion_texture = Some((reference, strength as f32));
    }
    Ok(out)
}

/// umbrage's own mark on a material whose normals must not be turned on back faces.
pub(in crate::scene) const KEEP_NORMALS: &str = "umbrage_keep_normals_on_back_faces";

fn unflipped(m: &Value) -> bool {
    m.get("extras").and_then(|e| e.get(KEEP_NORMALS)) == Some(&Value::Bool(true))
}

fn alpha_mode(m: &Value) -> Check<AlphaMode> {
    let cutoff = number(m, "alphaCutoff")?.unwrap_or(0.5) as f32;
    match text(m, "alphaMode")? {
        None | Some("OPAQUE") => Ok(AlphaMode::Opaque),
        Some("MASK") => Ok(AlphaMode::Mask { cutoff }),
        Some("BLEND") => Ok(AlphaMode::Blend),
        Some(other) => Err(format!("alphaMode {other} does not exist")),
    }
}

fn emissive(m: &Value) -> Check<[f32; 3]> {
    let factor = numbers(m, "emissiveFactor")?.unwrap_or([0.0; 3]);
    let strength = match extension(m, "KHR_materials_emissive_strength") {
        Some(e) => number(e, "emissiveStrength")?.unwrap_or(1.0),
        None => 1.0,
    };
    Ok(floats(factor.map(|f| f * strength)))
}

fn diffuse_transmission(m: &Value, textures: &Textures) -> Check<Option<DiffuseTransmission>> {
    let Some(e) = extension(m, "KHR_materials_diffuse_transmission") else {
        return Ok(None);
    };
    Ok(Some(DiffuseTransmission {
        factor: number(e, "diffuseTransmissionFactor")?.unwrap_or(0.0) as f32,
        texture: textures.reference(e, "diffuseTransmissionTexture")?,
        color: floats(numbers(e, "diffuseTransmissionColorFactor")?.unwrap_or([1.0; 3])),
        color_texture: textures.reference(e, "diffuseTransmissionColorTexture")?,
    }))
}

fn floats<const N: usize>(v: [f64; N]) -> [f32; N] {
    v.map(|x| x as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_texture_transform_scales_then_turns_then_shifts() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let t = json!({"offset": [0.5, 0.25], "rotation": quarter, "scale": [2.0, 3.0]});
        let m = transform(&t).unwrap();
        // (1, 0) scaled is (2, 0); turned by +90 degrees it is (0, -2) with v down.
        let uv = [m[0][0] + m[0][2], m[1][0] + m[1][2]];
        assert!(
            (uv[0] - 0.5).abs() < 1e-6 && (uv[1] + 1.75).abs() < 1e-6,
            "{uv:?}"
        );
    }
}
