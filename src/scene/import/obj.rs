//! Wavefront OBJ: statements to meshes. Every error names its line.

use std::collections::HashMap;
use std::path::Path;

use glam::{DAffine3, DVec3};

use super::json::Check;
use super::mtl::MtlMaterial;
use super::{LoadOptions, limits, mtl, obj_materials, polygon};
use crate::scene::model::{Instance, Mesh, Model, Primitive};

/// Reads an OBJ and the MTL files and images it names or that lie beside it.
pub(super) fn read(bytes: &[u8], path: &Path, options: &LoadOptions) -> Check<Model> {
    let text = String::from_utf8_lossy(bytes);
    let folder = path.parent().unwrap_or(Path::new("."));
    let stem = path
        .file_stem()
        .map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    let mut parser = Parser::default();
    for (i, line) in logical_lines(&text) {
        parser
            .statement(&line)
            .map_err(|e| format!("line {i}: {e}"))?;
    }
    let mut model = Model {
        name: stem,
        path: Some(path.to_owned()),
        ..Model::default()
    };
    let libraries = std::mem::take(&mut parser.libraries);
    let library = read_libraries(&libraries, folder, &mut model.warnings)?;
    let names = std::mem::take(&mut parser.materials);
    parser.finish(&mut model);
    obj_materials::build(&mut model, &names, &library, folder, &options.textures)?;
    limits::check(&model)?;
    Ok(model)
}

/// Lines without comments, joined where they end in a backslash, with their first line number.
fn logical_lines(text: &str) -> impl Iterator<Item = (usize, String)> + '_ {
    let mut lines = text.lines().enumerate();
    std::iter::from_fn(move || {
        let (i, first) = lines.next()?;
        let mut line = first
            .split('#')
            .next()
            .unwrap_or_default()
            .trim_end()
            .to_owned();
        while line.ends_with('\\') {
            line.pop();
            match lines.next() {
                Some((_, more)) => {
                    line.push_str(more.split('#').next().unwrap_or_default().trim_end());
                }
                None => break,
            }
        }
        Some((i + 1, line))
    })
}

/// All materials of the named libraries. A library that is missing is only a warning: the
/// material names alone still tell leaves from bark.
fn read_libraries(
    named: &[String],
    folder: &Path,
    warnings: &mut Vec<String>,
) -> Check<Vec<MtlMaterial>> {
    let mut out = Vec::new();
    for statement in named {
        let whole = folder.join(statement.replace('\\', "/"));
        let files = if whole.is_file() {
            vec![whole]
        } else {
            statement
                .split_whitespace()
                .map(|f| folder.join(f.replace('\\', "/")))
                .collect()
        };
        for file in files {
            match std::fs::read(&file) {
                Ok(bytes) => out.extend(
                    mtl::parse(&String::from_utf8_lossy(&bytes))
                        .map_err(|e| format!("{}: {e}", file.display()))?,
                ),
                Err(e) => warnings.push(format!("cannot read {}: {e}", file.display())),
            }
        }
    }
    Ok(out)
}

#[derive(Default)]
struct Parser {
    positions: Vec<DVec3>,
    colors: Vec<[f32; 3]>,
    texcoords: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    materials: Vec<String>,
    libraries: Vec<String>,
    objects: Vec<Object>,
    material: Option<usize>,
    other_statements: usize,
    short_faces: usize,
}

#[derive(Default)]
struct Object {
    name: String,
    builders: Vec<Builder>,
}

/// One primitive being built.
#[derive(Default)]
struct Builder {
    material: usize,
    /// (position, texture coordinate, normal) of every vertex, zero-based.
    corners: Vec<Corner>,
    seen: HashMap<Corner, u32>,
    indices: Vec<u32>,
}

type Corner = (u32, Option<u32>, Option<u32>);

impl Builder {
    fn vertex(&mut self, corner: Corner) -> Check<u32> {
        let next = u32::try_from(self.corners.len()).map_err(|_| "more than 2^32 vertices")?;
        let vertex = *self.seen.entry(corner).or_insert(next);
        if vertex == next {
            self.corners.push(corner);
        }
        Ok(vertex)
    }
}

impl Parser {
    fn statement(&mut self, line: &str) -> Check<()> {
        let mut words = line.split_whitespace();
        let Some(key) = words.next() else {
            return Ok(());
        };
        let rest = line.trim_start()[key.len()..].trim();
        match key {
            "v" => self.vertex(words)?,
            "vt" => {
                let v = floats(words)?;
                let [u, v] = [v.first(), v.get(1)].map(|c| c.map_or(0.0, |c| *c as f32));
                // OBJ counts v from the bottom of the image, glTF from the top.
                self.texcoords.push([u, 1.0 - v]);
            }
            "vn" => match floats(words)?[..] {
                [x, y, z, ..] => self.normals.push([x as f32, y as f32, z as f32]),
                _ => return Err("a normal needs three numbers".into()),
            },
            "f" | "fo" => self.face(words)?,
            "o" => self.objects.push(Object {
                name: rest.to_owned(),
                builders: vec![],
            }),
            "usemtl" => self.material = Some(self.material_slot(rest)),
            "mtllib" => self.libraries.push(rest.to_owned()),
            "g" | "s" | "vp" => {}
            _ => self.other_statements += 1,
        }
        Ok(())
    }

