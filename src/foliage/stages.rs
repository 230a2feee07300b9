//! The stages of a bake in order: the one path behind [`super::Bake::compute`] and
//! [`super::Recipe::new`].

use super::ambient::{self, AmbientFields};
use super::bake::{Bake, Stats};
use super::bins::BinGrid;
use super::cutout;
use super::field::{Field, Queries};
use super::frame::Frame;
use super::generators::{self, BinnedGenerators, Generators, SortedGenerators};
use super::implicit;
use super::openness::{self, Skylight, Triangles};
use super::realign;
use super::recorder::{Kernel, Recorder, Store, Use};
use super::settings::{AmbientMode, Encoding, Norm, NormalsMode, Settings};
use super::split::{Leaves, Split};
use super::subset;
use super::surface::{DensityGrid, Surface};
use super::traced::{Occluders, Rays, Weighting};
use crate::Result;
use crate::abi;
use crate::gpu::shaders::foliage as shaders;
use crate::scene::{Geometry, Model};

/// What the settings ask for.
#[derive(Debug, Clone, Copy)]
struct Needs {
    /// Realigned normals.
    normals: bool,
    /// Ambient coefficients made on the device.
    ambient: bool,
    /// A field of weights (not of leaf areas).
    field: bool,
    /// The leaf-area grid.
    leaf_area: bool,
}

impl Needs {
    fn new(s: &Settings) -> Self {
        let normals = s.normals != NormalsMode::Original && s.blend > 0.0;
        let open = normals && s.normals == NormalsMode::Open;
        let eq4 = s.ambient == AmbientMode::Eq4;
        let transmittance = s.ambient == AmbientMode::Transmittance;
        Self {
            normals,
            ambient: eq4 || transmittance,
            field: eq4 || (normals && !open),
            leaf_area: open || transmittance,
        }
    }
}

/// What every stage reads.
pub(super) struct Scene<'a> {
    /// Absent in a recipe, which decodes no texture.
    pub(super) model: Option<&'a Model>,
    pub(super) geometry: &'a Geometry,
    pub(super) split: &'a Split,
    pub(super) settings: &'a Settings,
    pub(super) frame: Frame,
}

/// Some vertices of the geometry on the device.
pub(super) struct Vertices<'a> {
    /// Their numbers in the geometry.
    pub(super) numbers: &'a [u32],
    /// Normalised positions, four floats each, in the order of `numbers`.
    pub(super) points: Store,
    /// The same, sorted.
    pub(super) queries: Queries,
}

impl<'a> Vertices<'a> {
    fn new(
        r: &mut Recorder<'_>,
        what: &str,
        scene: &Scene<'a>,
        numbers: &'a [u32],
    ) -> Result<Self> {
        let points = r.upload(&format!("{what} points"), &normalised(scene, numbers))?;
        let queries = Queries::sort(r, what, &points, numbers.len(), scene.frame.half)?;
        Ok(Self {
            numbers,
            points,
            queries,
        })
    }
}

/// Normalised positions, padded to four floats.
fn normalised(scene: &Scene<'_>, numbers: &[u32]) -> Vec<[f32; 4]> {
    let at = |&v: &u32| {
        let p = scene.geometry.exact(v as usize);
        scene.frame.normalise(p).extend(0.0).to_array()
    };
    numbers.iter().map(at).collect()
}

/// Generators with the images that the settings need.
pub(super) struct Sources {
    pub(super) generators: Generators,
    /// Weights.
    pub(super) weights: Option<SortedGenerators>,
}

impl Sources {
    /// The field of the generators' weights with `radius`.
    pub(super) fn field(&self, radius: f32, norm: Norm) -> Field<'_> {
        Field {
            generators: self.weights.as_ref().expect("made where a field is used"),
            radius,
            norm,
        }
    }
}

/// Results of the device on their way to the host.
#[derive(Debug, Default)]
struct Results {
    normals: Option<Store>,
    foliage_ambient: Option<Store>,
    covered_ambient: Option<Store>,
}

pub(super) fn bake(
    r: &mut Recorder<'_>,
    model: Option<&Model>,
    geometry: &Geometry,
    split: &Split,
    settings: &Settings,
) -> Result<Bake> {
    settings.check()?;
    let (min, max) = split.bounds(geometry);
    let scene = Scene {
        model,
        geometry,
        split,
        settings,
        frame: Frame::new(min, max),
    };
    let mut bake = Bake {
        normals: geometry.normals.clone(),
        ambient: vec![1.0; geometry.positions.len()],
        foliage_parts: split.foliage_parts.clone(),
        stats: Stats {
            foliage_vertices: split.foliage_vertices.len(),
            covered_vertices: split.covered_vertices.len(),
            diagonal: scene.frame.diagonal,
            ..Stats::default()
        },
        ..Bake::default()
    };
    let needs = Needs::new(settings);
    if needs.normals || needs.ambient {
        device_stages(r, &scene, needs, &mut bake)?;
    }
    if let (AmbientMode::Traced, Some(model)) = (settings.ambient, model) {
        r.report("rays", 0.8);
        let rays = Rays {
            count: settings.directions,
            seed: settings.seed,
            weighting: Weighting::Sphere,
        };
        let occluders = Occluders::new(model, geometry)?;
        bake.ambient = occluders.ambient(&geometry.positions, &geometry.normals, &rays);
    }
    if settings.encoding != Encoding::None {
        bake.encoded = encode(r, settings.encoding, &bake)?;
    }
    r.report("done", 1.0);
    Ok(bake)
}

