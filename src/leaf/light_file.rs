//! The file of a [`Light`]: a magic word, a version, a JSON header, blocks, a checksum.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `umbrLGT` and a line feed |
//! | 4 | version, little-endian |
//! | 8 | length of the header |
//! | .. | header: model, vertices, conventions, settings and the lengths of the blocks |
//! | .. | transfer vectors, level after level, then transfer matrices, then the maps, one after the other |
//! | 32 | BLAKE3 of everything before |

use std::path::Path;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::directions::Directions;
use super::light::{Light, ModelKey, Storage, StoredTransfer, VisibilityMaps};
use super::matrix::{Colours, StoredMatrices, matrix_floats};
use super::prt::side_floats;
use super::runs;
use crate::math::sh::MAX_ORDER;
use crate::{Error, Result};

const MAGIC: &[u8; 8] = b"umbrLGT\n";
/// Changes whenever older files would be misread.
pub const VERSION: u32 = 4;
/// Spherical harmonics of the vectors, for readers of the file.
const CONVENTION: &str =
    "real, no Condon-Shortley sign, index l(l+1)+m, bands 0 to order - 1, pole +z of the model";

#[derive(Debug, Serialize, Deserialize)]
struct Header {
    model: String,
    optics: String,
    vertices: u32,
    convention: String,
    /// Levels of detail, finest first.
    transfer: Vec<TransferHeader>,
    matrices: Option<MatrixHeader>,
    visibility: Option<MapsHeader>,
}

#[derive(Debug, Serialize, Deserialize)]
struct TransferHeader {
    storage: String,
    order: u32,
    paths: u32,
    edge: f32,
    bytes: u64,
    scales: Vec<f32>,
}

#[derive(Debug, Serialize, Deserialize)]
struct MatrixHeader {
    storage: String,
    order: u32,
    colours: String,
    paths: u32,
    edge: f32,
    bytes: u64,
    scales: Vec<f32>,
}

#[derive(Debug, Serialize, Deserialize)]
struct MapsHeader {
    cube_side: Option<u32>,
    path: Vec<[f64; 3]>,
    splits: u32,
    vertices: u32,
    radius_degrees: f64,
    samples: u32,
    bytes: Vec<u64>,
}

/// The bytes of the file.
#[must_use]
pub fn encode(light: &Light) -> Vec<u8> {
    let header = Header {
        model: hex(&light.model),
        optics: hex(&light.optics),
        vertices: light.vertices,
        convention: CONVENTION.to_owned(),
        transfer: light.transfer.iter().map(transfer_header).collect(),
        matrices: light.matrices.as_ref().map(matrix_header),
        visibility: light.visibility.as_ref().map(|v| {
            let (cube_side, path) = match &v.directions {
                Directions::Cube { side } => (Some(*side), Vec::new()),
                Directions::Path(path) => (None, path.iter().map(DVec3::to_array).collect()),
            };
            MapsHeader {
                cube_side,
                path,
                splits: v.splits,
                vertices: v.vertices,
                radius_degrees: v.radius_degrees,
                samples: v.samples,
                bytes: v.maps.iter().map(|m| m.len() as u64).collect(),
            }
        }),
    };
    let header = serde_json::to_vec(&header).expect("plain data");
    let mut out = MAGIC.to_vec();
    out.extend(VERSION.to_le_bytes());
    out.extend((header.len() as u64).to_le_bytes());
    out.extend(header);
    for t in &light.transfer {
        out.extend(&t.bytes);
    }
    if let Some(m) = &light.matrices {
        out.extend(&m.bytes);
    }
    for map in light.visibility.iter().flat_map(|v| &v.maps) {
        out.extend(map);
    }
    let sum = blake3::hash(&out);
    out.extend(sum.as_bytes());
    out
}

fn transfer_header(t: &StoredTransfer) -> TransferHeader {
    TransferHeader {
        storage: t.storage.name().to_owned(),
        order: t.order,
        paths: t.paths,
        edge: t.edge,
        bytes: t.bytes.len() as u64,
        scales: t.scales.clone(),
    }
}

fn matrix_header(m: &StoredMatrices) -> MatrixHeader {
    MatrixHeader {
        storage: m.storage.name().to_owned(),
        order: m.order,
        colours: m.colours.name().to_owned(),
        paths: m.paths,
        edge: m.edge,
        bytes: m.bytes.len() as u64,
        scales: m.scales.clone(),
    }
}

/// Reads `path`, which must have been computed for the model of key `model` with `vertices`
/// vertices.
///
/// # Errors
/// No light file, another version, cut short or damaged, or of another model: which of these, in
/// words.
pub fn read(path: &Path, model: &ModelKey, vertices: usize) -> Result<Light> {
    let light = read_any(path)?;
    if light.model != *model || light.vertices as usize != vertices {
        return Err(Error::file(
            path,
            format!(
                "light: was computed for another model ({} vertices there, {vertices} here)",
                light.vertices
            ),
        ));
    }
    Ok(light)
}

