//! glTF meshes: attributes and triangles.

use std::collections::BTreeMap;

use gltf::json::accessor::{Accessor, ComponentType};
use gltf::json::mesh::{Mode, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{self, Index};
use serde_json::Value;

use super::accessor::Source;
use super::json::{Check, Of, at, known, label, list, name};
use crate::scene::model::{Mesh, Primitive};

/// What reading the meshes repaired or left out.
#[derive(Debug, Default)]
pub(super) struct Counts {
    pub(super) not_triangles: usize,
    pub(super) without_position: usize,
    pub(super) bad_values: usize,
    pub(super) loose_indices: usize,
    pub(super) morphed: usize,
    pub(super) default_material: bool,
}

impl Counts {
    /// One sentence per kind of repair.
    pub(super) fn warnings(&self) -> Vec<String> {
        let rows = [
            (
                self.not_triangles,
                "primitives of points or lines are left out",
            ),
            (
                self.without_position,
                "primitives without POSITION are left out",
            ),
            (
                self.bad_values,
                "texture coordinates or colours that are not finite are reset",
            ),
            (
                self.loose_indices,
                "indices after the last whole triangle are left out",
            ),
            (
                self.morphed,
                "primitives have morph targets; their base shape is used",
            ),
        ];
        let told = rows.iter().filter(|(n, _)| *n > 0);
        told.map(|(n, what)| format!("{n} {what}")).collect()
    }
}

/// All meshes of the document. Primitives without a material get index `default_material`.
pub(super) fn meshes(
    json: &Value,
    source: &Source<'_>,
    default_material: usize,
) -> Check<(Vec<Mesh>, Counts)> {
    let mut counts = Counts::default();
    let mut out = Vec::new();
    for (i, (mesh, v)) in list::<json::Mesh>(json, "meshes", "mesh")?
        .iter()
        .enumerate()
    {
        let mut primitives = Vec::new();
        for (j, p) in mesh.primitives.iter().enumerate() {
            let reader = Reader {
                source,
                counts: &mut counts,
                default_material,
            };
            let read = reader.primitive(p, &v["primitives"][j]);
            if let Some(mut p) = read.of(|| format!("{} primitive {j}", label("mesh", i, v)))? {
                p.source = Some((i, j));
                primitives.push(p);
            }
        }
        out.push(Mesh {
            name: name("mesh", i, v),
            primitives,
        });
    }
    Ok((out, counts))
}

type Attributes = BTreeMap<Checked<Semantic>, Index<Accessor>>;

struct Reader<'a> {
    source: &'a Source<'a>,
    counts: &'a mut Counts,
    default_material: usize,
}

