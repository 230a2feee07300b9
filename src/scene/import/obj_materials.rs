//! Materials of an OBJ: MTL values, and textures that are named, given or found by name.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::json::{Check, Of};
use super::mtl::{Map, MtlMaterial};
use super::texture_search::{Found, find, images_in};
use crate::scene::model::{AlphaMode, ImageSource, Material, Model, Texture, TextureRef, Wrap};
use crate::scene::textures::{self, Rgba8};

/// Alpha below this is a hole, not the noise of a compressed opaque image.
const HOLE: u8 = 250;

/// Appends the materials `names` to the model, in order.
pub(super) fn build(
    model: &mut Model,
    names: &[String],
    library: &[MtlMaterial],
    folder: &Path,
    given: &[(String, PathBuf)],
) -> Check<()> {
    for (wanted, _) in given {
        if !names.contains(wanted) {
            return Err(format!(
                "--texture {wanted}: there is no such material, only {}",
                names.join(", ")
            ));
        }
    }
    let mut builder = Builder {
        beside: images_in(folder),
        loaded: BTreeMap::new(),
        folder,
        given,
        model,
    };
    for name in names {
        let mtl = library.iter().find(|m| m.name == *name);
        if mtl.is_none() && !library.is_empty() {
            let warning = format!("material {name} is not in the material library");
            builder.model.warnings.push(warning);
        }
        let material = builder
            .material(name, mtl)
            .of(|| format!("material {name}"))?;
        builder.model.materials.push(material);
    }
    warn_of_missing(model);
    Ok(())
}

/// Faces with texture coordinates were made for a texture; where there is none the picture is
/// plain, and the user is told why.
fn warn_of_missing(model: &mut Model) {
    let primitives = || model.meshes.iter().flat_map(|m| &m.primitives);
    let plain = |(i, m): (usize, &Material)| {
        let mapped = primitives().any(|p| p.material == i && !p.texcoords.is_empty());
        (mapped && m.base_color_texture.is_none()).then(|| m.name.clone())
    };
    let materials = model.materials.iter().enumerate();
    let missing: Vec<String> = materials.filter_map(plain).collect();
    if !missing.is_empty() {
        model.warnings.push(format!(
            "no texture is named or found for {}: drawn in one colour; give some with --texture \
             MATERIAL=FILE",
            missing.join(", ")
        ));
    }
}

struct Builder<'a> {
    model: &'a mut Model,
    folder: &'a Path,
    given: &'a [(String, PathBuf)],
    beside: Vec<PathBuf>,
    /// Image index and whether it has holes, by colour file and opacity file.
    loaded: BTreeMap<(PathBuf, Option<PathBuf>), (usize, bool)>,
}

