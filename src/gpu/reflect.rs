//! What a shader says about itself: bindings, group size, push constants, struct offsets.
//!
//! Reads the SPIR-V directly, so that set layouts, group counts and push-constant sizes are never
//! typed a second time. Opcodes and enumerants are those of the SPIR-V specification, section 3.

use std::collections::BTreeMap;

/// Kind of a descriptor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum DescriptorKind {
    /// `buffer` block.
    StorageBuffer,
    /// `uniform` block.
    UniformBuffer,
    /// `sampler2D` and relatives.
    CombinedImageSampler,
    /// `image2D` and relatives.
    StorageImage,
}

/// One binding of a shader.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReflectedBinding {
    /// Descriptor set.
    pub set: u32,
    /// Binding in the set.
    pub binding: u32,
    /// What is bound.
    pub kind: DescriptorKind,
}

/// A struct with explicit member offsets.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReflectedStruct {
    /// Name in the source, without the compiler's numbering.
    pub name: String,
    /// (member, byte offset) in order.
    pub members: Vec<(String, u32)>,
    /// Distance of elements where the shader has an array of it.
    pub array_stride: Option<u32>,
}

/// Everything that the host needs to know about a shader.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Reflection {
    /// Sorted by set and binding.
    pub bindings: Vec<ReflectedBinding>,
    /// Invocations per group; `[1, 1, 1]` for other stages.
    pub local_size: [u32; 3],
    /// Bytes of push constants; 0 when there are none.
    pub push_bytes: u32,
    /// Structs with offsets.
    pub structs: Vec<ReflectedStruct>,
}

#[derive(Debug, Clone, Default)]
struct Type {
    opcode: u32,
    operands: Vec<u32>,
}

#[derive(Default)]
struct Module {
    types: BTreeMap<u32, Type>,
    names: BTreeMap<u32, String>,
    member_names: BTreeMap<(u32, u32), String>,
    offsets: BTreeMap<(u32, u32), u32>,
    matrix_strides: BTreeMap<(u32, u32), u32>,
    array_strides: BTreeMap<u32, u32>,
    sets: BTreeMap<u32, u32>,
    bindings: BTreeMap<u32, u32>,
    constants: BTreeMap<u32, u32>,
    variables: Vec<(u32, u32, u32)>,
    local_size: Option<[u32; 3]>,
    /// Ids of the constants, where the size is given by named constants.
    local_size_ids: Option<[u32; 3]>,
}

mod op {
    pub(super) const NAME: u32 = 5;
    pub(super) const MEMBER_NAME: u32 = 6;
    pub(super) const EXECUTION_MODE: u32 = 16;
    pub(super) const TYPE_INT: u32 = 21;
    pub(super) const TYPE_FLOAT: u32 = 22;
    pub(super) const TYPE_VECTOR: u32 = 23;
    pub(super) const TYPE_MATRIX: u32 = 24;
    pub(super) const TYPE_IMAGE: u32 = 25;
    pub(super) const TYPE_SAMPLED_IMAGE: u32 = 27;
    pub(super) const TYPE_ARRAY: u32 = 28;
    pub(super) const TYPE_RUNTIME_ARRAY: u32 = 29;
    pub(super) const TYPE_STRUCT: u32 = 30;
    pub(super) const TYPE_POINTER: u32 = 32;
    pub(super) const CONSTANT: u32 = 43;
    pub(super) const VARIABLE: u32 = 59;
    pub(super) const DECORATE: u32 = 71;
    pub(super) const MEMBER_DECORATE: u32 = 72;
    pub(super) const EXECUTION_MODE_ID: u32 = 331;
}
const LOCAL_SIZE: u32 = 17;
const LOCAL_SIZE_ID: u32 = 38;
const DECORATION_ARRAY_STRIDE: u32 = 6;
const DECORATION_MATRIX_STRIDE: u32 = 7;
const DECORATION_BINDING: u32 = 33;
const DECORATION_SET: u32 = 34;
const DECORATION_OFFSET: u32 = 35;
const STORAGE_UNIFORM_CONSTANT: u32 = 0;
const STORAGE_UNIFORM: u32 = 2;
const STORAGE_PUSH_CONSTANT: u32 = 9;
const STORAGE_BUFFER: u32 = 12;

