//! Accessors: typed views of buffers, with bounds checked before anything is read.

use std::cell::Cell;

use serde_json::Value;

use super::json::{Check, Of, array, as_index, flag, index, integer, required, text};

/// Most bytes one file may decode to; a damaged or hostile file cannot ask for more.
const DECODED_LIMIT: usize = 4 << 30;
/// Most elements of an accessor that has no buffer behind it (all zero but for sparse entries).
const UNBACKED_LIMIT: usize = 1 << 22;

/// The parts of a document that accessors need.
#[derive(Debug)]
pub(in crate::scene) struct Source<'a> {
    accessors: &'a [Value],
    views: &'a [Value],
    buffers: &'a [Vec<u8>],
    decoded: Cell<usize>,
}

/// Where the elements of an accessor lie; bounds are already checked.
#[derive(Debug, Clone, Copy)]
pub(in crate::scene) struct Layout {
    /// Buffer index; `None` means all zero.
    pub(in crate::scene) buffer: Option<usize>,
    /// First byte in the buffer.
    pub(in crate::scene) start: usize,
    /// Bytes from one element to the next.
    pub(in crate::scene) stride: usize,
    /// Number of elements.
    pub(in crate::scene) count: usize,
    /// Components per element.
    pub(in crate::scene) width: usize,
    /// Component type.
    pub(in crate::scene) component: Component,
    /// Integers stand for \[0,1\] or \[-1,1\].
    pub(in crate::scene) normalized: bool,
}

