//! What the vertices of a picture send out and see of the sun, from the light files of its plants:
//! one file a plant, in however many places it stands.
//!
//! Transfer vectors and maps hold in the plant's own frame, so that sky and sun are turned into
//! the frame of each place.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3};
use rayon::prelude::*;

use super::lit::{LitModel, LitPlace};
use crate::leaf::environment::{Coefficients, Sun};
use crate::leaf::film::Film;
use crate::leaf::lamp_transfer::{self, LampTransfer};
use crate::leaf::level_choice::{Blend, Leaves, LevelChoice};
use crate::leaf::levels::Level;
use crate::leaf::light::{Light, Lighting, ModelKey, VisibilityMaps, exit_radiance};
use crate::leaf::light_file;
use crate::scene::{Geometry, Part};
use crate::{Error, Result};

/// Vertices whose vectors are unpacked at once.
const BLOCK: usize = 4096;

/// Light files of what is drawn.
#[derive(Debug)]
pub struct Relight<'a> {
    plants: Vec<Plant<'a>>,
}

/// A light file and where it holds.
#[derive(Debug)]
struct Plant<'a> {
    name: String,
    light: Arc<Light>,
    optics: ModelKey,
    levels: Vec<Level>,
    leaves: Leaves,
    geometry: &'a Geometry,
    /// Whether it is everything that is drawn.
    whole: bool,
    places: Vec<Place>,
}

#[derive(Debug)]
struct Place {
    place: LitPlace,
    /// First vertex in the scene's geometry.
    first_vertex: usize,
    /// Turns directions of the scene into the plant's own frame.
    to_plant: DQuat,
    /// The plant's metres in the scene's.
    scale: f64,
    choice: LevelChoice,
}

/// How vectors are lit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relighting {
    /// Strength of the window on the sun.
    pub window: f64,
    /// Whether the direct light of sun and lamps comes from the vectors too.
    pub direct_sun: bool,
    /// Bands that are used.
    pub order: usize,
    /// Pixels between the vertices of the level that a leaf takes; 0: the finest.
    pub lod_pixels: f64,
}

impl<'a> Relight<'a> {
    /// The light files at `paths` for the plants of `lit`, or one for all of it.
    ///
    /// # Errors
    /// A file that cannot be read, is of none of the plants, or a plant without a file.
    pub fn read(lit: &'a LitModel, paths: &[PathBuf]) -> Result<Self> {
        let mut plants = Vec::new();
        let mut used = vec![false; paths.len()];
        let mut lights = Vec::new();
        if lit.plants.is_empty() {
            if let [_, other, ..] = paths {
                return Err(Error::file(other, "--light: one model takes one file"));
            }
            for path in paths {
                let light = light_file::read(path, &lit.key(), lit.vertices())?;
                lights.push(Arc::new(light));
            }
        } else {
            for path in paths {
                lights.push(Arc::new(light_file::read_any(path)?));
            }
        }
        if let [light] = &lights[..]
            && light.model == lit.key()
        {
            let own = LitPlace {
                to_scene: DAffine3::IDENTITY,
                parts: 0..lit.geometry.parts.len(),
            };
            let name = lit.model.name.clone();
            let of = (&lit.geometry, lit.optics_key(), &[own][..]);
            plants.push(Plant::new(name, light.clone(), of, &lit.geometry.parts)?);
            return Ok(Self { plants });
        }
        for plant in &lit.plants {
            let key = plant.key();
            let found = lights.iter().position(|l| l.model == key);
            let Some(found) = found else {
                return Err(Error::usage(format!(
                    "--light: none of the files is of the plant `{}` nor of the whole scene",
                    plant.name
                )));
            };
            used[found] = true;
            let of = (&plant.geometry, plant.optics_key(), &plant.places[..]);
            let light = lights[found].clone();
            plants.push(Plant::new(
                plant.name.clone(),
                light,
                of,
                &lit.geometry.parts,
            )?);
        }
        if let Some(idle) = used.iter().position(|u| !u) {
            return Err(Error::file(
                &paths[idle],
                "light: is of another model than the scene's plants",
            ));
        }
        Ok(Self { plants })
    }

    /// The light file, where one holds for everything that is drawn.
    #[must_use]
    pub fn whole(&self) -> Option<&Light> {
        match &self.plants[..] {
            [plant] if plant.whole => Some(&plant.light),
            _ => None,
        }
    }

    /// Whether the vectors hold gloss as diffuse reflection, as they do where no matrices are
    /// meant to bring it.
    #[must_use]
    pub fn gloss_is_diffuse(&self) -> bool {
        self.plants.iter().all(|p| p.light.matrices.is_none())
    }

    /// Splits of the triangles that the stored maps are for.
    #[must_use]
    pub fn splits(&self) -> Option<u32> {
        let maps = self.plants.iter().find_map(|p| p.light.visibility.as_ref());
        maps.map(|m| m.splits)
    }