impl Reflection {
    /// Reads SPIR-V words made by this program's own build.
    ///
    /// # Panics
    /// When the words are not SPIR-V: a broken build, not bad input.
    #[must_use]
    pub fn of(words: &[u32]) -> Self {
        assert!(words.len() > 5 && words[0] == 0x0723_0203, "not SPIR-V");
        let module = Module::parse(&words[5..]);
        let mut bindings: Vec<ReflectedBinding> = module
            .variables
            .iter()
            .filter_map(|&(id, pointer, storage)| module.binding(id, pointer, storage))
            .collect();
        bindings.sort_by_key(|b| (b.set, b.binding));
        let push_bytes = module
            .variables
            .iter()
            .filter(|v| v.2 == STORAGE_PUSH_CONSTANT)
            .map(|v| module.size(module.pointee(v.1)))
            .max()
            .unwrap_or(0);
        Self {
            bindings,
            local_size: module.local_size(),
            push_bytes,
            structs: module.structs(),
        }
    }
}

fn text(words: &[u32]) -> String {
    let bytes: Vec<u8> = words
        .iter()
        .flat_map(|w| w.to_le_bytes())
        .take_while(|&b| b != 0)
        .collect();
    String::from_utf8_lossy(&bytes).into_owned()
}

impl Module {
    fn parse(mut rest: &[u32]) -> Self {
        let mut m = Self::default();
        while let Some(&first) = rest.first() {
            let (length, opcode) = ((first >> 16) as usize, first & 0xffff);
            assert!(
                length > 0 && length <= rest.len(),
                "truncated SPIR-V instruction"
            );
            m.instruction(opcode, &rest[1..length]);
            rest = &rest[length..];
        }
        m
    }

    fn instruction(&mut self, opcode: u32, a: &[u32]) {
        match opcode {
            op::NAME => drop(self.names.insert(a[0], text(&a[1..]))),
            op::MEMBER_NAME => drop(self.member_names.insert((a[0], a[1]), text(&a[2..]))),
            op::EXECUTION_MODE if a[1] == LOCAL_SIZE => self.local_size = Some([a[2], a[3], a[4]]),
            op::EXECUTION_MODE_ID if a[1] == LOCAL_SIZE_ID => {
                self.local_size_ids = Some([a[2], a[3], a[4]]);
            }
            op::TYPE_INT..=op::TYPE_POINTER => {
                self.types.insert(
                    a[0],
                    Type {
                        opcode,
                        operands: a[1..].to_vec(),
                    },
                );
            }
            op::CONSTANT => drop(self.constants.insert(a[1], a[2])),
            op::VARIABLE => self.variables.push((a[1], a[0], a[2])),
            op::DECORATE => match a[1] {
                DECORATION_BINDING => drop(self.bindings.insert(a[0], a[2])),
                DECORATION_SET => drop(self.sets.insert(a[0], a[2])),
                DECORATION_ARRAY_STRIDE => drop(self.array_strides.insert(a[0], a[2])),
                _ => {}
            },
            op::MEMBER_DECORATE if a[2] == DECORATION_OFFSET => {
                self.offsets.insert((a[0], a[1]), a[3]);
            }
            op::MEMBER_DECORATE if a[2] == DECORATION_MATRIX_STRIDE => {
                self.matrix_strides.insert((a[0], a[1]), a[3]);
            }
            _ => {}
        }
    }

    fn local_size(&self) -> [u32; 3] {
        match self.local_size_ids {
            Some(ids) => ids.map(|id| self.constants[&id]),
            None => self.local_size.unwrap_or([1; 3]),
        }
    }

    fn pointee(&self, pointer: u32) -> u32 {
        self.types[&pointer].operands[1]
    }