/// Reads `path`, of whatever model.
///
/// # Errors
/// No light file, another version, cut short or damaged.
pub fn read_any(path: &Path) -> Result<Light> {
    let bytes = std::fs::read(path).map_err(|e| Error::file(path, e))?;
    decode(&bytes).map_err(|reason| Error::file(path, reason))
}

/// The light in the bytes of a file.
///
/// # Errors
/// What is wrong with them.
pub fn decode(bytes: &[u8]) -> Result<Light, String> {
    let cut = || "light: the file is cut short".to_owned();
    let take = |from: usize, count: u64| {
        let count = usize::try_from(count).map_err(|_| cut())?;
        let end = from.checked_add(count).ok_or_else(cut)?;
        bytes.get(from..end).ok_or_else(cut)
    };
    if take(0, 8)? != MAGIC {
        return Err("light: is not a light file".into());
    }
    let version = u32::from_le_bytes(take(8, 4)?.try_into().expect("4 bytes"));
    if version != VERSION {
        return Err(format!(
            "light: version {version}, this program reads version {VERSION}; compute it again"
        ));
    }
    let length = u64::from_le_bytes(take(12, 8)?.try_into().expect("8 bytes"));
    let header = take(20, length)?;
    let damaged = |e: &dyn std::fmt::Display| format!("light: the header is damaged: {e}");
    let header: Header = serde_json::from_slice(header).map_err(|e| damaged(&e))?;
    let mut at = 20 + length as usize;
    let mut block = |count: u64| {
        let block = take(at, count)?.to_vec();
        at += block.len();
        Ok::<_, String>(block)
    };
    let transfer = header
        .transfer
        .into_iter()
        .map(|t| {
            Ok::<_, String>(StoredTransfer {
                storage: Storage::parse(&t.storage).map_err(|e| damaged(&e))?,
                order: t.order,
                bytes: block(t.bytes)?,
                scales: t.scales,
                paths: t.paths,
                edge: t.edge,
            })
        })
        .collect::<Result<Vec<_>, _>>()?;
    let matrices = header
        .matrices
        .map(|m| {
            Ok::<_, String>(StoredMatrices {
                storage: Storage::parse(&m.storage).map_err(|e| damaged(&e))?,
                order: m.order,
                colours: Colours::parse(&m.colours).map_err(|e| damaged(&e))?,
                bytes: block(m.bytes)?,
                scales: m.scales,
                paths: m.paths,
                edge: m.edge,
            })
        })
        .transpose()?;
    let visibility = header
        .visibility
        .map(|v| {
            let path = v.path.iter().map(|&d| DVec3::from(d)).collect();
            Ok::<_, String>(VisibilityMaps {
                directions: match v.cube_side {
                    Some(side) => Directions::Cube { side },
                    None => Directions::Path(path),
                },
                splits: v.splits,
                vertices: v.vertices,
                radius_degrees: v.radius_degrees,
                samples: v.samples,
                maps: v
                    .bytes
                    .iter()
                    .map(|&n| block(n))
                    .collect::<Result<_, _>>()?,
            })
        })
        .transpose()?;
    let sum = take(at, 32)?;
    if at + 32 != bytes.len() || blake3::hash(&bytes[..at]).as_bytes() != sum {
        return Err("light: the checksum does not match; the file is damaged".into());
    }
    let light = Light {
        model: unhex(&header.model).ok_or_else(|| damaged(&"model"))?,
        optics: unhex(&header.optics).ok_or_else(|| damaged(&"optics"))?,
        vertices: header.vertices,
        transfer,
        matrices,
        visibility,
    };
    consistent(&light).map_err(|what| damaged(&what))?;
    Ok(light)
}

/// Whether the blocks have the sizes that the header implies.
fn consistent(light: &Light) -> Result<(), &'static str> {
    let vertices = light.vertices as usize;
    let edges = light.transfer.windows(2);
    if edges.into_iter().any(|w| w[1].edge <= w[0].edge) {
        return Err("order of the levels of detail");
    }
    for t in &light.transfer {
        if !(1..=MAX_ORDER as u32).contains(&t.order) {
            return Err("order of the transfer vectors");
        }
        // One scale serves both sides.
        let floats = side_floats(t.order);
        let stored = (&t.bytes[..], &t.scales[..], t.storage);
        block_fits(stored, (2 * floats, floats), (vertices, t.edge))?;
    }
    if let Some(m) = &light.matrices {
        if !(1..=MAX_ORDER as u32).contains(&m.order) {
            return Err("order of the transfer matrices");
        }
        let floats = matrix_floats(m.order, m.colours);
        let stored = (&m.bytes[..], &m.scales[..], m.storage);
        block_fits(stored, (floats, floats), (vertices, m.edge))?;
    }
    if let Some(v) = &light.visibility {
        let directions = match &v.directions {
            Directions::Cube { side } => 6_usize.saturating_mul((*side as usize).saturating_pow(2)),
            Directions::Path(path) => path.len(),
        };
        let whole = |m: &Vec<u8>| runs::decode(m, v.vertices as usize).is_some();
        if directions != v.maps.len() || !v.maps.iter().all(whole) {
            return Err("visibility maps");
        }
    }
    Ok(())
}

