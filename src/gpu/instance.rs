//! The Vulkan instance, and the canary that turns validation messages into failures.

use std::ffi::{CStr, CString, c_void};
use std::sync::{Arc, Mutex};

use ash::{ext, vk};

use super::device::Validation;
use crate::{Error, Result};

/// What to do where Vulkan is missing.
pub(super) const INSTALL: &str = "install one: Debian has mesa-vulkan-drivers, and scripts/setup.sh \
                                  installs it with all else that is needed";

const VALIDATION_LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// Messages of severity warning and above, in the order they came.
///
/// The callback only stores: panicking across a foreign frame is not allowed. Who owns the
/// device asks for the messages and decides.
pub(super) type Canary = Arc<Mutex<Vec<String>>>;

/// Instance, loader and debug messenger; destroyed last.
pub(super) struct Instance {
    pub(super) raw: ash::Instance,
    pub(super) debug: Option<ext::debug_utils::Instance>,
    messenger: vk::DebugUtilsMessengerEXT,
    /// Boxed so that the callback's pointer stays valid.
    canary: Box<Canary>,
    _entry: ash::Entry,
}

impl Instance {
    pub(super) fn new(validation: Validation) -> Result<Self> {
        // SAFETY: loading the system's Vulkan loader runs its initialisers, nothing else.
        let entry = unsafe { ash::Entry::load() }
            .map_err(|e| Error::NoDevice(format!("no Vulkan loader ({e}); {INSTALL}")))?;
        let layers = available_layers(&entry)?;
        let use_layer = match validation {
            Validation::Off => false,
            Validation::IfPresent => layers.iter().any(|l| l == VALIDATION_LAYER),
            Validation::Required => {
                if !layers.iter().any(|l| l == VALIDATION_LAYER) {
                    return Err(Error::Unsupported(
                        "the Khronos validation layer is not installed (Debian: vulkan-validationlayers)".into(),
                    ));
                }
                true
            }
        };
        let debug_utils = use_layer || has_debug_utils(&entry)?;
        let app = vk::ApplicationInfo::default()
            .application_name(c"umbrage")
            .engine_name(c"umbrage")
            .api_version(vk::API_VERSION_1_3);
        let layer_names = if use_layer {
            vec![VALIDATION_LAYER.as_ptr()]
        } else {
            Vec::new()
        };
        let extension_names = if debug_utils {
            vec![ext::debug_utils::NAME.as_ptr()]
        } else {
            Vec::new()
        };
        let enabled = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
        let mut features =
            vk::ValidationFeaturesEXT::default().enabled_validation_features(&enabled);
        let mut info = vk::InstanceCreateInfo::default()
            .application_info(&app)
            .enabled_layer_names(&layer_names)
            .enabled_extension_names(&extension_names);
        if use_layer {
            info = info.push_next(&mut features);
        }
        // SAFETY: every pointer in `info` outlives the call.
        let raw = unsafe { entry.create_instance(&info, None) }.map_err(|e| {
            Error::NoDevice(format!(
                "no Vulkan driver (vkCreateInstance: {e}); {INSTALL}"
            ))
        })?;
        let debug = debug_utils.then(|| ext::debug_utils::Instance::new(&entry, &raw));
        let canary = Box::new(Canary::default());
        let messenger = match &debug {
            Some(debug) if use_layer => create_messenger(debug, &canary)?,
            _ => vk::DebugUtilsMessengerEXT::null(),
        };
        Ok(Self {
            raw,
            debug,
            messenger,
            canary,
            _entry: entry,
        })
    }

    pub(super) fn canary(&self) -> Canary {
        Canary::clone(&self.canary)
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: the device and all its objects are gone (it holds this instance), and the
        // messenger was made from this instance.
        unsafe {
            if let Some(debug) = &self.debug
                && self.messenger != vk::DebugUtilsMessengerEXT::null()
            {
                debug.destroy_debug_utils_messenger(self.messenger, None);
            }
            self.raw.destroy_instance(None);
        }
    }
}

fn available_layers(entry: &ash::Entry) -> Result<Vec<CString>> {
    // SAFETY: plain query.
    let layers = unsafe { entry.enumerate_instance_layer_properties() }
        .map_err(|e| Error::NoDevice(format!("vkEnumerateInstanceLayerProperties: {e}")))?;
    Ok(layers
        .iter()
        .filter_map(|l| l.layer_name_as_c_str().ok().map(CStr::to_owned))
        .collect())
}

fn has_debug_utils(entry: &ash::Entry) -> Result<bool> {
    // SAFETY: plain query.
    let all = unsafe { entry.enumerate_instance_extension_properties(None) }
        .map_err(|e| Error::NoDevice(format!("vkEnumerateInstanceExtensionProperties: {e}")))?;
    Ok(all
        .iter()
        .any(|e| e.extension_name_as_c_str() == Ok(ext::debug_utils::NAME)))
}

fn create_messenger(
    debug: &ext::debug_utils::Instance,
    canary: &Canary,
) -> Result<vk::DebugUtilsMessengerEXT> {
    use vk::{
        DebugUtilsMessageSeverityFlagsEXT as Severity, DebugUtilsMessageTypeFlagsEXT as Type,
    };
    let info = vk::DebugUtilsMessengerCreateInfoEXT::default()
        .message_severity(Severity::WARNING | Severity::ERROR)
        .message_type(Type::GENERAL | Type::VALIDATION | Type::PERFORMANCE)
        .pfn_user_callback(Some(store_message))
        .user_data(std::ptr::from_ref(canary).cast_mut().cast::<c_void>());
    // SAFETY: the canary is boxed in `Instance` and outlives the messenger.
    unsafe { debug.create_debug_utils_messenger(&info, None) }
        .map_err(|e| Error::Unsupported(format!("vkCreateDebugUtilsMessengerEXT: {e}")))
}

/// Stores the message; never unwinds.
unsafe extern "system" fn store_message(
    _severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _types: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    user: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: the loader passes valid callback data, and `user` is the canary given above.
    let (message, canary) = unsafe {
        let text = (*data).p_message;
        let message = if text.is_null() {
            String::new()
        } else {
            CStr::from_ptr(text).to_string_lossy().into_owned()
        };
        (message, &*user.cast::<Canary>())
    };
    if let Ok(mut messages) = canary.lock() {
        messages.push(message);
    }
    vk::FALSE
}
