//! Plants made ready to be drawn in styles.

use glam::DVec3;

use super::prepared::Prepared;
use super::timing::Timings;
use super::{Context, branches, clusters};
use crate::Result;
use crate::foliage::{Bake, Leaves, Primitive};
use crate::ink::leaves::LeafTriangles;
use crate::ink::mix::Mix;
use crate::ink::plant::{CrownLight, Plant};
use crate::ink::renderer::InkScene;
use crate::ink::style::Style;
use crate::ink::view::View;
use crate::render::RenderSettings;
use crate::scene::{Camera, Lens};

/// Leaves, clusters and wood of `prepared`, in the styles of `mix`; `bake` lights its crowns.
///
/// # Errors
/// No leaves, or a texture that cannot be decoded.
pub fn plant(
    context: &Context,
    prepared: &Prepared,
    bake: Option<&Bake>,
    mix: &Mix,
    timings: &mut Timings,
) -> Result<Plant> {
    let split = if mix.styles[0].bodies.smooth {
        prepared.split_with_or_without()?
    } else {
        prepared.split()?
    };
    let (model, geometry) = (&prepared.input.model, &prepared.geometry);
    let mut plant = timings.measure("leaves and clusters", || {
        let indices = &split.foliage_indices;
        let leaves = Leaves::new(&geometry.positions, indices, Primitive::Leaf);
        let triangles = LeafTriangles {
            indices,
            first: &leaves.first,
            triangles: &leaves.triangles,
        };
        let light = bake.map(|b| CrownLight {
            normals: &b.normals,
            ambient: &b.ambient,
        });
        let foliage = &split.foliage_parts;
        let crown = (foliage.as_slice(), light);
        let styles = &mix.styles;
        Plant::gathered(model, geometry, triangles, crown, styles, |c, r, choice| {
            clusters::gather(&context.cache(), c, r, choice)
        })
    })?;
    let hatched = mix.styles.iter().any(|s| s.hatching.strength > 0.0);
    if hatched && !mix.styles[0].bodies.smooth {
        let wood = plant.wood_indices(geometry);
        plant.branches = Some(timings.measure("axes of branches", || {
            branches::find(&context.cache(), &geometry.positions, &wood)
        }));
    }
    name_objects(&mut plant, prepared);
    Ok(plant)
}

/// Objects of a scene are named by its plants too: `plant/node`.
fn name_objects(plant: &mut Plant, prepared: &Prepared) {
    for placed in &prepared.input.plants {
        for instance in placed.instances.clone() {
            plant.objects[instance].insert_str(0, &format!("{}/", placed.name));
        }
    }
}

/// What the hatching of each cluster goes about, those of one style after the other.
#[must_use]
pub fn centres(plant: &Plant, mix: &Mix) -> Vec<DVec3> {
    let of_style = |(k, style): (usize, &Style)| {
        if style.hatching.per_object {
            return plant.object_centres(k);
        }
        let clusters = plant.clusters_of(k).clusters.iter();
        clusters.map(|c| c.centre.as_dvec3()).collect()
    };
    mix.styles.iter().enumerate().flat_map(of_style).collect()
}

/// What is drawn.
#[must_use]
pub fn scene<'a>(prepared: &'a Prepared, plant: &'a Plant) -> InkScene<'a> {
    InkScene {
        model: &prepared.input.model,
        geometry: &prepared.geometry,
        plant,
    }
}

/// The lens of pictures with `settings`.
#[must_use]
pub fn lens(settings: &RenderSettings) -> Lens {
    Lens {
        fov: settings.fov,
        aspect: f64::from(settings.size[0]) / f64::from(settings.size[1]),
        margin: settings.margin,
    }
}

/// The view from `camera`, of whose pixels `factor` along each axis become one; without a camera
/// from where the settings say.
#[must_use]
pub fn view(
    prepared: &Prepared,
    settings: &RenderSettings,
    camera: Option<Camera>,
    factor: u32,
) -> View {
    let geometry = &prepared.geometry;
    let camera = camera.unwrap_or_else(|| {
        let points = geometry.positions.iter().copied();
        Camera::new(&settings.camera, lens(settings), geometry.origin, points)
    });
    let to_sun = settings.sun.direction().as_vec3();
    let size = settings.size.map(|s| s * factor);
    View::new(camera, geometry.origin, size, to_sun, &geometry.positions)
}
