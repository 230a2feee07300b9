//! Accessors: typed views of buffers, with bounds checked before anything is read.

use std::cell::Cell;

use gltf::json::accessor::{Accessor, ComponentType, IndexComponentType};
use gltf::json::buffer::View;
use gltf::json::validation::Checked;
use gltf::json::{Index, accessor};
use serde_json::Value;

use super::json::{Check, Of, at, known, list};

/// Most bytes one file may decode to; a damaged or hostile file cannot ask for more.
const DECODED_LIMIT: usize = 4 << 30;
/// Most elements of an accessor that has no buffer behind it (all zero but for sparse entries).
const UNBACKED_LIMIT: usize = 1 << 22;

/// The parts of a document that accessors need.
#[derive(Debug)]
pub(in crate::scene) struct Source<'a> {
    accessors: Vec<(Accessor, &'a Value)>,
    views: Vec<(View, &'a Value)>,
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
    pub(in crate::scene) component: ComponentType,
    /// Integers stand for \[0,1\] or \[-1,1\].
    pub(in crate::scene) normalized: bool,
}

/// Value at the start of `b` as a float (glTF 2.0, 3.6.2.2: normalised integers).
fn float(component: ComponentType, b: &[u8], normalized: bool) -> f32 {
    use ComponentType::{F32, I8, I16, U8, U16, U32};
    let scale = |v: f32, max: f32| if normalized { (v / max).max(-1.0) } else { v };
    match component {
        I8 => scale(f32::from(i8::from_le_bytes([b[0]])), 127.0),
        U8 => scale(f32::from(b[0]), 255.0),
        I16 => scale(f32::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
        U16 => scale(f32::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
        U32 => scale(
            u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f32,
            u32::MAX as f32,
        ),
        F32 => f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
    }
}

fn unsigned(component: ComponentType, b: &[u8]) -> Check<u32> {
    match component {
        ComponentType::U8 => Ok(u32::from(b[0])),
        ComponentType::U16 => Ok(u32::from(u16::from_le_bytes([b[0], b[1]]))),
        ComponentType::U32 => Ok(u32::from_le_bytes([b[0], b[1], b[2], b[3]])),
        _ => Err("indices must be unsigned integers".into()),
    }
}

/// A size of the file as one of this machine.
fn size(n: u64, key: &str) -> Check<usize> {
    usize::try_from(n).map_err(|_| format!("\"{key}\" is {n}, more than this machine can address"))
}

impl<'a> Source<'a> {
    /// Reads the lists of `json`.
    pub(in crate::scene) fn new(json: &'a Value, buffers: &'a [Vec<u8>]) -> Check<Self> {
        Ok(Self {
            accessors: list(json, "accessors", "accessor")?,
            views: list(json, "bufferViews", "bufferView")?,
            buffers,
            decoded: Cell::new(0),
        })
    }

    /// The accessors.
    pub(in crate::scene) fn accessors(&self) -> impl ExactSizeIterator<Item = &Accessor> {
        self.accessors.iter().map(|(a, _)| a)
    }

    /// The accessor that `index` means, for the member `key`.
    pub(in crate::scene) fn at(&self, index: Index<Accessor>, key: &str) -> Check<usize> {
        at(index, key, self.accessors.len())
    }

    /// Buffer, first byte, length and stride of a view.
    pub(in crate::scene) fn view(&self, i: usize) -> Check<(usize, usize, usize, Option<usize>)> {
        let read = || {
            let (view, _) = &self.views[i];
            let buffer = at(view.buffer, "buffer", self.buffers.len())?;
            let start = size(view.byte_offset.unwrap_or_default().0, "byteOffset")?;
            let length = size(view.byte_length.0, "byteLength")?;
            let have = self.buffers[buffer].len();
            if start.checked_add(length).is_none_or(|end| end > have) {
                return Err(format!(
                    "bytes {start} + {length} pass the end of buffer {buffer} ({have} bytes)"
                ));
            }
            Ok((buffer, start, length, view.byte_stride.map(|s| s.0)))
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

    fn layout_of(&self, (accessor, v): &(Accessor, &Value)) -> Check<Layout> {
        let component = known(accessor.component_type, v, "componentType")?.0;
        let width = known(accessor.type_, v, "type")?.multiplicity();
        let layout = Layout {
            buffer: None,
            start: 0,
            stride: width * component.size(),
            count: size(accessor.count.0, "count")?,
            width,
            component,
            normalized: accessor.normalized,
        };
        let Some(view) = accessor.buffer_view else {
            if layout.count > UNBACKED_LIMIT {
                return Err(format!("{} elements without a bufferView", layout.count));
            }
            return Ok(layout);
        };
        let offset = accessor.byte_offset.unwrap_or_default();
        self.place(layout, view, offset.0)
    }

    /// Puts `layout` at `offset` in a view and checks that it stays inside.
    fn place(&self, mut layout: Layout, view: Index<View>, offset: u64) -> Check<Layout> {
        let view = at(view, "bufferView", self.views.len())?;
        let offset = size(offset, "byteOffset")?;
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
            std::array::from_fn(|c| float(layout.component, &bytes[c * size..], layout.normalized))
        };
        self.elements(&layout, |k, bytes| {
            out[k] = element(bytes);
            Ok(())
        })?;
        self.sparse(&accessor.0, &layout, |k, bytes| {
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
                out[k] = unsigned(layout.component, bytes)?;
                Ok(())
            };
            self.elements(&layout, &mut set)?;
            self.sparse(&accessor.0, &layout, &mut set)?;
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
        accessor: &Accessor,
        layout: &Layout,
        set: impl FnMut(usize, &[u8]) -> Check<()>,
    ) -> Check<()> {
        let Some(sparse) = &accessor.sparse else {
            return Ok(());
        };
        self.sparse_entries(sparse, layout, set)
            .of(|| "sparse".into())
    }

    fn sparse_entries(
        &self,
        sparse: &accessor::sparse::Sparse,
        layout: &Layout,
        mut set: impl FnMut(usize, &[u8]) -> Check<()>,
    ) -> Check<()> {
        let count = size(sparse.count.0, "count")?;
        let packed = |width: usize, component: ComponentType| Layout {
            buffer: None,
            start: 0,
            stride: width * component.size(),
            count,
            width,
            component,
            normalized: false,
        };
        let (indices, values) = (&sparse.indices, &sparse.values);
        let Checked::Valid(IndexComponentType(component)) = indices.component_type else {
            return Err("indices must be unsigned integers".into());
        };
        let where_to = packed(1, component);
        let where_to = self.place(where_to, indices.buffer_view, indices.byte_offset.0)?;
        let values_of = packed(layout.width, layout.component);
        let values = self.place(values_of, values.buffer_view, values.byte_offset.0)?;
        let mut targets = vec![0usize; count];
        self.elements(&where_to, |k, bytes| {
            targets[k] = unsigned(where_to.component, bytes)? as usize;
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
        assert_eq!(float(ComponentType::I8, &[0x80], true), -1.0);
        assert_eq!(float(ComponentType::U16, &[0xFF, 0xFF], true), 1.0);
        assert_eq!(float(ComponentType::I16, &[0x01, 0x80], false), -32767.0);
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