    fn binding(&self, id: u32, pointer: u32, storage: u32) -> Option<ReflectedBinding> {
        // Types of built-in inputs (bool) are not recorded; they are no bindings.
        let mut pointee = self.types.get(&self.pointee(pointer))?;
        while matches!(pointee.opcode, op::TYPE_ARRAY | op::TYPE_RUNTIME_ARRAY) {
            pointee = self.types.get(&pointee.operands[0])?;
        }
        let kind = match (storage, pointee.opcode) {
            (STORAGE_BUFFER, _) => DescriptorKind::StorageBuffer,
            (STORAGE_UNIFORM, _) => DescriptorKind::UniformBuffer,
            (STORAGE_UNIFORM_CONSTANT, op::TYPE_SAMPLED_IMAGE) => {
                DescriptorKind::CombinedImageSampler
            }
            (STORAGE_UNIFORM_CONSTANT, op::TYPE_IMAGE) => DescriptorKind::StorageImage,
            _ => return None,
        };
        let set = self.sets.get(&id).copied().unwrap_or(0);
        Some(ReflectedBinding {
            set,
            binding: *self.bindings.get(&id)?,
            kind,
        })
    }

    /// Bytes of a type under its decorations.
    fn size(&self, id: u32) -> u32 {
        let ty = &self.types[&id];
        match ty.opcode {
            op::TYPE_INT | op::TYPE_FLOAT => ty.operands[0] / 8,
            op::TYPE_VECTOR | op::TYPE_MATRIX => self.size(ty.operands[0]) * ty.operands[1],
            op::TYPE_ARRAY => {
                let stride = self.array_strides.get(&id).copied();
                stride.unwrap_or_else(|| self.size(ty.operands[0]))
                    * self.constants[&ty.operands[1]]
            }
            op::TYPE_STRUCT => (0u32..)
                .zip(&ty.operands)
                .map(|(i, &member)| {
                    self.offsets.get(&(id, i)).copied().unwrap_or(0)
                        + self.member_size(id, i, member)
                })
                .max()
                .unwrap_or(0),
            _ => 0,
        }
    }

    fn member_size(&self, id: u32, index: u32, member: u32) -> u32 {
        let ty = &self.types[&member];
        match (ty.opcode, self.matrix_strides.get(&(id, index))) {
            (op::TYPE_MATRIX, Some(stride)) => {
                stride * (ty.operands[1] - 1) + self.size(ty.operands[0])
            }
            _ => self.size(member),
        }
    }

    fn structs(&self) -> Vec<ReflectedStruct> {
        let mut out = Vec::new();
        for (&id, ty) in self
            .types
            .iter()
            .filter(|(_, t)| t.opcode == op::TYPE_STRUCT)
        {
            let members: Option<Vec<(String, u32)>> = (0u32..)
                .zip(&ty.operands)
                .map(|(i, _)| {
                    Some((
                        self.member_names.get(&(id, i))?.clone(),
                        *self.offsets.get(&(id, i))?,
                    ))
                })
                .collect();
            let (Some(name), Some(members)) = (self.names.get(&id), members) else {
                continue;
            };
            let array_stride = self.types.iter().find_map(|(array, t)| {
                let is_array = matches!(t.opcode, op::TYPE_ARRAY | op::TYPE_RUNTIME_ARRAY);
                (is_array && t.operands[0] == id).then(|| self.array_strides.get(array).copied())?
            });
            let name = name
                .trim_end_matches(|c: char| c.is_ascii_digit())
                .trim_end_matches('_');
            let full = self.names[&id].clone();
            // `Foo_0` is the compiler's second copy of `Foo`; a name that itself ends in a digit stays.
            let name = if full.contains('_') {
                name.to_owned()
            } else {
                full
            };
            out.push(ReflectedStruct {
                name,
                members,
                array_stride,
            });
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::shaders;

    #[test]
    fn the_smallest_kernel_is_read_back() {
        let r = Reflection::of(&shaders::gpu::FILL_SEQUENCE_COMP.words());
        assert_eq!(r.local_size, [crate::abi::GROUP_1D, 1, 1]);
        assert_eq!(r.push_bytes as usize, size_of::<crate::abi::FillSequence>());
        let expected = ReflectedBinding {
            set: 0,
            binding: 0,
            kind: DescriptorKind::StorageBuffer,
        };
        assert_eq!(r.bindings, [expected]);
    }
}