impl Builder<'_> {
    fn material(&mut self, name: &str, mtl: Option<&MtlMaterial>) -> Check<Material> {
        let none = MtlMaterial::default();
        let mtl = mtl.unwrap_or(&none);
        let opacity = mtl.opacity.unwrap_or(1.0);
        let [r, g, b] = mtl.diffuse.unwrap_or([1.0; 3]).map(srgb_to_linear);
        let mut out = Material {
            name: name.to_owned(),
            base_color: [r, g, b, opacity],
            // Blinn's exponent to perceptual roughness: alpha^2 = 2 / (n + 2).
            roughness: mtl.shininess.map_or(1.0, |n| (2.0 / (n + 2.0)).powf(0.25)),
            emissive: mtl.emissive.unwrap_or([0.0; 3]).map(srgb_to_linear),
            ..Material::default()
        };
        let Some((file, map)) = self.color_file(name, mtl)? else {
            if opacity < 1.0 {
                out.alpha_mode = AlphaMode::Blend;
            }
            return Ok(out);
        };
        if map.is_none() {
            // The colour was chosen for a surface without this texture.
            out.base_color = [1.0, 1.0, 1.0, opacity];
        }
        let opacity_file = match &mtl.opacity_map {
            Some(m) => Some(self.resolve(&m.file)?).filter(|f| *f != file),
            None => None,
        };
        let (image, holes) = self.image(file, opacity_file)?;
        out.base_color_texture = Some(self.texture(image, map));
        if holes {
            out.alpha_mode = AlphaMode::Mask { cutoff: 0.5 };
            out.double_sided = true;
        } else if opacity < 1.0 {
            out.alpha_mode = AlphaMode::Blend;
        }
        Ok(out)
    }

    /// The colour texture: given by the user, named by the library, or found by name.
    fn color_file<'m>(
        &mut self,
        name: &str,
        mtl: &'m MtlMaterial,
    ) -> Check<Option<(PathBuf, Option<&'m Map>)>> {
        if let Some((_, file)) = self.given.iter().find(|(m, _)| m == name) {
            return Ok(Some((file.clone(), None)));
        }
        if let Some(map) = mtl.diffuse_map.as_ref().or(mtl.opacity_map.as_ref()) {
            return Ok(Some((self.resolve(&map.file)?, Some(map))));
        }
        match find(&self.beside, name, &self.model.name) {
            Found::One(file) => {
                log::info!("material {name}: texture {} found by name", file.display());
                Ok(Some((file, None)))
            }
            Found::Several(files) => {
                let names: Vec<_> = files
                    .iter()
                    .filter_map(|f| f.file_name())
                    .map(|f| f.to_string_lossy())
                    .collect();
                self.model.warnings.push(format!(
                    "material {name}: {} fit equally well, none is used; choose with --texture",
                    names.join(" and ")
                ));
                Ok(None)
            }
            Found::Nothing => Ok(None),
        }
    }

    /// The file a library names: as written, or by its bare name beside the model.
    fn resolve(&self, file: &str) -> Check<PathBuf> {
        let as_written = self.folder.join(file);
        if as_written.is_file() {
            return Ok(as_written);
        }
        let bare = file.rsplit('/').next().unwrap_or(file);
        let same_name = |p: &&PathBuf| {
            let name = p.file_name().and_then(|n| n.to_str());
            name.is_some_and(|n| n.eq_ignore_ascii_case(bare))
        };
        let beside = self.beside.iter().find(same_name).cloned();
        beside.ok_or_else(|| format!("the image {file} is missing (give another with --texture)"))
    }

    /// Reads a colour image and puts an opacity image into its alpha.
    fn image(&mut self, file: PathBuf, opacity: Option<PathBuf>) -> Check<(usize, bool)> {
        let key = (file, opacity);
        if let Some(&done) = self.loaded.get(&key) {
            return Ok(done);
        }
        let (encoded, mut pixels) = read_image(&key.0)?;
        let mut source = encoded;
        if let Some(opacity) = &key.1 {
            let (_, mask) = read_image(opacity)?;
            put_alpha(&mut pixels, &mask);
            source = ImageSource::Rgba8 {
                name: source_name(&key.0),
                width: pixels.width,
                height: pixels.height,
                pixels: Arc::from(pixels.pixels.as_slice()),
            };
        }
        let holes = pixels.pixels.chunks_exact(4).any(|p| p[3] < HOLE);
        self.model.images.push(source);
        let done = (self.model.images.len() - 1, holes);
        self.loaded.insert(key, done);
        Ok(done)
    }

    fn texture(&mut self, image: usize, map: Option<&Map>) -> TextureRef {
        let clamp = map.is_some_and(|m| m.clamp);
        let wrap = if clamp { Wrap::Clamp } else { Wrap::Repeat };
        self.model.textures.push(Texture {
            image,
            wrap_u: wrap,
            wrap_v: wrap,
            nearest: false,
        });
        let mut out = TextureRef::new(self.model.textures.len() - 1);
        if let Some(m) = map {
            // u' = s u + o with v from the bottom; here v counts from the top.
            let [su, sv] = m.scale;
            out.transform = [[su, 0.0, m.offset[0]], [0.0, sv, 1.0 - sv - m.offset[1]]];
        }
        out
    }
}

fn source_name(file: &Path) -> String {
    let name = file.file_name().unwrap_or(file.as_os_str());
    name.to_string_lossy().into_owned()
}

fn read_image(file: &Path) -> Check<(ImageSource, Rgba8)> {
    let bytes = std::fs::read(file).map_err(|e| format!("cannot read {}: {e}", file.display()))?;
    let source = ImageSource::Encoded {
        name: source_name(file),
        bytes: Arc::from(bytes),
    };
    let pixels = textures::decode(&source).map_err(|e| e.to_string())?;
    Ok((source, pixels))
}

/// Puts the alpha of `mask` (its brightness when it is opaque) into `pixels`, nearest texel.
fn put_alpha(pixels: &mut Rgba8, mask: &Rgba8) {
    let by_alpha = mask.pixels.chunks_exact(4).any(|p| p[3] < HOLE);
    let (w, h) = (pixels.width as usize, pixels.height as usize);
    let (mw, mh) = (mask.width as usize, mask.height as usize);
    for y in 0..h {
        for x in 0..w {
            let at = 4 * ((y * mh / h) * mw + x * mw / w);
            let p = &mask.pixels[at..at + 4];
            let brightness = (u32::from(p[0]) + u32::from(p[1]) + u32::from(p[2])) / 3;
            let alpha = if by_alpha {
                p[3]
            } else {
                u8::try_from(brightness).unwrap_or(255)
            };
            pixels.pixels[4 * (y * w + x) + 3] = alpha;
        }
    }
}

/// IEC 61966-2-1; modelling programs write the colours of their colour pickers.
fn srgb_to_linear(v: f32) -> f32 {
    if v <= 0.040_45 {
        v / 12.92
    } else {
        ((v + 0.055) / 1.055).powf(2.4)
    }
}
