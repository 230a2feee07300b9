//! Numbers of a document that its typed form would take wrongly or not at all.
//!
//! [`gltf::json`] keeps the low 32 bits of an index and turns a float that is too large for f32
//! into infinity; and it does not take `3.0` for 3, which some writers say. So the JSON is gone
//! through once, before anything is read from it.

use serde_json::Value;

use super::json::{Check, Of, label};
use crate::scene::extensions::{Support, support};

/// Lists of objects that are read, and what one of them is called.
const LISTS: &[(&str, &str)] = &[
    ("accessors", "accessor"),
    ("buffers", "buffer"),
    ("bufferViews", "bufferView"),
    ("images", "image"),
    ("materials", "material"),
    ("meshes", "mesh"),
    ("nodes", "node"),
    ("samplers", "sampler"),
    ("scenes", "scene"),
    ("textures", "texture"),
];
/// Members that are indices or codes: 32 bits.
const WORDS: &[&str] = &[
    "attributes",
    "buffer",
    "bufferView",
    "children",
    "componentType",
    "index",
    "indices",
    "light",
    "magFilter",
    "material",
    "mesh",
    "minFilter",
    "mode",
    "nodes",
    "sampler",
    "scene",
    "skin",
    "source",
    "targets",
    "texCoord",
    "wrapS",
    "wrapT",
];
/// Members that are sizes: 64 bits.
const SIZES: &[&str] = &["byteLength", "byteOffset", "byteStride", "count"];
/// Members that are kept and not read. Bounds may be anything: accessors are measured.
const UNREAD: &[&str] = &["extras", "max", "min"];

/// Makes whole numbers of `json` integers and refuses those that do not fit.
pub(super) fn check(json: &mut Value) -> Check<()> {
    for &(list, kind) in LISTS {
        let objects = json.get_mut(list).and_then(Value::as_array_mut);
        for (i, object) in objects.into_iter().flatten().enumerate() {
            let checked = walk(object, "");
            checked.of(|| label(kind, i, object))?;
        }
    }
    for root in ["scene", "extensions"] {
        json.get_mut(root).map_or(Ok(()), |v| walk(v, root))?;
    }
    Ok(())
}

fn walk(v: &mut Value, key: &str) -> Check<()> {
    match v {
        Value::Object(members) => {
            for (k, member) in members {
                let foreign = key == "extensions" && support(k) != Some(Support::Full);
                if !foreign && !UNREAD.contains(&k.as_str()) {
                    // Attributes have names of their own.
                    let inherited = matches!(key, "attributes" | "targets");
                    walk(member, if inherited { key } else { k })?;
                }
            }
            Ok(())
        }
        Value::Array(list) => list.iter_mut().try_for_each(|member| walk(member, key)),
        Value::Number(_) => number(v, key),
        _ => Ok(()),
    }
}

fn number(v: &mut Value, key: &str) -> Check<()> {
    /// From here up not every whole number is an f64.
    const EXACT: f64 = 9_007_199_254_740_992.0;
    let word = WORDS.contains(&key);
    if !word && !SIZES.contains(&key) {
        let fits = v.as_f64().is_some_and(|f| (f as f32).is_finite());
        return if fits {
            Ok(())
        } else {
            Err(format!("\"{key}\" is {v}, not a number in range"))
        };
    }
    if let Some(whole) = v
        .as_f64()
        .filter(|f| f.fract() == 0.0 && (0.0..EXACT).contains(f))
        && !v.is_u64()
    {
        *v = Value::from(whole as u64);
    }
    let limit = if word { u64::from(u32::MAX) } else { u64::MAX };
    match v.as_u64() {
        // The crate marks a missing image by the last word.
        Some(n) if n < limit || !word => Ok(()),
        _ => Err(format!(
            "\"{key}\" is {v}, not a whole number from 0 up to {limit}"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn whole_numbers_become_integers_and_others_are_named() {
        let mut doc = json!({
            "scene": 0.0,
            "nodes": [{"mesh": 2.0, "scale": [1.0, 2, 1e30], "extras": {"mesh": 2.0}}],
            "meshes": [{"primitives": [{"attributes": {"_WIND": 1.0}, "targets": [{"NORMAL": 3.0}]}]}],
            "accessors": [{"count": 7.0, "min": [1e300]}]
        });
        check(&mut doc).unwrap();
        assert_eq!(
            doc,
            json!({
                "scene": 0,
                "nodes": [{"mesh": 2, "scale": [1.0, 2, 1e30], "extras": {"mesh": 2.0}}],
                "meshes": [{"primitives": [{"attributes": {"_WIND": 1}, "targets": [{"NORMAL": 3}]}]}],
                "accessors": [{"count": 7, "min": [1e300]}]
            })
        );
        for (bad, message) in [
            // Its low 32 bits are 0.
            (
                json!({"mesh": 1u64 << 32}),
                "node 0: \"mesh\" is 4294967296, not a whole",
            ),
            (json!({"mesh": 0.5}), "\"mesh\" is 0.5, not a whole"),
            (json!({"mesh": -1}), "\"mesh\" is -1, not a whole"),
            (
                json!({"name": "far", "translation": [1e39, 0, 0]}),
                "node 0 \"far\": \"translation\" is 1e+39, not a number in range",
            ),
        ] {
            let e = check(&mut json!({"nodes": [bad]})).unwrap_err();
            assert!(e.contains(message), "{e}");
        }
    }
}
