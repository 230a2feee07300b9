//! The outer shell of a glTF file: GLB chunks, JSON, and where buffer bytes come from.

use std::ops::Range;
use std::path::Path;

use base64::Engine as _;
use serde_json::Value;

use super::json::{Check, Of, array, extension, label, required, text};

const GLB_MAGIC: &[u8; 4] = b"glTF";
const CHUNK_JSON: u32 = 0x4E4F_534A;
const CHUNK_BIN: u32 = 0x004E_4942;

/// Whether the bytes begin like a GLB.
pub(super) fn is_glb(bytes: &[u8]) -> bool {
    bytes.starts_with(GLB_MAGIC)
}

/// Whether the bytes begin like JSON (white space and a byte order mark are skipped).
pub(super) fn is_json(bytes: &[u8]) -> bool {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    bytes.iter().find(|b| !b.is_ascii_whitespace()) == Some(&b'{')
}

/// JSON and, for a GLB, the range of its binary chunk.
pub(super) fn parse(bytes: &[u8]) -> Check<(Value, Option<Range<usize>>)> {
    let (json_bytes, bin) = if is_glb(bytes) {
        let (json, bin) = chunks(bytes)?;
        (&bytes[json], bin)
    } else {
        (bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes), None)
    };
    let json: Value =
        serde_json::from_slice(json_bytes).map_err(|e| format!("the JSON is damaged: {e}"))?;
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

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(four.try_into().ok()?))
}

/// Ranges of the JSON and BIN chunks.
fn chunks(bytes: &[u8]) -> Check<(Range<usize>, Option<Range<usize>>)> {
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return Err("truncated GLB: the header needs 12 bytes".into());
    };
    if version != 2 {
        return Err(format!(
            "GLB container version {version} is not supported, only 2"
        ));
    }
    let length = length as usize;
    if length > bytes.len() {
        return Err(format!(
            "truncated GLB: the header says {length} bytes, the file has {}",
            bytes.len()
        ));
    }
    let mut json = None;
    let mut bin = None;
    let mut at = 12;
    while at < length {
        let (Some(size), Some(kind)) = (word(bytes, at), word(bytes, at + 4)) else {
            return Err(format!("truncated GLB: no chunk header at byte {at}"));
        };
        let start = at + 8;
        let end = start
            .checked_add(size as usize)
            .filter(|&end| end <= length)
            .ok_or_else(|| {
                format!("truncated GLB: the chunk at byte {at} of {size} bytes passes the end")
            })?;
        match kind {
            CHUNK_JSON if json.is_none() => json = Some(start..end),
            CHUNK_BIN if bin.is_none() => bin = Some(start..end),
            _ => {} // The specification asks readers to skip chunks they do not know.
        }
        at = end;
    }
    Ok((json.ok_or("the GLB has no JSON chunk")?, bin))
}

/// Contents of all buffers. A buffer that only stands in for compressed views stays empty.
pub(super) fn buffers(json: &Value, bin: Option<&[u8]>, folder: &Path) -> Check<Vec<Vec<u8>>> {
    let mut out = Vec::new();
    for (i, buffer) in array(json, "buffers")?.iter().enumerate() {
        out.push(buffer_bytes(i, buffer, bin, folder).of(|| label("buffer", i, buffer))?);
    }
    Ok(out)
}

fn buffer_bytes(i: usize, buffer: &Value, bin: Option<&[u8]>, folder: &Path) -> Check<Vec<u8>> {
    let length = required(buffer, "byteLength")?;
    let mut bytes = match (text(buffer, "uri")?, bin) {
        (Some(uri), _) => uri_bytes(uri, folder)?.0,
        (None, Some(bin)) if i == 0 => bin.to_vec(),
        (None, _) if extension(buffer, "EXT_meshopt_compression").is_some() => return Ok(vec![]),
        (None, _) => return Err("has no uri, and the file has no binary chunk for it".into()),
    };
    if bytes.len() < length {
        return Err(format!("needs {length} bytes, there are {}", bytes.len()));
    }
    bytes.truncate(length);
    Ok(bytes)
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
        glb.extend(CHUNK_JSON.to_le_bytes());
        glb.extend(json);
        parse(&glb).unwrap();
        for n in 4..glb.len() {
            let e = parse(&glb[..n]).unwrap_err();
            assert!(e.contains("truncated"), "{n}: {e}");
        }
    }
}