/// `componentType`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::scene) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn new(code: usize) -> Check<Self> {
        Ok(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return Err(format!("componentType {code} does not exist")),
        })
    }

    /// Size in bytes.
    pub(in crate::scene) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// Value at the start of `b` as a float (glTF 2.0, 3.6.2.2: normalised integers).
    fn float(self, b: &[u8], normalized: bool) -> f32 {
        let scale = |v: f32, max: f32| if normalized { (v / max).max(-1.0) } else { v };
        match self {
            Self::I8 => scale(f32::from(i8::from_le_bytes([b[0]])), 127.0),
            Self::U8 => scale(f32::from(b[0]), 255.0),
            Self::I16 => scale(f32::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
            Self::U16 => scale(f32::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
            Self::U32 => scale(
                u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f32,
                u32::MAX as f32,
            ),
            Self::F32 => f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        }
    }

    fn unsigned(self, b: &[u8]) -> Check<u32> {
        match self {
            Self::U8 => Ok(u32::from(b[0])),
            Self::U16 => Ok(u32::from(u16::from_le_bytes([b[0], b[1]]))),
            Self::U32 => Ok(u32::from_le_bytes([b[0], b[1], b[2], b[3]])),
            _ => Err("indices must be unsigned integers".into()),
        }
    }
}

impl<'a> Source<'a> {
    /// Reads the lists of `json`.
    pub(in crate::scene) fn new(json: &'a Value, buffers: &'a [Vec<u8>]) -> Check<Self> {
        Ok(Self {
            accessors: array(json, "accessors")?,
            views: array(json, "bufferViews")?,
            buffers,
            decoded: Cell::new(0),
        })
    }

    /// Number of accessors.
    pub(in crate::scene) fn len(&self) -> usize {
        self.accessors.len()
    }

    /// Buffer, first byte, length and stride of a view.
    fn view(&self, i: usize) -> Check<(usize, usize, usize, Option<usize>)> {
        let read = || {
            let view = &self.views[i];
            let buffer =
                index(view, "buffer", self.buffers.len())?.ok_or("\"buffer\" is missing")?;
            let start = integer(view, "byteOffset")?.unwrap_or(0);
            let length = required(view, "byteLength")?;
            let have = self.buffers[buffer].len();
            if start.checked_add(length).is_none_or(|end| end > have) {
                return Err(format!(
                    "bytes {start} + {length} pass the end of buffer {buffer} ({have} bytes)"
                ));
            }
            Ok((buffer, start, length, integer(view, "byteStride")?))
        };
        read().of(|| format!("bufferView {i}"))
    }

    /// The bytes of a view.
    pub(in crate::scene) fn view_bytes(&self, i: usize) -> Check<&'a [u8]> {
        let (buffer, start, length, _) = self.view(i)?;
        Ok(&self.buffers[buffer][start..start + length])
    }

    /// Number of views.
    pub(in crate::scene) fn view_count(&self) -> usize {
        self.views.len()
    }

    /// Where accessor `i` lies.
    pub(in crate::scene) fn layout(&self, i: usize) -> Check<Layout> {
        self.layout_of(&self.accessors[i])
            .of(|| format!("accessor {i}"))
    }

    fn layout_of(&self, accessor: &Value) -> Check<Layout> {
        let component = Component::new(required(accessor, "componentType")?)?;
        let width = match text(accessor, "type")?.ok_or("\"type\" is missing")? {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" | "MAT2" => 4,
            "MAT3" => 9,
            "MAT4" => 16,
            other => return Err(format!("type {other} does not exist")),
        };
        let layout = Layout {
            buffer: None,
            start: 0,
            stride: width * component.size(),
            count: required(accessor, "count")?,
            width,
            component,
            normalized: flag(accessor, "normalized")?,
        };
        let Some(view) = index(accessor, "bufferView", self.views.len())? else {
            if layout.count > UNBACKED_LIMIT {
                return Err(format!("{} elements without a bufferView", layout.count));
            }
            return Ok(layout);
        };
        let offset = integer(accessor, "byteOffset")?.unwrap_or(0);
        self.place(layout, view, offset)
    }

    /// Puts `layout` at `offset` in a view and checks that it stays inside.
    fn place(&self, mut layout: Layout, view: usize, offset: usize) -> Check<Layout> {
        let (buffer, start, length, stride) = self.view(view)?;
        let element = layout.width * layout.component.size();
        if let Some(stride) = stride {
            if stride < element {
                return Err(format!(
                    "byteStride {stride} is below the element's {element} bytes"
                ));
            }
            layout.stride = stride;
        }
        let end = match layout.count {
            0 => Some(offset),
            n => (n - 1)
                .checked_mul(layout.stride)
                .and_then(|b| b.checked_add(offset)?.checked_add(element)),
        };
        if end.is_none_or(|end| end > length) {
            return Err(format!(
                "{} elements from byte {offset} on pass the end of bufferView {view} ({length} bytes)",
                layout.count
            ));
        }
        layout.buffer = Some(buffer);
        layout.start = start + offset;
        Ok(layout)
    }

    fn spend(&self, bytes: usize) -> Check<()> {
        let total = self.decoded.get().saturating_add(bytes);
        self.decoded.set(total);
        if total > DECODED_LIMIT {
            return Err(format!(
                "the file decodes to more than {} GiB",
                DECODED_LIMIT >> 30
            ));
        }
        Ok(())
    }

    /// Elements of `N` floats; integers are converted, sparse entries applied.
    pub(in crate::scene) fn vectors<const N: usize>(&self, i: usize) -> Check<Vec<[f32; N]>> {
        self.read_vectors(i).of(|| format!("accessor {i}"))
    }

    fn read_vectors<const N: usize>(&self, i: usize) -> Check<Vec<[f32; N]>> {
        let accessor = &self.accessors[i];
        let layout = self.layout_of(accessor)?;
        if layout.width != N {
            return Err(format!("has {} components, not {N}", layout.width));
        }
        self.spend(layout.count.saturating_mul(4 * N))?;
        let mut out = vec![[0.0; N]; layout.count];
        let size = layout.component.size();
        let element = |bytes: &[u8]| {
            std::array::from_fn(|c| {
                layout
                    .component
                    .float(&bytes[c * size..], layout.normalized)
            })
        };
        self.elements(&layout, |k, bytes| {
            out[k] = element(bytes);
            Ok(())
        })?;
        self.sparse(accessor, &layout, |k, bytes| {
            out[k] = element(bytes);
            Ok(())
        })?;
        Ok(out)
    }

    /// Unsigned scalars.
    pub(in crate::scene) fn indices(&self, i: usize) -> Check<Vec<u32>> {
        let read = || {
            let accessor = &self.accessors[i];
            let layout = self.layout_of(accessor)?;
            if layout.width != 1 {
                return Err("indices must be SCALAR".into());
            }
            self.spend(layout.count.saturating_mul(4))?;
            let mut out = vec![0; layout.count];
            let mut set = |k: usize, bytes: &[u8]| {
                out[k] = layout.component.unsigned(bytes)?;
                Ok(())
            };
            self.elements(&layout, &mut set)?;
            self.sparse(accessor, &layout, &mut set)?;
            Ok(out)
        };
        read().of(|| format!("accessor {i}"))
    }

    fn elements(
        &self,
        layout: &Layout,
        mut set: impl FnMut(usize, &[u8]) -> Check<()>,
    ) -> Check<()> {
        let Some(buffer) = layout.buffer else {
            return Ok(());
        };
        let element = layout.width * layout.component.size();
        for k in 0..layout.count {
            let at = layout.start + k * layout.stride;
            set(k, &self.buffers[buffer][at..at + element])?;
        }
        Ok(())
    }

    /// Calls `set` for the entries of a sparse accessor.
    fn sparse(
        &self,
        accessor: &Value,
        layout: &Layout,
        set: impl FnMut(usize, &[u8]) -> Check<()>,
    ) -> Check<()> {
        let Some(sparse) = accessor.get("sparse") else {
            return Ok(());
        };
        self.sparse_entries(sparse, layout, set)
            .of(|| "sparse".into())
    }

    fn sparse_entries(
        &self,
        sparse: &Value,
        layout: &Layout,
        mut set: impl FnMut(usize, &[u8]) -> Check<()>,
    ) -> Check<()> {
        let count = required(sparse, "count")?;
        let part = |key: &str, width, component| {
            let object = sparse
                .get(key)
                .ok_or_else(|| format!("\"{key}\" is missing"))?;
            let view = object
                .get("bufferView")
                .ok_or("\"bufferView\" is missing")?;
            let view = as_index(view, "bufferView", self.views.len())?;
            let component = match component {
                Some(c) => c,
                None => Component::new(required(object, "componentType")?)?,
            };
            let packed = Layout {
                buffer: None,
                start: 0,
                stride: width * component.size(),
                count,
                width,
                component,
                normalized: false,
            };
            self.place(packed, view, integer(object, "byteOffset")?.unwrap_or(0))
        };
        let where_to = part("indices", 1, None)?;
        let values = part("values", layout.width, Some(layout.component))?;
        let mut targets = vec![0usize; count];
        self.elements(&where_to, |k, bytes| {
            targets[k] = where_to.component.unsigned(bytes)? as usize;
            Ok(())
        })?;
        self.elements(&values, |k, bytes| {
            let target = targets[k];
            if target >= layout.count {
                return Err(format!(
                    "index {target}, but there are {} elements",
                    layout.count
                ));
            }
            set(target, bytes)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn normalised_integers_follow_the_specification() {
        assert_eq!(Component::I8.float(&[0x80], true), -1.0);
        assert_eq!(Component::U16.float(&[0xFF, 0xFF], true), 1.0);
        assert_eq!(Component::I16.float(&[0x01, 0x80], false), -32767.0);
    }

    #[test]
    fn strides_offsets_and_sparse_entries_are_read() {
        // Two u16 pairs with stride 8 from byte 2, then one sparse replacement of element 1.
        let mut bytes = vec![0u8; 2];
        for v in [1u16, 2, 99, 99, 3, 4] {
            bytes.extend(v.to_le_bytes());
        }
        bytes.extend([1u8, 0]); // sparse index and padding, byte 14
        bytes.extend([7u8, 0, 8, 0]); // byte 16
        let json = json!({
            "bufferViews": [
                {"buffer": 0, "byteLength": 14, "byteStride": 8},
                {"buffer": 0, "byteOffset": 14, "byteLength": 1},
                {"buffer": 0, "byteOffset": 16, "byteLength": 4}],
            "accessors": [{"componentType": 5123, "type": "VEC2", "count": 2, "bufferView": 0,
                "byteOffset": 2, "sparse": {"count": 1,
                    "indices": {"bufferView": 1, "componentType": 5121},
                    "values": {"bufferView": 2}}}]
        });
        let buffers = [bytes];
        let source = Source::new(&json, &buffers).unwrap();
        assert_eq!(source.vectors::<2>(0).unwrap(), [[1.0, 2.0], [7.0, 8.0]]);
    }

    #[test]
    fn a_count_that_overflows_is_an_error_before_any_allocation() {
        for count in [3usize, usize::MAX, usize::MAX / 8] {
            let json = json!({
                "bufferViews": [{"buffer": 0, "byteLength": 16}],
                "accessors": [{"componentType": 5126, "type": "VEC2", "count": count, "bufferView": 0}]
            });
            let buffers = [vec![0u8; 16]];
            let source = Source::new(&json, &buffers).unwrap();
            let e = source.vectors::<2>(0).unwrap_err();
            assert!(
                e.contains("accessor 0") && e.contains("pass the end"),
                "{e}"
            );
        }
        let json =
            json!({"accessors": [{"componentType": 5126, "type": "VEC2", "count": 1u64 << 40}]});
        let source = Source::new(&json, &[]).unwrap();
        assert!(
            source
                .vectors::<2>(0)
                .unwrap_err()
                .contains("without a bufferView")
        );
    }
}