    /// Bytes of the vectors and of the maps, each once, and what they would be if every place had
    /// its own.
    #[must_use]
    pub fn bytes(&self) -> [[u64; 2]; 2] {
        let mut out = [[0; 2]; 2];
        for plant in &self.plants {
            let vectors = plant.light.transfer.iter().map(|t| t.bytes.len() as u64);
            let maps = plant.light.visibility.as_ref();
            let own = [vectors.sum(), maps.map_or(0, VisibilityMaps::bytes)];
            for (sum, bytes) in out.iter_mut().zip(own) {
                sum[0] += bytes;
                sum[1] += bytes * plant.places.len() as u64;
            }
        }
        out
    }

    /// Sky and indirect light that leaves the front and the back of each of the `vertices` of the
    /// scene.
    ///
    /// # Errors
    /// Files without vectors, or with those of other leaves.
    pub fn radiance(
        &mut self,
        film: &Film,
        how: &Relighting,
        vertices: usize,
    ) -> Result<Vec<[f32; 3]>> {
        let mut out = vec![[0.0; 3]; 2 * vertices];
        for plant in &mut self.plants {
            plant.check()?;
            plant.radiance(film, how, &mut out);
        }
        Ok(out)
    }

    /// What each vertex of the refined scene sees of the sun by the stored maps: no other plant
    /// hides it there.
    ///
    /// # Errors
    /// A file without maps, or maps for another number of splits.
    pub fn visibility(
        &self,
        towards: DVec3,
        blend: bool,
        (refined, splits): (&Geometry, u32),
    ) -> Result<Vec<f32>> {
        let mut out = vec![0.0; refined.positions.len()];
        for plant in &self.plants {
            let maps =
                plant.light.visibility.as_ref().ok_or_else(|| {
                    Error::usage("--stored: needs --light FILE with visibility maps")
                })?;
            if maps.splits != splits {
                return Err(Error::usage(format!(
                    "--splits {splits}: the light file of `{}` has maps for {}",
                    plant.name, maps.splits
                )));
            }
            for place in &plant.places {
                let seen = maps.towards(place.to_plant * towards, blend);
                let first = refined.parts[place.place.parts.start].first_vertex;
                out[first..first + seen.len()].copy_from_slice(&seen);
            }
        }
        Ok(out)
    }
}

