//! `EXT_meshopt_compression`: compressed views are decoded into a buffer of their own and the
//! JSON is rewritten as if the file had never been compressed.

use std::collections::BTreeSet;

use gltf::json::accessor::{ComponentType, Type};
use gltf::json::validation::Checked;
use gltf::json::{Buffer, Index};
use meshopt::{
    decode_filter_exp, decode_filter_oct, decode_filter_quat, decode_index_buffer,
    decode_index_sequence, decode_vertex_buffer,
};
use serde::Deserialize;
use serde_json::{Value, json};

use super::accessor::Source;
use super::json::{Check, Of, array, at, extension, integer, typed};

const NAME: &str = "EXT_meshopt_compression";
/// Most bytes all views of a file may decode to.
const DECODED_LIMIT: usize = 2 << 30;

/// The extension's object.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Compressed {
    buffer: Index<Buffer>,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: usize,
    count: usize,
    mode: String,
    filter: Option<String>,
}

/// Decodes every compressed view of `json`; the bytes become a new last buffer.
pub(super) fn expand(json: &mut Value, buffers: &mut Vec<Vec<u8>>) -> Check<()> {
    let mut out: Vec<u8> = Vec::new();
    let mut places = Vec::new();
    for (i, view) in array(json, "bufferViews")?.iter().enumerate() {
        let Some(e) = extension(view, NAME) else {
            continue;
        };
        let of = || format!("bufferView {i}: {NAME}");
        let e: Compressed = typed(e).of(of)?;
        let bytes = decode(&e, buffers, out.len()).of(of)?;
        if integer(view, "byteLength").is_none_or(|length| length > bytes.len()) {
            return Err(format!(
                "bufferView {i}: {NAME}: decodes to {} bytes",
                bytes.len()
            ));
        }
        out.resize(out.len().next_multiple_of(4), 0);
        places.push((i, out.len(), bytes.len(), e.byte_stride));
        out.extend(bytes);
    }
    if places.is_empty() {
        return Ok(());
    }
    let new_buffer = buffers.len();
    let expanded: BTreeSet<usize> = places.iter().map(|p| p.0).collect();
    for (i, start, length, stride) in places {
        let view = &mut json["bufferViews"][i];
        // A stride is only allowed on vertex attributes; index data is packed.
        if view.get("byteStride").is_some() {
            view["byteStride"] = json!(stride);
        }
        view["buffer"] = json!(new_buffer);
        view["byteOffset"] = json!(start);
        view["byteLength"] = json!(length);
        remove_extension(view);
    }
    if let Some(list) = json["buffers"].as_array_mut() {
        list.iter_mut().for_each(remove_extension);
        list.push(json!({"byteLength": out.len()}));
    }
    buffers.push(out);
    restate_bounds(json, buffers, &expanded)?;
    for key in ["extensionsUsed", "extensionsRequired"] {
        if let Some(list) = json.get_mut(key).and_then(Value::as_array_mut) {
            list.retain(|n| n != NAME);
            if list.is_empty() {
                json.as_object_mut().map(|o| o.shift_remove(key));
            }
        }
    }
    Ok(())
}

/// Filters are lossy: `min` and `max` of floats are stated anew for what was decoded.
fn restate_bounds(json: &mut Value, buffers: &[Vec<u8>], expanded: &BTreeSet<usize>) -> Check<()> {
    let source = Source::new(json, buffers)?;
    let mut bounds = Vec::new();
    for (i, accessor) in source.accessors().enumerate() {
        let view = accessor.buffer_view.map(|v| v.value());
        let stated = accessor.min.is_some() && accessor.max.is_some();
        if !stated || !view.is_some_and(|v| expanded.contains(&v)) {
            continue;
        }
        let component = accessor.component_type;
        let float = matches!(component, Checked::Valid(c) if c.0 == ComponentType::F32);
        if float && accessor.type_ == Checked::Valid(Type::Vec3) {
            let values = source.vectors::<3>(i)?;
            let range = |pick: fn(f32, f32) -> f32| {
                let all = values.iter().copied();
                let one = all.reduce(|a, b| std::array::from_fn(|c| pick(a[c], b[c])));
                one.map(|v| v.map(f64::from))
            };
            bounds.push((i, range(f32::min), range(f32::max)));
        }
    }
    for (i, min, max) in bounds {
        json["accessors"][i]["min"] = json!(min);
        json["accessors"][i]["max"] = json!(max);
    }
    Ok(())
}

