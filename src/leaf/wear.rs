//! Leaves with maps on the materials of a model.

use std::sync::Arc;

use super::appearance::LeafMaterial;
use crate::scene::{AlphaMode, ImageSource, Model, Texture, TextureRef, Wrap};

/// Cuts materials without a texture out by the mask of the leaf that they wear; a texture of their
/// own keeps its outline.
#[must_use]
pub fn cut_out(model: Arc<Model>, leaves: &[Option<Arc<LeafMaterial>>]) -> Arc<Model> {
    let wants = |(number, leaf): (usize, &Option<Arc<LeafMaterial>>)| {
        let leaf = leaf.as_deref()?;
        let bare = model.materials[number].base_color_texture.is_none();
        let mask = leaf.mask.as_deref().filter(|_| bare)?;
        Some((number, leaf.size()?, mask.to_vec()))
    };
    let wanted: Vec<_> = leaves.iter().enumerate().filter_map(wants).collect();
    if wanted.is_empty() {
        return model;
    }
    let mut out = Arc::unwrap_or_clone(model);
    for (number, [width, height], mask) in wanted {
        let pixels: Vec<u8> = mask
            .iter()
            .flat_map(|m| [255, 255, 255, (255.0 * m.clamp(0.0, 1.0)).round() as u8])
            .collect();
        out.images.push(ImageSource::Rgba8 {
            name: "leaf mask".into(),
            width,
            height,
            pixels: pixels.into(),
        });
        out.textures.push(Texture {
            image: out.images.len() - 1,
            wrap_u: Wrap::Clamp,
            wrap_v: Wrap::Clamp,
            nearest: false,
        });
        let material = &mut out.materials[number];
        material.base_color_texture = Some(TextureRef::new(out.textures.len() - 1));
        material.alpha_mode = AlphaMode::Mask { cutoff: 0.5 };
        material.base_color[3] = 1.0;
    }
    Arc::new(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::leaf::{LeafSpecies, SideMaps};
    use crate::scene::Material;

    #[test]
    fn bare_materials_take_the_outline_of_their_leaf() {
        let mut leaf = LeafSpecies::parse("birch").unwrap().plain();
        leaf.upper.maps = Some(Arc::new(SideMaps::plain([2, 1], 0.03, 0.3)));
        leaf.mask = Some(vec![1.0, 0.0].into());
        let model = Arc::new(Model {
            materials: vec![Material::default(), Material::default()],
            ..Model::default()
        });
        let worn = cut_out(model.clone(), &[None, Some(Arc::new(leaf))]);
        assert_eq!(worn.materials[0].alpha_mode, AlphaMode::Opaque);
        assert_eq!(
            worn.materials[1].alpha_mode,
            AlphaMode::Mask { cutoff: 0.5 }
        );
        let ImageSource::Rgba8 { pixels, .. } = &worn.images[0] else {
            panic!("{:?}", worn.images[0]);
        };
        assert_eq!((pixels[3], pixels[7]), (255, 0));
        assert!(Arc::ptr_eq(&model, &cut_out(model.clone(), &[None, None])));
    }
}