/// Whether a block of transfer holds `floats` for each of as many vertices as its level may have,
/// and the number of scales that its storage asks for.
fn block_fits(
    (bytes, scales, storage): (&[u8], &[f32], Storage),
    (floats, period): (usize, usize),
    (vertices, edge): (usize, f32),
) -> Result<(), &'static str> {
    let width = floats * storage.bytes() as usize;
    let count = bytes.len() / width;
    // How many a level of detail keeps is known only with the model.
    let fits = count == vertices || (edge > 0.0 && count < vertices);
    if !fits || bytes.len() != count * width {
        return Err("size of the transfer");
    }
    if storage == Storage::Byte && scales.len() != period {
        return Err("number of scales");
    }
    Ok(())
}

fn hex(key: &ModelKey) -> String {
    key.iter().map(|b| format!("{b:02x}")).collect()
}

fn unhex(text: &str) -> Option<ModelKey> {
    let mut out = ModelKey::default();
    if text.len() != 2 * out.len() || !text.is_ascii() {
        return None;
    }
    for (i, byte) in out.iter_mut().enumerate() {
        *byte = u8::from_str_radix(&text[2 * i..2 * i + 2], 16).ok()?;
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::leaf::prt::Transfer;

    fn light() -> Light {
        let values: Vec<f32> = (0..6 * side_floats(2)).map(|i| i as f32 * 1e-3).collect();
        let level = |vertices: usize, edge| {
            let values = values[..2 * vertices * side_floats(2)].to_vec();
            StoredTransfer::new(&Transfer { order: 2, values }, Storage::Byte, 64, edge)
        };
        let floats = 3 * matrix_floats(2, Colours::Mono);
        let elements: Vec<f32> = (0..floats).map(|i| i as f32 * 1e-2).collect();
        let form = (2, Colours::Mono);
        let matrices = StoredMatrices::new(&elements, form, Storage::F16, (64, 0.0));
        Light {
            model: [7; 32],
            optics: [9; 32],
            vertices: 3,
            transfer: vec![level(3, 0.0), level(2, 0.5), level(1, 2.0)],
            matrices: Some(matrices),
            visibility: Some(VisibilityMaps {
                directions: Directions::Path(vec![DVec3::Y, DVec3::X]),
                splits: 0,
                vertices: 3,
                radius_degrees: 0.2665,
                samples: 16,
                maps: vec![runs::encode(&[0, 255, 255]), runs::encode(&[1, 2, 3])],
            }),
        }
    }

    #[test]
    fn a_light_comes_back() {
        let bytes = encode(&light());
        assert_eq!(decode(&bytes).unwrap(), light());
    }

    #[test]
    fn damage_is_named() {
        let bytes = encode(&light());
        for end in [0, 5, 15, 40, bytes.len() / 2, bytes.len() - 1] {
            let error = decode(&bytes[..end]).unwrap_err();
            assert!(error.contains("cut short"), "{end}: {error}");
        }
        let changed = |at: usize| {
            let mut b = bytes.clone();
            b[at] ^= 0x40;
            decode(&b).unwrap_err()
        };
        assert!(changed(2).contains("not a light file"));
        assert!(changed(8).contains("version"));
        assert!(changed(bytes.len() - 40).contains("checksum"));
        let mut longer = bytes.clone();
        longer.push(0);
        assert!(decode(&longer).unwrap_err().contains("checksum"));
    }

    #[test]
    fn a_light_of_another_model_is_refused() {
        let folder = std::env::temp_dir().join(format!("umbrage-light-{}", std::process::id()));
        std::fs::write(&folder, encode(&light())).unwrap();
        assert!(read(&folder, &[7; 32], 3).is_ok());
        for (key, vertices) in [([8; 32], 3), ([7; 32], 4)] {
            let error = read(&folder, &key, vertices).unwrap_err().to_string();
            assert!(error.contains("another model"), "{error}");
        }
        std::fs::remove_file(&folder).unwrap();
    }
}