impl<'a> Plant<'a> {
    fn new(
        name: String,
        light: Arc<Light>,
        (geometry, optics, places): (&'a Geometry, ModelKey, &[LitPlace]),
        parts: &[Part],
    ) -> Result<Self> {
        let levels: Vec<Level> = light
            .transfer
            .iter()
            .map(|t| Level::new(geometry, t.edge))
            .collect();
        let known = levels.iter().zip(&light.transfer);
        if known.into_iter().any(|(l, t)| l.vertices != t.receivers()) {
            return Err(Error::usage(format!(
                "--light: has other levels of detail than `{name}` gives"
            )));
        }
        let place = |place: &LitPlace| {
            let scale = place.to_scene.matrix3.determinant().abs().cbrt();
            let turn = place.to_scene.matrix3 * scale.recip();
            Place {
                first_vertex: parts[place.parts.start].first_vertex,
                to_plant: DQuat::from_mat3(&turn).inverse(),
                scale,
                choice: LevelChoice::new(LevelChoice::PLAY),
                place: place.clone(),
            }
        };
        Ok(Self {
            name,
            optics,
            levels,
            leaves: Leaves::new(geometry),
            geometry,
            whole: places.len() == 1
                && places[0].parts == (0..parts.len())
                && places[0].to_scene == DAffine3::IDENTITY,
            places: places.iter().map(place).collect(),
            light,
        })
    }

    fn check(&self) -> Result<()> {
        if self.light.transfer.is_empty() {
            return Err(Error::usage(
                "--lighting: needs --light FILE with transfer vectors; `umbrage light` makes it",
            ));
        }
        if self.light.optics != self.optics {
            return Err(Error::usage(
                "--light: its transfer vectors are those of other leaves; `umbrage light --keep` \
                 computes them again and keeps the sun's maps",
            ));
        }
        Ok(())
    }

    /// Adds the light of every place to `out`.
    fn radiance(&mut self, film: &Film, how: &Relighting, out: &mut [[f32; 3]]) {
        let blends = self.blends(film, how.lod_pixels);
        let lights: Vec<[Coefficients; 2]> = self
            .places
            .par_iter()
            .map(|place| place.lights(film, how.window))
            .collect();
        for number in 0..self.levels.len() {
            let own = self.level(number, (&blends, &lights), (film, how));
            for ((own, place), blends) in own.into_iter().zip(&self.places).zip(&blends) {
                let Some(own) = own else { continue };
                let all = self.levels[number].spread(own);
                let leaves = &self.leaves.of_vertex;
                let out = &mut out[2 * place.first_vertex..][..all.len()];
                out.par_iter_mut()
                    .zip(&all)
                    .enumerate()
                    .for_each(|(k, (sum, value))| {
                        let share = blends[leaves[k / 2] as usize].share(number);
                        for (sum, value) in sum.iter_mut().zip(value) {
                            *sum += share * value;
                        }
                    });
            }
        }
    }

    /// Radiance of the level's own vertices in each place that takes some of it.
    fn level(
        &self,
        number: usize,
        (blends, lights): (&[Vec<Blend>], &[[Coefficients; 2]]),
        (film, how): (&Film, &Relighting),
    ) -> Vec<Option<Vec<[f32; 3]>>> {
        let level = &self.levels[number];
        let takes = |blends: &Vec<Blend>| blends.iter().any(|b| b.share(number) > 0.0);
        let mut out: Vec<_> = blends
            .iter()
            .map(|b| takes(b).then(|| vec![[0.0; 3]; 2 * level.vertices]))
            .collect();
        let leaf = |i: usize| match &level.lod {
            Some(lod) => self.leaves.of_vertex[lod.coarse[i] as usize] as usize,
            None => self.leaves.of_vertex[i] as usize,
        };
        for first in (0..level.vertices).step_by(BLOCK) {
            let range = first..(first + BLOCK).min(level.vertices);
            let wanted =
                |blends: &[Blend]| range.clone().any(|i| blends[leaf(i)].share(number) > 0.0);
            let wanted: Vec<bool> = blends.iter().map(|b| wanted(b)).collect();
            if !wanted.contains(&true) {
                continue;
            }
            let transfer = self.light.transfer[number].part(range.clone());
            let lit = out.iter_mut().zip(lights).zip(&self.places);
            for (((own, [sky, sun]), place), _) in lit.zip(&wanted).filter(|w| *w.1) {
                let Some(own) = own else { continue };
                let lighting = Lighting {
                    sky,
                    sun,
                    direct_sun: how.direct_sun,
                    order: how.order,
                };
                let mut radiance = exit_radiance(&transfer, &lighting);
                if !film.lamps.is_empty() {
                    let places = range
                        .clone()
                        .map(|i| place.scene_point(self.point(level, i)));
                    let places: Vec<DVec3> = places.collect();
                    let lamps = (&places[..], &film.lamps[..]);
                    lamp_transfer::add(&mut radiance, &transfer, lamps, place.lamps(how));
                }
                own[2 * range.start..2 * range.end].copy_from_slice(&radiance);
            }
        }
        out
    }

    /// A vertex of the level, in the plant's world coordinates.
    fn point(&self, level: &Level, number: usize) -> DVec3 {
        let vertex = match &level.lod {
            Some(lod) => lod.coarse[number] as usize,
            None => number,
        };
        self.geometry.origin + self.geometry.positions[vertex].as_dvec3()
    }

    /// Levels of every leaf in every place.
    fn blends(&mut self, film: &Film, pixels: f64) -> Vec<Vec<Blend>> {
        let edges: Vec<f32> = self.levels.iter().map(|l| l.edge).collect();
        let camera = &film.camera;
        // Of the picture's height at distance 1.
        let pixel = 2.0 * camera.half_extent()[1] / f64::from(film.size[1]);
        let (spheres, origin) = (&self.leaves.spheres, self.geometry.origin);
        let blend = |place: &mut Place| {
            let wanted: Vec<f32> = spheres
                .iter()
                .map(|&(middle, radius)| {
                    let middle = place
                        .place
                        .to_scene
                        .transform_point3(origin + middle.as_dvec3());
                    let distance = camera.eye.distance(middle) / place.scale - f64::from(radius);
                    pixels * pixel * distance.max(0.0)
                })
                .map(|w| w as f32)
                .collect();
            let taken = place.choice.update(&wanted);
            taken.iter().map(|&w| Blend::new(&edges, w)).collect()
        };
        self.places.iter_mut().map(blend).collect()
    }
}

impl Place {
    fn scene_point(&self, own: DVec3) -> DVec3 {
        self.place.to_scene.transform_point3(own)
    }

    fn lamps(&self, how: &Relighting) -> LampTransfer {
        LampTransfer {
            direct: how.direct_sun,
            order: how.order,
            window: how.window,
            turn: self.to_plant,
        }
    }

    /// Sky and sun in the plant's frame.
    fn lights(&self, film: &Film, window: f64) -> [Coefficients; 2] {
        let sun = Sun {
            towards: self.to_plant * film.sun.towards,
            ..film.sun
        };
        let sky = film.sky.turned(self.to_plant).coefficients();
        [sky, sun.coefficients(window)]
    }
}