/// The implicit surface alone, with its stats and, if wanted, the grid it was found on.
pub(super) fn surface(
    r: &mut Recorder<'_>,
    geometry: &Geometry,
    split: &Split,
    settings: &Settings,
    with_density: bool,
) -> Result<(Surface, Stats, Option<DensityGrid>)> {
    // The settings of a bake that realigns by the surface and computes no ambient coefficient.
    let settings = Settings {
        normals: NormalsMode::Vertex,
        blend: 1.0,
        ambient: AmbientMode::None,
        ..*settings
    };
    settings.check()?;
    let (min, max) = split.bounds(geometry);
    let scene = Scene {
        model: None,
        geometry,
        split,
        settings: &settings,
        frame: Frame::new(min, max),
    };
    r.report("generators", 0.0);
    let foliage = Vertices::new(r, "foliage", &scene, &split.foliage_vertices)?;
    let sources = sources(r, &scene, Needs::new(&settings), &foliage.points)?;
    let mut stats = Stats {
        generators: sources.generators.count,
        ..Stats::default()
    };
    r.report("surface", 0.3);
    let mesh = implicit::mesh(r, &scene, &sources, &foliage, &mut stats)?;
    let density = if with_density {
        Some(implicit::density(r, &scene, &sources)?)
    } else {
        None
    };
    r.report("done", 1.0);
    Ok((mesh, stats, density))
}

fn device_stages(
    r: &mut Recorder<'_>,
    scene: &Scene<'_>,
    needs: Needs,
    bake: &mut Bake,
) -> Result<()> {
    r.report("generators", 0.0);
    let points = normalised(scene, &scene.split.foliage_vertices);
    let points = r.upload("foliage points", &points)?;
    let sources = sources(r, scene, needs, &points)?;
    bake.stats.generators = sources.generators.count;
    let numbers = &scene.split.foliage_vertices[..];
    let foliage = Vertices {
        numbers,
        queries: Queries::sort(r, "foliage", &points, numbers.len(), scene.frame.half)?,
        points,
    };
    let covered = if needs.ambient && !scene.split.covered_vertices.is_empty() {
        Some(Vertices::new(
            r,
            "covered",
            scene,
            &scene.split.covered_vertices,
        )?)
    } else {
        None
    };
    let skylight = if needs.leaf_area {
        r.report("skylight", 0.1);
        let triangles = Triangles {
            points: &foliage.points,
            indices: &local_indices(scene.geometry, scene.split),
            shares: &leaf_shares(scene)?,
        };
        Some(Skylight::new(r, scene, &triangles)?)
    } else {
        None
    };
    let mut results = Results::default();
    let mut open = None;
    if let Some(skylight) = &skylight {
        let at = &foliage.queries;
        open = Some(openness::at_queries(r, skylight, "foliage", at)?);
    }
    if needs.normals {
        r.report("normals", 0.3);
        let found = match (&open, scene.settings.normals) {
            (Some(open), NormalsMode::Open) => {
                bake.stats.kept_normals = open.missing(r)?;
                open.directions.clone()
            }
            _ => realign::directions(r, scene, &sources, &foliage, &mut bake.stats)?,
        };
        results.normals = Some(realign::normals(r, scene, &foliage, &found)?);
    }
    if needs.ambient {
        r.report("ambient", 0.7);
        let fields = AmbientFields {
            scene,
            sources: &sources,
            skylight: skylight.as_ref(),
            foliage: &foliage,
            covered: covered.as_ref(),
        };
        let open = open.map(|o| o.ambient);
        let (on_foliage, on_covered) = ambient::coefficients(r, &fields, open, &mut bake.stats)?;
        results.foliage_ambient = Some(on_foliage);
        results.covered_ambient = on_covered;
    }
    collect(r, scene, &results, bake)
}

