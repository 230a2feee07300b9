//! Which device: every candidate is accepted with a preference or rejected with a reason.

use ash::vk;

use super::instance::INSTALL;
use super::queues::{Family, QueuePlan};
use crate::{Error, Result};

/// What the choice needs to know of a device.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    pub(super) name: String,
    pub(super) api_version: u32,
    pub(super) device_type: vk::PhysicalDeviceType,
    pub(super) families: Vec<Family>,
    /// Names of required features that are missing.
    pub(super) missing: Vec<&'static str>,
    pub(super) max_group_invocations: u32,
    pub(super) max_storage_buffers_per_stage: u32,
}

/// Storage buffers that one stage may bind; the portable baseline has 30.
pub(super) const STORAGE_BUFFERS_PER_STAGE: u32 = 16;
/// Invocations per group that kernels may use.
pub(super) const GROUP_INVOCATIONS: u32 = 256;

impl Candidate {
    /// Higher is better, or why the device cannot be used.
    pub(super) fn rate(&self) -> Result<u32, String> {
        if self.api_version < vk::API_VERSION_1_3 {
            let v = self.api_version;
            return Err(format!(
                "has Vulkan {}.{}, needs 1.3",
                vk::api_version_major(v),
                vk::api_version_minor(v)
            ));
        }
        if !self.missing.is_empty() {
            return Err(format!("lacks {}", self.missing.join(", ")));
        }
        if QueuePlan::decide(&self.families).is_none() {
            return Err("no queue family can both draw and compute".into());
        }
        if self.max_group_invocations < GROUP_INVOCATIONS {
            return Err(format!(
                "allows {} invocations per group, needs {GROUP_INVOCATIONS}",
                self.max_group_invocations
            ));
        }
        if self.max_storage_buffers_per_stage < STORAGE_BUFFERS_PER_STAGE {
            return Err(format!(
                "allows {} storage buffers per stage, needs {STORAGE_BUFFERS_PER_STAGE}",
                self.max_storage_buffers_per_stage
            ));
        }
        Ok(match self.device_type {
            vk::PhysicalDeviceType::DISCRETE_GPU => 4,
            vk::PhysicalDeviceType::INTEGRATED_GPU => 3,
            vk::PhysicalDeviceType::VIRTUAL_GPU => 2,
            _ => 1,
        })
    }
}

/// Index of the device to use.
///
/// `wanted` is an index or a part of the name (any case). Rejections are logged.
///
/// # Errors
/// Lists all devices and why not: a wrong `--device` is the user's to mend, a machine without a
/// usable device is not.
pub(super) fn choose(candidates: &[Candidate], wanted: Option<&str>) -> Result<usize> {
    let mut best: Option<(u32, usize)> = None;
    let mut reasons = Vec::new();
    let mut named = false;
    for (index, candidate) in candidates.iter().enumerate() {
        if let Some(wanted) = wanted {
            let by_index = wanted.parse() == Ok(index);
            if !by_index
                && !candidate
                    .name
                    .to_lowercase()
                    .contains(&wanted.to_lowercase())
            {
                reasons.push(format!("{index}: {}: not named {wanted:?}", candidate.name));
                continue;
            }
        }
        named = true;
        match candidate.rate() {
            Ok(rating) if best.is_none_or(|(r, _)| rating > r) => best = Some((rating, index)),
            Ok(_) => reasons.push(format!(
                "{index}: {}: another device is preferred",
                candidate.name
            )),
            Err(reason) => reasons.push(format!("{index}: {}: {reason}", candidate.name)),
        }
    }
    for reason in &reasons {
        log::info!("device {reason}");
    }
    match best {
        Some((_, index)) => Ok(index),
        None if candidates.is_empty() => {
            Err(Error::NoDevice(format!("no Vulkan device; {INSTALL}")))
        }
        None => {
            let reasons = reasons.join("\n  ");
            Err(match wanted {
                Some(wanted) if !named => Error::usage(format!(
                    "--device {wanted}: no such Vulkan device:\n  {reasons}"
                )),
                _ => Error::NoDevice(format!("no usable Vulkan device:\n  {reasons}")),
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn device(name: &str, device_type: vk::PhysicalDeviceType) -> Candidate {
        Candidate {
            name: name.into(),
            api_version: vk::API_VERSION_1_3,
            device_type,
            families: vec![Family {
                graphics: true,
                compute: true,
                transfer: true,
                count: 1,
            }],
            missing: Vec::new(),
            max_group_invocations: 1024,
            max_storage_buffers_per_stage: 32,
        }
    }

    #[test]
    fn a_discrete_gpu_wins_over_a_cpu() {
        let all = [
            device("llvmpipe", vk::PhysicalDeviceType::CPU),
            device("Big", vk::PhysicalDeviceType::DISCRETE_GPU),
        ];
        assert_eq!(choose(&all, None).unwrap(), 1);
        assert_eq!(choose(&all, Some("LLVM")).unwrap(), 0);
        assert_eq!(choose(&all, Some("0")).unwrap(), 0);
    }

    #[test]
    fn every_rejection_has_its_reason() {
        let mut old = device("Old", vk::PhysicalDeviceType::CPU);
        old.api_version = vk::API_VERSION_1_1;
        let mut poor = device("Poor", vk::PhysicalDeviceType::CPU);
        poor.missing = vec!["synchronization2"];
        let mut small = device("Small", vk::PhysicalDeviceType::CPU);
        small.max_group_invocations = 128;
        let error = choose(&[old, poor, small], None).expect_err("none fits");
        assert_eq!(error.exit_code(), 3, "not the user's fault");
        let message = error.to_string();
        for part in [
            "Old: has Vulkan 1.1, needs 1.3",
            "Poor: lacks synchronization2",
            "Small: allows 128",
        ] {
            assert!(message.contains(part), "{message}");
        }
    }

    #[test]
    fn an_unknown_name_lists_what_there_is() {
        let all = [device("llvmpipe", vk::PhysicalDeviceType::CPU)];
        let error = choose(&all, Some("geforce")).expect_err("not there");
        assert_eq!(error.exit_code(), 2, "a name to mend");
        let message = error.to_string();
        assert!(
            message.contains("0: llvmpipe: not named \"geforce\""),
            "{message}"
        );
        assert!(
            choose(&[], None)
                .expect_err("empty")
                .to_string()
                .contains("mesa-vulkan-drivers")
        );
    }
}