    fn vertex<'a>(&mut self, words: impl Iterator<Item = &'a str>) -> Check<()> {
        let v = floats(words)?;
        if v.len() < 3 {
            return Err("a vertex needs three numbers".into());
        }
        if let Some(bad) = v[..3].iter().find(|c| !(**c as f32).is_finite()) {
            let what = if bad.is_nan() { "NaN" } else { "infinite" };
            return Err(format!("vertex {} is {what}", self.positions.len() + 1));
        }
        self.positions.push(DVec3::new(v[0], v[1], v[2]));
        if let [_, _, _, r, g, b] = v[..] {
            self.colors.resize(self.positions.len() - 1, [1.0; 3]);
            self.colors.push([r as f32, g as f32, b as f32]);
        }
        Ok(())
    }

    fn material_slot(&mut self, name: &str) -> usize {
        let found = self.materials.iter().position(|m| m == name);
        found.unwrap_or_else(|| {
            self.materials.push(name.to_owned());
            self.materials.len() - 1
        })
    }

    fn face<'a>(&mut self, words: impl Iterator<Item = &'a str>) -> Check<()> {
        let corners = words.map(|w| self.corner(w)).collect::<Check<Vec<_>>>()?;
        if corners.len() < 3 {
            self.short_faces += 1;
            return Ok(());
        }
        let points: Vec<DVec3> = corners
            .iter()
            .map(|c| self.positions[c.0 as usize])
            .collect();
        let material = match self.material {
            Some(m) => m,
            None => self.material_slot("default"),
        };
        if self.objects.is_empty() {
            self.objects.push(Object::default());
        }
        let object = self.objects.last_mut().expect("pushed above");
        let slot = object.builders.iter().position(|b| b.material == material);
        let slot = slot.unwrap_or_else(|| {
            object.builders.push(Builder {
                material,
                ..Builder::default()
            });
            object.builders.len() - 1
        });
        let builder = &mut object.builders[slot];
        let vertices = corners
            .into_iter()
            .map(|c| builder.vertex(c))
            .collect::<Check<Vec<_>>>()?;
        let triangles = polygon::triangulate(&points);
        let indices = triangles.iter().flatten().map(|&k| vertices[k]);
        builder.indices.extend(indices);
        Ok(())
    }

    fn corner(&self, word: &str) -> Check<Corner> {
        let mut parts = word.split('/');
        let mut next = |what: &str, len: usize| match parts.next() {
            None | Some("") => Ok(None),
            Some(number) => resolve(number, what, len).map(Some),
        };
        let position = next("vertex", self.positions.len())?;
        let position = position.ok_or_else(|| format!("\"{word}\" names no vertex"))?;
        let texcoord = next("texture coordinate", self.texcoords.len())?;
        let normal = next("normal", self.normals.len())?;
        Ok((position, texcoord, normal))
    }

    /// Turns objects into meshes. Coordinates far from zero move into the instances, so that
    /// f32 vertices keep their millimetres.
    fn finish(&mut self, model: &mut Model) {
        let (lo, hi) = self
            .positions
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), &q| {
                (lo.min(q), hi.max(q))
            });
        let centre = 0.5 * (lo + hi);
        let far = centre.is_finite() && centre.length() > 16.0 * (hi - lo).length();
        let offset = if far { centre.floor() } else { DVec3::ZERO };
        self.colors.resize(
            if self.colors.is_empty() {
                0
            } else {
                self.positions.len()
            },
            [1.0; 3],
        );
        for object in std::mem::take(&mut self.objects) {
            let builders = object.builders.iter();
            let primitives: Vec<_> = builders.map(|b| self.primitive(b, offset)).collect();
            if primitives.is_empty() {
                continue;
            }
            let mesh = model.meshes.len();
            let name = match object.name.as_str() {
                "" => model.name.clone(),
                name => name.to_owned(),
            };
            model.instances.push(Instance {
                name: name.clone(),
                mesh,
                local_to_world: DAffine3::from_translation(offset),
                source: None,
            });
            model.meshes.push(Mesh { name, primitives });
        }
        let rows = [
            (
                self.short_faces,
                "faces of fewer than three corners are left out",
            ),
            (
                self.other_statements,
                "statements other than faces are not read",
            ),
        ];
        let told = rows.iter().filter(|(n, _)| *n > 0);
        model
            .warnings
            .extend(told.map(|(n, what)| format!("{n} {what}")));
    }

    fn primitive(&self, b: &Builder, offset: DVec3) -> Primitive {
        let has = |pick: fn(&Corner) -> bool| b.corners.iter().any(pick);
        let mut out = Primitive {
            material: b.material,
            indices: b.indices.clone(),
            ..Primitive::default()
        };
        let corners = b.corners.iter();
        out.positions = corners
            .clone()
            .map(|c| (self.positions[c.0 as usize] - offset).as_vec3().into())
            .collect();
        if has(|c| c.1.is_some()) {
            let uv = |c: &Corner| c.1.map_or([0.0; 2], |i| self.texcoords[i as usize]);
            out.texcoords = corners.clone().map(uv).collect();
        }
        if has(|c| c.2.is_some()) {
            for c in corners.clone() {
                let v = c.2.map_or([0.0; 3], |i| self.normals[i as usize]);
                let unit = glam::Vec3::from(v).normalize_or_zero();
                out.normals.push(unit.into());
            }
        }
        if !self.colors.is_empty() {
            let rgba = |c: &Corner| {
                let [r, g, b] = self.colors[c.0 as usize];
                [r, g, b, 1.0]
            };
            out.colors = corners.map(rgba).collect();
        }
        out
    }
}

