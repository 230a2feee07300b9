//! From a glTF's JSON to the types of [`gltf::json`]: every wrong type or range becomes a sentence.
//!
//! Errors are plain sentences (`String`); each caller puts the object's name in front, and
//! [`super::load`] puts the file in front of all.

use gltf::json::Index;
use gltf::json::validation::Checked;
use serde::Deserialize;
use serde_json::Value;

/// Result whose error is a sentence about the object at hand.
pub(in crate::scene) type Check<T> = Result<T, String>;

/// Puts the name of an object in front of an error.
pub(in crate::scene) trait Of<T> {
    /// `what()` is only called on failure.
    fn of(self, what: impl FnOnce() -> String) -> Check<T>;
}

impl<T> Of<T> for Check<T> {
    fn of(self, what: impl FnOnce() -> String) -> Self {
        self.map_err(|e| format!("{}: {e}", what()))
    }
}

/// Elements of the array `key`; none when it is absent.
pub(in crate::scene) fn array<'a>(v: &'a Value, key: &str) -> Check<&'a [Value]> {
    match v.get(key) {
        None => Ok(&[]),
        Some(Value::Array(a)) => Ok(a),
        Some(_) => Err(format!("\"{key}\" is not an array")),
    }
}

/// `v` as a type of the `gltf` crate or one of our own; errors name the member.
pub(in crate::scene) fn typed<'a, T: Deserialize<'a>>(v: &'a Value) -> Check<T> {
    serde_path_to_error::deserialize(v).map_err(|e| match e.path().to_string().as_str() {
        "." => e.inner().to_string(),
        path => format!("\"{path}\": {}", e.inner()),
    })
}

/// The objects of the array `key` of a document, each with its JSON. `kind` names one in
/// messages. They are read one by one, and only the lists that are needed: what umbrage keeps
/// without reading it (animations, cameras) cannot make a file unreadable.
pub(in crate::scene) fn list<'a, T: Deserialize<'a>>(
    json: &'a Value,
    key: &str,
    kind: &str,
) -> Check<Vec<(T, &'a Value)>> {
    let one = |(i, v)| Ok((typed(v).of(|| label(kind, i, v))?, v));
    array(json, key)?.iter().enumerate().map(one).collect()
}

/// An index that must be below `len`.
pub(in crate::scene) fn at<T>(index: Index<T>, key: &str, len: usize) -> Check<usize> {
    let i = index.value();
    if i < len {
        Ok(i)
    } else {
        Err(format!("\"{key}\" is {i}, but there are {len}"))
    }
}

/// A value of an enumeration; `v` is the object it stands in, for the message.
pub(in crate::scene) fn known<T: Copy>(value: Checked<T>, v: &Value, key: &str) -> Check<T> {
    match value {
        Checked::Valid(value) => Ok(value),
        Checked::Invalid => Err(format!("{key} {} does not exist", v[key])),
    }
}

/// A non-negative integer; [`super::numbers::check`] has seen the document.
pub(in crate::scene) fn integer(v: &Value, key: &str) -> Option<usize> {
    v.get(key)?.as_u64()?.try_into().ok()
}

/// The object of an extension on `v`.
pub(in crate::scene) fn extension<'a>(v: &'a Value, name: &str) -> Option<&'a Value> {
    v.get("extensions").and_then(|e| e.get(name))
}

/// How an object is called in messages: `mesh 3 "leaves"`.
pub(in crate::scene) fn label(kind: &str, index: usize, v: &Value) -> String {
    match v.get("name").and_then(Value::as_str) {
        Some(name) if !name.is_empty() => format!("{kind} {index} \"{name}\""),
        _ => format!("{kind} {index}"),
    }
}

/// The object's own name, or `mesh 3`.
pub(in crate::scene) fn name(kind: &str, index: usize, v: &Value) -> String {
    match v.get("name").and_then(Value::as_str) {
        Some(name) if !name.is_empty() => name.to_owned(),
        _ => format!("{kind} {index}"),
    }
}