fn remove_extension(v: &mut Value) {
    let Some(e) = v.get_mut("extensions").and_then(Value::as_object_mut) else {
        return;
    };
    e.shift_remove(NAME);
    if e.is_empty() {
        v.as_object_mut().map(|o| o.shift_remove("extensions"));
    }
}

fn decode(e: &Compressed, buffers: &[Vec<u8>], spent: usize) -> Check<Vec<u8>> {
    let buffer = at(e.buffer, "buffer", buffers.len())?;
    let data = buffers[buffer]
        .get(e.byte_offset..e.byte_offset.saturating_add(e.byte_length))
        .ok_or_else(|| format!("its bytes pass the end of buffer {buffer}"))?;
    let (count, stride) = (e.count, e.byte_stride);
    let total = count.saturating_mul(stride).saturating_add(spent);
    // The codec never packs more than 256 elements of 256 bytes into less than a byte each.
    if total > DECODED_LIMIT || count / 256 > data.len() {
        return Err(format!("{count} elements of {stride} bytes are too many"));
    }
    let damaged = |e: meshopt::Error| format!("the data is damaged: {e}");
    match (e.mode.as_str(), stride) {
        ("ATTRIBUTES", _) => {
            let mut bytes = attributes(data, count, stride)?;
            filter(&mut bytes, e.filter.as_deref().unwrap_or("NONE"), stride)?;
            Ok(bytes)
        }
        ("TRIANGLES", 2) if count % 3 == 0 => {
            let list = decode_index_buffer::<u16>(data, count).map_err(damaged)?;
            Ok(bytemuck::cast_slice(&list).to_vec())
        }
        ("TRIANGLES", 4) if count % 3 == 0 => {
            let list = decode_index_buffer::<u32>(data, count).map_err(damaged)?;
            Ok(bytemuck::cast_slice(&list).to_vec())
        }
        ("INDICES", 2) => {
            let list = decode_index_sequence::<u16>(data, count).map_err(damaged)?;
            Ok(bytemuck::cast_slice(&list).to_vec())
        }
        ("INDICES", 4) => {
            let list = decode_index_sequence::<u32>(data, count).map_err(damaged)?;
            Ok(bytemuck::cast_slice(&list).to_vec())
        }
        (mode, _) => Err(format!(
            "mode {mode} with {count} elements of {stride} bytes"
        )),
    }
}

/// One element of `N` bytes.
#[derive(Clone, Copy)]
struct Bytes<const N: usize>([u8; N]);

impl<const N: usize> Default for Bytes<N> {
    fn default() -> Self {
        Self([0; N])
    }
}

fn attributes(data: &[u8], count: usize, stride: usize) -> Check<Vec<u8>> {
    fn sized<const N: usize>(data: &[u8], count: usize) -> Check<Vec<u8>> {
        let list = decode_vertex_buffer::<Bytes<N>>(data, count)
            .map_err(|e| format!("the data is damaged: {e}"))?;
        Ok(list.iter().flat_map(|b| b.0).collect())
    }
    // The element size is a compile-time fact of the codec's safe interface; vertices wider
    // than 64 bytes do not occur in plants.
    match stride {
        4 => sized::<4>(data, count),
        8 => sized::<8>(data, count),
        12 => sized::<12>(data, count),
        16 => sized::<16>(data, count),
        20 => sized::<20>(data, count),
        24 => sized::<24>(data, count),
        28 => sized::<28>(data, count),
        32 => sized::<32>(data, count),
        36 => sized::<36>(data, count),
        40 => sized::<40>(data, count),
        44 => sized::<44>(data, count),
        48 => sized::<48>(data, count),
        52 => sized::<52>(data, count),
        56 => sized::<56>(data, count),
        60 => sized::<60>(data, count),
        64 => sized::<64>(data, count),
        _ => Err(format!(
            "byteStride {stride} is not a multiple of 4 up to 64"
        )),
    }
}