/// One-based, or negative from the end, to zero-based.
fn resolve(number: &str, what: &str, len: usize) -> Check<u32> {
    let i: i64 = number
        .parse()
        .map_err(|_| format!("\"{number}\" is not an index"))?;
    let zero_based = if i < 0 {
        i.checked_add(len as i64)
    } else {
        i.checked_sub(1)
    };
    zero_based
        .and_then(|k| u32::try_from(k).ok())
        .filter(|&k| (k as usize) < len)
        .ok_or_else(|| format!("{what} {i} does not exist, there are {len}"))
}

fn floats<'a>(words: impl Iterator<Item = &'a str>) -> Check<Vec<f64>> {
    words
        .map(|w| w.parse().map_err(|_| format!("\"{w}\" is not a number")))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn load(text: &str) -> Check<Model> {
        read(
            text.as_bytes(),
            Path::new("/nowhere/plant.obj"),
            &LoadOptions::default(),
        )
    }

    #[test]
    fn quads_polygons_negative_indices_and_continued_lines() {
        let m = load(
            "v 0 0 0\nv 1 0 0 # right\nv 1 1 0\nv 0 1 0\nv .5 2 0\nvt 0 0\nvt 1 .25\n\
             usemtl Leaf\nf 1/1 2/2 3/1 4/1\nusemtl Bark\nf -5 -4 -3 -1 \\\n -2\nusemtl Leaf\nf 1 2 3\n",
        )
        .unwrap();
        assert_eq!(m.meshes.len(), 1);
        let [leaf, bark] = &m.meshes[0].primitives[..] else {
            panic!("two materials")
        };
        assert_eq!((leaf.indices.len(), bark.indices.len()), (9, 9));
        assert_eq!((leaf.positions.len(), bark.positions.len()), (7, 5));
        assert_eq!(leaf.texcoords[1], [1.0, 0.75]);
        assert!(bark.texcoords.is_empty() && leaf.normals.is_empty());
        assert_eq!(
            (m.materials[0].name.as_str(), m.materials[1].name.as_str()),
            ("Leaf", "Bark")
        );
    }

    #[test]
    fn errors_name_the_line() {
        for (text, line, word) in [
            ("v 0 0 0\nf 1 2 3", 2, "vertex 2 does not exist"),
            ("v 0 0 0\nv 0 nan 0", 2, "vertex 2 is NaN"),
            ("v 0 0 1e99", 1, "infinite"),
            ("v 0 0", 1, "three numbers"),
            ("v a b c", 1, "\"a\" is not a number"),
            ("v 0 0 0\n\nf -2 1 1", 3, "vertex -2"),
            ("v 0 0 0\nf 0 1 1", 2, "vertex 0"),
            ("v 0 0 0\nf 1/1 1 1", 2, "texture coordinate 1"),
            ("v 0 0 0\nf x 1 1", 2, "\"x\" is not an index"),
            ("v 0 0 0\nf 1//9 1 1", 2, "normal 9"),
        ] {
            let e = load(text).unwrap_err();
            assert!(
                e.contains(&format!("line {line}:")) && e.contains(word),
                "{text:?}: {e}"
            );
        }
        assert!(load("v 0 0 0\n").unwrap_err().contains("no triangles"));
    }

    #[test]
    fn a_plant_in_map_coordinates_keeps_its_millimetres() {
        let m = load("v 500000.001 5000000 0\nv 500000.002 5000000 0\nv 500000 5000001 0\nf 1 2 3")
            .unwrap();
        let p = &m.meshes[0].primitives[0].positions;
        assert!((p[1][0] - p[0][0] - 0.001).abs() < 1e-7);
        let world = m.instances[0]
            .local_to_world
            .transform_point3(glam::Vec3::from(p[0]).as_dvec3());
        assert!((world.x - 500_000.001).abs() < 1e-7);
    }

    #[test]
    fn vertex_colours_are_read() {
        let m = load("v 0 0 0\nv 1 0 0 1 .5 0\nv 0 1 0\nf 1 2 3").unwrap();
        assert_eq!(m.meshes[0].primitives[0].colors[1], [1.0, 0.5, 0.0, 1.0]);
        assert_eq!(m.meshes[0].primitives[0].colors[2], [1.0; 4]);
    }
}