impl Reader<'_> {
    fn primitive(mut self, p: &json::mesh::Primitive, v: &Value) -> Check<Option<Primitive>> {
        let mode = known(p.mode, v, "mode")?;
        if !matches!(
            mode,
            Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
        ) {
            self.counts.not_triangles += 1;
            return Ok(None);
        }
        let attributes = &p.attributes;
        let Some(&position) = attributes.get(&Checked::Valid(Semantic::Positions)) else {
            self.counts.without_position += 1;
            return Ok(None);
        };
        self.counts.morphed += usize::from(p.targets.is_some());
        let positions = self.positions(position)?;
        let n = positions.len();
        let mut out = Primitive {
            material: self.material(p)?,
            normals: self.normals(attributes, n)?,
            texcoords: self.texcoords(attributes, 0, n)?,
            texcoords1: self.texcoords(attributes, 1, n)?,
            colors: self.colors(attributes, n)?,
            ambient: self.ambient(attributes, n)?,
            positions,
            ..Primitive::default()
        };
        out.indices = self.triangles(p, mode, n)?;
        Ok(Some(out))
    }

    fn material(&mut self, p: &json::mesh::Primitive) -> Check<usize> {
        let to_index = |m| at(m, "material", self.default_material);
        let material = p.material.map(to_index).transpose()?;
        self.counts.default_material |= material.is_none();
        Ok(material.unwrap_or(self.default_material))
    }

    fn positions(&self, position: Index<Accessor>) -> Check<Vec<[f32; 3]>> {
        let i = self.source.at(position, "POSITION")?;
        let positions = self.source.vectors::<3>(i).of(|| "POSITION".into())?;
        for (k, q) in positions.iter().enumerate() {
            if let Some(bad) = q.iter().find(|c| !c.is_finite()) {
                let what = if bad.is_nan() { "NaN" } else { "infinite" };
                return Err(format!("POSITION[{k}] is {what}"));
            }
        }
        Ok(positions)
    }

    /// The accessor of an attribute, if it is there; its count must be `n`.
    fn attribute(&self, all: &Attributes, which: Semantic, n: usize) -> Check<Option<usize>> {
        let key = &which.to_string();
        let Some(&i) = all.get(&Checked::Valid(which)) else {
            return Ok(None);
        };
        let i = self.source.at(i, key)?;
        let layout = self.source.layout(i).of(|| key.clone())?;
        if layout.count != n {
            return Err(format!(
                "{key} has {} elements, POSITION has {n}",
                layout.count
            ));
        }
        Ok(Some(i))
    }

    fn normals(&mut self, attributes: &Attributes, n: usize) -> Check<Vec<[f32; 3]>> {
        let Some(i) = self.attribute(attributes, Semantic::Normals, n)? else {
            return Ok(vec![]);
        };
        let mut normals = self.source.vectors::<3>(i).of(|| "NORMAL".into())?;
        for v in &mut normals {
            let unit = glam::Vec3::from(*v).normalize_or_zero();
            // Those of zero length or not finite become zero: `Geometry` counts and repairs them.
            // Leave unit vectors alone to the bit.
            if unit == glam::Vec3::ZERO || (glam::Vec3::from(*v).length() - 1.0).abs() > 1e-4 {
                *v = unit.into();
            }
        }
        Ok(normals)
    }

    fn texcoords(&mut self, attributes: &Attributes, set: u32, n: usize) -> Check<Vec<[f32; 2]>> {
        let Some(i) = self.attribute(attributes, Semantic::TexCoords(set), n)? else {
            return Ok(vec![]);
        };
        let mut out = self
            .source
            .vectors::<2>(i)
            .of(|| format!("TEXCOORD_{set}"))?;
        self.reset(&mut out, [0.0; 2]);
        Ok(out)
    }

    fn colors(&mut self, attributes: &Attributes, n: usize) -> Check<Vec<[f32; 4]>> {
        let Some(i) = self.attribute(attributes, Semantic::Colors(0), n)? else {
            return Ok(vec![]);
        };
        let read = || -> Check<Vec<[f32; 4]>> {
            if self.source.layout(i)?.width == 3 {
                let rgb = self.source.vectors::<3>(i)?;
                Ok(rgb.iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect())
            } else {
                self.source.vectors::<4>(i)
            }
        };
        let mut out = read().of(|| "COLOR_0".into())?;
        self.reset(&mut out, [1.0; 4]);
        Ok(out)
    }

    fn ambient(&mut self, attributes: &Attributes, n: usize) -> Check<Vec<f32>> {
        // The crate takes the underscore off names that are not glTF's own.
        let which = Semantic::Extras("AMBIENT".into());
        let Some(i) = self.attribute(attributes, which, n)? else {
            return Ok(vec![]);
        };
        if self.source.layout(i)?.width != 1 {
            return Ok(vec![]); // Another program's attribute of that name.
        }
        let mut out = self.source.vectors::<1>(i).of(|| "_AMBIENT".into())?;
        self.reset(&mut out, [1.0]);
        Ok(out.iter().map(|[a]| a.clamp(0.0, 1.0)).collect())
    }

    fn reset<const N: usize>(&mut self, values: &mut [[f32; N]], to: [f32; N]) {
        for v in values.iter_mut() {
            if v.iter().any(|c| !c.is_finite()) {
                *v = to;
                self.counts.bad_values += 1;
            }
        }
    }

    fn triangles(&mut self, p: &json::mesh::Primitive, mode: Mode, n: usize) -> Check<Vec<u32>> {
        let list = match p.indices {
            Some(i) => {
                let i = self.source.at(i, "indices")?;
                if self.source.layout(i)?.component == ComponentType::F32 {
                    return Err("indices: floats cannot be indices".into());
                }
                self.source.indices(i).of(|| "indices".into())?
            }
            None => (0..u32::try_from(n).map_err(|_| "more than 2^32 vertices")?).collect(),
        };
        if let Some((k, i)) = list.iter().enumerate().find(|(_, i)| **i as usize >= n) {
            return Err(format!("index[{k}] is {i}, but there are {n} vertices"));
        }
        Ok(match mode {
            Mode::TriangleStrip => strip(&list),
            Mode::TriangleFan => fan(&list),
            _ => {
                self.counts.loose_indices += list.len() % 3;
                let whole = list.len() - list.len() % 3;
                list[..whole].to_vec()
            }
        })
    }
}

/// Triangle strip to list: every other triangle is turned to keep the orientation.
fn strip(list: &[u32]) -> Vec<u32> {
    let windows = list.windows(3).enumerate();
    windows
        .flat_map(|(k, w)| {
            if k % 2 == 0 {
                [w[0], w[1], w[2]]
            } else {
                [w[1], w[0], w[2]]
            }
        })
        .collect()
}

/// Triangle fan to list.
fn fan(list: &[u32]) -> Vec<u32> {
    let Some((&centre, rim)) = list.split_first() else {
        return vec![];
    };
    rim.windows(2).flat_map(|w| [w[0], w[1], centre]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_orientation() {
        assert_eq!(strip(&[0, 1, 2, 3]), [0, 1, 2, 2, 1, 3]);
        assert_eq!(fan(&[9, 1, 2, 3]), [1, 2, 9, 2, 3, 9]);
        assert!(strip(&[0, 1]).is_empty() && fan(&[]).is_empty());
    }
}
