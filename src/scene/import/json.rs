//! Reading members of a glTF's JSON with checks: every wrong type or range becomes a sentence.
//!
//! Errors are plain sentences (`String`); each caller puts the object's name in front, and
//! [`super::load`] puts the file in front of all.

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

/// A non-negative integer.
pub(in crate::scene) fn integer(v: &Value, key: &str) -> Check<Option<usize>> {
    v.get(key).map(|n| as_integer(n, key)).transpose()
}

/// A non-negative integer that must be there.
pub(in crate::scene) fn required(v: &Value, key: &str) -> Check<usize> {
    integer(v, key)?.ok_or_else(|| format!("\"{key}\" is missing"))
}

/// `n` as a non-negative integer (some writers say `3.0`).
pub(in crate::scene) fn as_integer(n: &Value, key: &str) -> Check<usize> {
    const EXACT: f64 = 9_007_199_254_740_992.0;
    let whole = n.as_u64().or_else(|| {
        n.as_f64()
            .filter(|f| f.fract() == 0.0 && (0.0..EXACT).contains(f))
            .map(|f| f as u64)
    });
    whole
        .and_then(|u| usize::try_from(u).ok())
        .ok_or_else(|| format!("\"{key}\" is {n}, not a whole number from 0 up"))
}

/// An index that must be below `len`.
pub(in crate::scene) fn index(v: &Value, key: &str, len: usize) -> Check<Option<usize>> {
    v.get(key).map(|n| as_index(n, key, len)).transpose()
}

/// `n` as an index below `len`.
pub(in crate::scene) fn as_index(n: &Value, key: &str, len: usize) -> Check<usize> {
    let i = as_integer(n, key)?;
    if i < len {
        Ok(i)
    } else {
        Err(format!("\"{key}\" is {i}, but there are {len}"))
    }
}

/// A finite number, also finite as f32.
pub(in crate::scene) fn number(v: &Value, key: &str) -> Check<Option<f64>> {
    v.get(key).map(|n| as_number(n, key)).transpose()
}

fn as_number(n: &Value, key: &str) -> Check<f64> {
    n.as_f64()
        .filter(|f| (*f as f32).is_finite())
        .ok_or_else(|| format!("\"{key}\" is {n}, not a number in range"))
}

/// `N` finite numbers.
pub(in crate::scene) fn numbers<const N: usize>(v: &Value, key: &str) -> Check<Option<[f64; N]>> {
    let Some(list) = v.get(key) else {
        return Ok(None);
    };
    let list = list
        .as_array()
        .filter(|a| a.len() == N)
        .ok_or_else(|| format!("\"{key}\" is not a list of {N} numbers"))?;
    let mut out = [0.0; N];
    for (o, n) in out.iter_mut().zip(list) {
        *o = as_number(n, key)?;
    }
    Ok(Some(out))
}

/// A string.
pub(in crate::scene) fn text<'a>(v: &'a Value, key: &str) -> Check<Option<&'a str>> {
    match v.get(key) {
        None => Ok(None),
        Some(Value::String(s)) => Ok(Some(s)),
        Some(_) => Err(format!("\"{key}\" is not a string")),
    }
}

/// A boolean; false when absent.
pub(in crate::scene) fn flag(v: &Value, key: &str) -> Check<bool> {
    match v.get(key) {
        None => Ok(false),
        Some(Value::Bool(b)) => Ok(*b),
        Some(_) => Err(format!("\"{key}\" is not true or false")),
    }
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
