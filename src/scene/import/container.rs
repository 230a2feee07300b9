//! The outer shell of a glTF file: GLB chunks, JSON, and where buffer bytes come from.

use std::borrow::Cow;
use std::path::Path;

use base64::Engine as _;
use gltf::binary::{Error, Glb};
use gltf::json::Buffer;
use serde_json::Value;

use super::json::{Check, Of, extension, label, list};

const GLB_MAGIC: &[u8; 4] = b"glTF";

/// Whether the bytes begin like a GLB.
pub(super) fn is_glb(bytes: &[u8]) -> bool {
    bytes.starts_with(GLB_MAGIC)
}

/// Whether the bytes begin like JSON (white space and a byte order mark are skipped).
pub(super) fn is_json(bytes: &[u8]) -> bool {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    bytes.iter().find(|b| !b.is_ascii_whitespace()) == Some(&b'{')
}

/// JSON and, for a GLB with one, the binary chunk.
pub(super) fn parse(bytes: &[u8]) -> Check<(Value, Option<Cow<'_, [u8]>>)> {
    let (json_bytes, bin) = if is_glb(bytes) {
        let glb = chunks(bytes)?;
        (glb.json, glb.bin)
    } else {
        let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        (Cow::Borrowed(text), None)
    };
    let json: Value =
        serde_json::from_slice(&json_bytes).map_err(|e| format!("the JSON is damaged: {e}"))?;
    let version = json
        .get("asset")
        .and_then(|a| a.get("version"))
        .and_then(Value::as_str)
        .ok_or("not a glTF: there is no asset.version")?;
    if !version.starts_with("2.") {
        return Err(format!("glTF version {version} is not supported, only 2.0"));
    }
    Ok((json, bin))
}

/// Splits a GLB. The crate takes the length in the header as it is and subtracts from it, so it
/// only sees headers that hold.
fn chunks(bytes: &[u8]) -> Check<Glb<'_>> {
    let word = |at: usize| Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?));
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err("truncated GLB: the header needs 12 bytes".into());
    };
    if version != 2 {
        return Err(format!(
            "GLB container version {version} is not supported, only 2"
        ));
    }
    let whole = bytes.get(..length as usize).ok_or_else(|| {
        let have = bytes.len();
        format!("truncated GLB: the header says {length} bytes, the file has {have}")
    })?;
    if whole.len() < 20 {
        return Err("the GLB has no JSON chunk".into());
    }
    Glb::from_slice(whole).map_err(|e| match e {
        gltf::Error::Binary(Error::ChunkLength {
            ty,
            length,
            length_read,
        }) => format!(
            "truncated GLB: its {ty:?} chunk has {length} bytes, and {length_read} are left"
        ),
        gltf::Error::Binary(Error::Io(_)) => "truncated GLB: half a chunk header".into(),
        other => format!("the GLB is damaged: {other}"),
    })
}

/// Contents of all buffers. A buffer that only stands in for compressed views stays empty.
pub(super) fn buffers(json: &Value, bin: Option<&[u8]>, folder: &Path) -> Check<Vec<Vec<u8>>> {
    let mut out = Vec::new();
    for (i, (buffer, v)) in list::<Buffer>(json, "buffers", "buffer")?
        .iter()
        .enumerate()
    {
        let stands_in = extension(v, "EXT_meshopt_compression").is_some();
        let bytes = match (&buffer.uri, bin) {
            (Some(uri), _) => uri_bytes(uri, folder).map(|read| read.0),
            (None, Some(bin)) if i == 0 => Ok(bin.to_vec()),
            (None, _) if stands_in => {
                out.push(vec![]);
                continue;
            }
            (None, _) => Err("has no uri, and the file has no binary chunk for it".into()),
        };
        let bytes = bytes.and_then(|bytes| cut(bytes, buffer.byte_length.0));
        out.push(bytes.of(|| label("buffer", i, v))?);
    }
    Ok(out)
}

fn cut(mut bytes: Vec<u8>, length: u64) -> Check<Vec<u8>> {
    match usize::try_from(length) {
        Ok(length) if length <= bytes.len() => {
            bytes.truncate(length);
            Ok(bytes)
        }
        _ => Err(format!("needs {length} bytes, there are {}", bytes.len())),
    }
}

/// Bytes behind a URI (data URI or a file beside the model), and the media type if the URI
/// tells it.
pub(super) fn uri_bytes(uri: &str, folder: &Path) -> Check<(Vec<u8>, Option<String>)> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (head, body) = data.split_once(',').ok_or("the data URI has no comma")?;
        let media = head.split(';').next().unwrap_or_default();
        if !head.ends_with(";base64") {
            return Err("the data URI is not base64".into());
        }
        let engine = base64::engine::GeneralPurpose::new(
            &base64::alphabet::STANDARD,
            base64::engine::GeneralPurposeConfig::new()
                .with_decode_padding_mode(base64::engine::DecodePaddingMode::Indifferent),
        );
        let bytes = engine
            .decode(body.trim_end())
            .map_err(|e| format!("the data URI is damaged: {e}"))?;
        return Ok((bytes, Some(media.to_owned())));
    }
    if uri.contains("://") {
        return Err(format!("{uri}: only files beside the model are read"));
    }
    let path = folder.join(percent_decode(uri));
    let bytes = std::fs::read(&path).map_err(|e| format!("cannot read {}: {e}", path.display()))?;
    Ok((bytes, None))
}

fn percent_decode(uri: &str) -> String {
    let b = uri.as_bytes();
    let mut out = Vec::with_capacity(b.len());
    let mut i = 0;
    while i < b.len() {
        let digits = b.get(i + 1..i + 3).filter(|_| b[i] == b'%');
        let hex = digits
            .and_then(|d| std::str::from_utf8(d).ok())
            .and_then(|d| u8::from_str_radix(d, 16).ok());
        out.push(hex.unwrap_or(b[i]));
        i += if hex.is_some() { 3 } else { 1 };
    }
    String::from_utf8_lossy(&out).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percent_signs_are_decoded_and_stray_ones_kept() {
        assert_eq!(percent_decode("a%20b%2Fc%zz%4"), "a b/c%zz%4");
    }

    #[test]
    fn data_uris_may_leave_out_the_padding() {
        let here = Path::new(".");
        let (bytes, media) = uri_bytes("data:image/png;base64,AQID", here).unwrap();
        assert_eq!(
            (bytes.as_slice(), media.as_deref()),
            (&[1, 2, 3][..], Some("image/png"))
        );
        assert_eq!(uri_bytes("data:;base64,AQ", here).unwrap().0, [1]);
        assert!(
            uri_bytes("data:text/plain,AQ", here)
                .unwrap_err()
                .contains("base64")
        );
        assert!(
            uri_bytes("https://x/y.bin", here)
                .unwrap_err()
                .contains("beside")
        );
    }

    #[test]
    fn every_truncation_of_a_glb_is_named() {
        let mut glb = b"glTF\x02\0\0\0".to_vec();
        let json = br#"{"asset":{"version":"2.0"}}  "#;
        glb.extend(u32::try_from(20 + json.len()).unwrap().to_le_bytes());
        glb.extend(u32::try_from(json.len()).unwrap().to_le_bytes());
        glb.extend(b"JSON");
        glb.extend(json);
        parse(&glb).unwrap();
        for n in 4..glb.len() {
            let e = parse(&glb[..n]).unwrap_err();
            assert!(e.contains("truncated"), "{n}: {e}");
        }
    }
}
