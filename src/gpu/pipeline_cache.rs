//! The pipeline cache on disk. A damaged or foreign file is ignored, never given to the driver.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use ash::vk;

use super::device::DeviceInfo;

const CHECKSUM_BYTES: usize = 32;
const HEADER_BYTES: usize = 32;

/// A `VkPipelineCache` and its file.
pub(super) struct PipelineCache {
    pub(super) raw: vk::PipelineCache,
    path: Option<PathBuf>,
    /// Set when a pipeline was made since the last save.
    changed: AtomicBool,
}

impl PipelineCache {
    pub(super) fn open(
        device: &ash::Device,
        info: &DeviceInfo,
        folder: Option<&Path>,
        uuid: [u8; 16],
    ) -> Self {
        let path = folder.map(|f| {
            let hex: String = uuid.iter().map(|b| format!("{b:02x}")).collect();
            f.join(format!(
                "pipelines-{:04x}-{:04x}-{hex}.bin",
                info.vendor_id, info.device_id
            ))
        });
        let data = path
            .as_deref()
            .map(|p| read(p, info, uuid))
            .unwrap_or_default();
        let create = vk::PipelineCacheCreateInfo::default().initial_data(&data);
        // SAFETY: the data was checked against its checksum and this device.
        let raw = unsafe { device.create_pipeline_cache(&create, None) }.unwrap_or_else(|e| {
            log::warn!("no pipeline cache: {e}");
            vk::PipelineCache::null()
        });
        Self {
            raw,
            path,
            changed: AtomicBool::new(false),
        }
    }

    pub(super) fn note_new_pipeline(&self) {
        self.changed.store(true, Ordering::Relaxed);
    }

    pub(super) fn save(&self, device: &ash::Device) {
        let Some(path) = &self.path else { return };
        if self.raw == vk::PipelineCache::null() || !self.changed.swap(false, Ordering::Relaxed) {
            return;
        }
        // SAFETY: the cache belongs to this device.
        let data = match unsafe { device.get_pipeline_cache_data(self.raw) } {
            Ok(data) => data,
            Err(e) => return log::warn!("pipeline cache not read: {e}"),
        };
        if let Err(e) = write(path, &data) {
            log::warn!("{}: pipeline cache not saved: {e}", path.display());
        }
    }

    /// # Safety
    /// No pipeline is being made.
    pub(super) unsafe fn destroy(&self, device: &ash::Device) {
        // SAFETY: the cache belongs to this device and is used by nobody.
        unsafe { device.destroy_pipeline_cache(self.raw, None) };
    }
}

/// The cache's content, or nothing when the file is missing, damaged or of another device.
fn read(path: &Path, info: &DeviceInfo, uuid: [u8; 16]) -> Vec<u8> {
    let Ok(file) = std::fs::read(path) else {
        return Vec::new();
    };
    match checked(&file, info.vendor_id, info.device_id, uuid) {
        Some(data) => data.to_vec(),
        None => {
            log::warn!(
                "{}: pipeline cache is damaged or of another device; ignored",
                path.display()
            );
            Vec::new()
        }
    }
}

/// Strips the checksum and compares the header with the device (Vulkan 1.3, table of
/// `VkPipelineCacheHeaderVersionOne`).
fn checked(file: &[u8], vendor: u32, device: u32, uuid: [u8; 16]) -> Option<&[u8]> {
    let (checksum, data) = file.split_at_checked(CHECKSUM_BYTES)?;
    if blake3::hash(data).as_bytes() != checksum || data.len() < HEADER_BYTES {
        return None;
    }
    let word =
        |i: usize| u32::from_le_bytes(data[4 * i..4 * i + 4].try_into().expect("four bytes"));
    (word(1) == 1 && word(2) == vendor && word(3) == device && data[16..32] == uuid).then_some(data)
}

fn write(path: &Path, data: &[u8]) -> std::io::Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let temporary = path.with_extension(format!("tmp{}", std::process::id()));
    std::fs::write(
        &temporary,
        [blake3::hash(data).as_bytes().as_slice(), data].concat(),
    )?;
    std::fs::rename(&temporary, path)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(vendor: u32) -> Vec<u8> {
        let mut data = Vec::new();
        for word in [32u32, 1, vendor, 7] {
            data.extend(word.to_le_bytes());
        }
        data.extend([9u8; 16]);
        data.extend(b"pipelines");
        [blake3::hash(&data).as_bytes().as_slice(), &data].concat()
    }

    #[test]
    fn only_an_intact_cache_of_this_device_is_used() {
        let good = file(5);
        assert!(checked(&good, 5, 7, [9; 16]).is_some());
        assert!(checked(&good, 6, 7, [9; 16]).is_none(), "another vendor");
        assert!(
            checked(&good, 5, 7, [8; 16]).is_none(),
            "another driver build"
        );
        for cut in [0, 10, 40, good.len() - 1] {
            assert!(
                checked(&good[..cut], 5, 7, [9; 16]).is_none(),
                "cut at {cut}"
            );
        }
        let mut flipped = good;
        *flipped.last_mut().expect("not empty") ^= 1;
        assert!(
            checked(&flipped, 5, 7, [9; 16]).is_none(),
            "one bit flipped"
        );
    }
}