fn filter(bytes: &mut [u8], name: &str, stride: usize) -> Check<()> {
    match (name, stride) {
        ("NONE", _) => {}
        ("OCTAHEDRAL", 4) => {
            let mut v: Vec<[i8; 4]> = bytemuck::pod_collect_to_vec(bytes);
            decode_filter_oct(&mut v);
            bytes.copy_from_slice(bytemuck::cast_slice(&v));
        }
        ("OCTAHEDRAL", 8) => {
            let mut v: Vec<[i16; 4]> = bytemuck::pod_collect_to_vec(bytes);
            decode_filter_oct(&mut v);
            bytes.copy_from_slice(bytemuck::cast_slice(&v));
        }
        ("QUATERNION", 8) => {
            let mut v: Vec<[i16; 4]> = bytemuck::pod_collect_to_vec(bytes);
            decode_filter_quat(&mut v);
            bytes.copy_from_slice(bytemuck::cast_slice(&v));
        }
        ("EXPONENTIAL", s) if s % 4 == 0 => {
            let mut v: Vec<[u32; 1]> = bytemuck::pod_collect_to_vec(bytes);
            decode_filter_exp(&mut v);
            bytes.copy_from_slice(bytemuck::cast_slice(&v));
        }
        _ => return Err(format!("filter {name} with byteStride {stride}")),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_encoder_packs_comes_back() {
        let vertices: Vec<[f32; 3]> = (0..100u8).map(|i| [f32::from(i), 1.0, -2.0]).collect();
        let indices: Vec<u32> = (0..98).flat_map(|i| [i, i + 1, i + 2]).collect();
        let packed = [
            meshopt::encode_vertex_buffer(&vertices).unwrap(),
            meshopt::encode_index_buffer(&indices, 100).unwrap(),
        ];
        let mut buffers = packed.to_vec();
        let view = |i: usize, mode: &str, count: usize, stride: usize| {
            json!({"buffer": 2, "byteLength": count * stride, "extensions": {NAME: {
                "buffer": i, "byteLength": packed[i].len(), "byteStride": stride,
                "mode": mode, "count": count}}})
        };
        buffers.push(vec![]);
        let mut json = json!({
            "extensionsUsed": [NAME], "extensionsRequired": [NAME],
            "buffers": [{}, {}, {"byteLength": 9, "extensions": {NAME: {"fallback": true}}}],
            "bufferViews": [view(0, "ATTRIBUTES", 100, 12), view(1, "TRIANGLES", 294, 4)]
        });
        let mut damaged = (json.clone(), buffers.clone());
        expand(&mut json, &mut buffers).unwrap();
        assert!(
            json.get("extensionsRequired").is_none()
                && json["bufferViews"][0].get("extensions").is_none()
        );
        assert_eq!(
            &buffers[3][..1200],
            bytemuck::cast_slice::<_, u8>(&vertices)
        );
        // The codec may begin a triangle at another corner.
        let triangles = |list: &[u32]| -> Vec<Vec<u32>> {
            let sorted = |t: &[u32]| {
                let mut t = t.to_vec();
                t.sort_unstable();
                t
            };
            list.chunks(3).map(sorted).collect()
        };
        let back: Vec<u32> = bytemuck::pod_collect_to_vec(&buffers[3][1200..]);
        assert_eq!(triangles(&back), triangles(&indices));
        damaged.1[0].truncate(20);
        let e = expand(&mut damaged.0, &mut damaged.1).unwrap_err();
        assert!(e.contains("bufferView 0"), "{e}");
    }
}