/// Generators, their subset, and their images in bin order.
fn sources(
    r: &mut Recorder<'_>,
    scene: &Scene<'_>,
    needs: Needs,
    points: &Store,
) -> Result<Sources> {
    let Scene {
        geometry,
        split,
        settings,
        frame,
        ..
    } = scene;
    let leaves = Leaves::new(
        &geometry.positions,
        &split.foliage_indices,
        settings.primitive,
    );
    let indices = local_indices(geometry, split);
    let all = generators::generators(r, points, &indices, &leaves)?;
    let generators = subset::subset(r, all, settings)?;
    let mut radii = Vec::new();
    if needs.normals && settings.normals != NormalsMode::Open {
        radii.push(settings.rho);
    }
    if settings.ambient == AmbientMode::Eq4 {
        radii.push(settings.rho_ambient);
    }
    let grid = BinGrid::for_generators(frame.half, generators.count, &radii);
    // The modes of the field look again, or also, at twice the radius.
    let largest = radii.iter().copied().fold(0.0, f32::max);
    let reach = if settings.needs_surface() {
        largest
    } else {
        2.0 * largest
    };
    let binned: BinnedGenerators = generators.bin(r, grid, reach)?;
    let weights = match needs.field {
        true => Some(generators.texels(r, &binned, 0.0)?),
        false => None,
    };
    Ok(Sources {
        generators,
        weights,
    })
}

/// Foliage triangles with indices into the foliage's own vertices.
fn local_indices(geometry: &Geometry, split: &Split) -> Vec<u32> {
    let mut local = vec![0; geometry.positions.len()];
    for (i, &v) in (0u32..).zip(&split.foliage_vertices) {
        local[v as usize] = i;
    }
    let to_local = |&v: &u32| local[v as usize];
    split.foliage_indices.iter().map(to_local).collect()
}

/// Share of every foliage triangle that is leaf and not the transparent margin of a card.
fn leaf_shares(scene: &Scene<'_>) -> Result<Vec<f32>> {
    let Some(model) = scene.model else {
        return Ok(vec![1.0; scene.split.foliage_indices.len() / 3]);
    };
    let of_parts = cutout::opaque_shares(model, scene.geometry, &scene.split.foliage_parts)?;
    let parts = scene.geometry.parts.iter().zip(of_parts);
    let foliage = parts.zip(&scene.split.foliage_parts).filter(|(_, f)| **f);
    Ok(foliage
        .flat_map(|((part, share), _)| std::iter::repeat_n(share, part.index_count / 3))
        .collect())
}

/// Brings the results to the host and to their vertices.
fn collect(
    r: &mut Recorder<'_>,
    scene: &Scene<'_>,
    results: &Results,
    bake: &mut Bake,
) -> Result<()> {
    let present = [
        &results.normals,
        &results.foliage_ambient,
        &results.covered_ambient,
    ];
    let stores: Vec<&Store> = present.iter().filter_map(|s| s.as_ref()).collect();
    let mut arrays = r
        .fetch_all::<f32>("results", &stores, Vec::new)?
        .into_iter();
    let mut next = |there: bool| if there { arrays.next() } else { None };
    let split = scene.split;
    if let Some(normals) = next(results.normals.is_some()) {
        for (n, &v) in normals.chunks_exact(3).zip(&split.foliage_vertices) {
            bake.normals[v as usize] = glam::Vec3::from_slice(n);
        }
    }
    let ambients = [
        (&results.foliage_ambient, &split.foliage_vertices),
        (&results.covered_ambient, &split.covered_vertices),
    ];
    for (store, vertices) in ambients {
        for (&k, &v) in next(store.is_some()).iter().flatten().zip(vertices) {
            bake.ambient[v as usize] = k;
        }
    }
    Ok(())
}

/// Normal and coefficient of every vertex in the form of `encoding`, in words.
pub(super) fn encode(r: &mut Recorder<'_>, encoding: Encoding, bake: &Bake) -> Result<Vec<u32>> {
    let (constant, words) = match encoding {
        Encoding::Length => (abi::ENCODING_LENGTH, 3),
        Encoding::Packed16 => (abi::ENCODING_PACKED16, 2),
        Encoding::Packed8 => (abi::ENCODING_PACKED8, 1),
        Encoding::None => return Ok(Vec::new()),
    };
    let count = bake.normals.len();
    let normals = r.upload("normals", &bake.normals)?;
    let ambient = r.upload("ambient", &bake.ambient)?;
    let encoded = r.array::<u32>("encoded", words * count)?;
    r.compute(
        "encode",
        Kernel {
            shader: shaders::ENCODE_COMP,
            constants: &[(0, constant)],
        },
        &[
            Use::Read(&normals),
            Use::Read(&ambient),
            Use::Write(&encoded),
        ],
        &abi::Count {
            count: count as u32,
        },
        count,
    )?;
    let mut out = r.fetch::<u32>("encoded", &encoded, Vec::new)?;
    out.truncate(words * count);
    Ok(out)
}
