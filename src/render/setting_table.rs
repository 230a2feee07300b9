//! The table of a picture's settings: names, units, ranges, how they are read and written.

use super::settings::{Background, Encoding, RenderSettings, ShadowFit};
use crate::scene::Sky;
use crate::{Error, Result};

/// One row of the table that command line, scene files and sweeps are made from.
#[derive(Debug, Clone, Copy)]
pub struct SettingInfo {
    /// Name on the command line (`--name`) and in scene files.
    pub name: &'static str,
    /// How a value is written: `WxH`, `AZ,EL`, `on|off`, a number's unit.
    pub unit: &'static str,
    /// What it is.
    pub help: &'static str,
    /// Allowed values.
    pub range: &'static str,
    /// What it trades for what; empty where it chooses the picture and approximates nothing.
    pub trades: &'static str,
    /// The value at which nothing is approximated, or that it changes the meaning, not the error.
    pub exact_end: &'static str,
    /// Current value as text.
    pub get: fn(&RenderSettings) -> String,
    /// Sets it from text, or says what is wrong with the value.
    pub set: fn(&mut RenderSettings, &str) -> Result<()>,
}

/// Reads a number within a range.
fn number(text: &str, range: std::ops::RangeInclusive<f64>) -> Result<f64> {
    text.trim()
        .parse::<f64>()
        .ok()
        .filter(|v| range.contains(v))
        .ok_or_else(|| {
            Error::usage(format!(
                "`{text}` is not a number from {} to {}",
                range.start(),
                range.end()
            ))
        })
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "settings keep f32 precision"
)]
fn number32(text: &str, range: std::ops::RangeInclusive<f64>) -> Result<f32> {
    number(text, range).map(|v| v as f32)
}

fn integer(text: &str, range: std::ops::RangeInclusive<u32>) -> Result<u32> {
    text.trim()
        .parse::<u32>()
        .ok()
        .filter(|v| range.contains(v))
        .ok_or_else(|| {
            Error::usage(format!(
                "`{text}` is not a whole number from {} to {}",
                range.start(),
                range.end()
            ))
        })
}

fn switch(text: &str) -> Result<bool> {
    match text {
        "on" | "true" | "yes" => Ok(true),
        "off" | "false" | "no" => Ok(false),
        _ => Err(Error::usage(format!("`{text}` is neither on nor off"))),
    }
}

fn switch_text(on: bool) -> String {
    if on { "on" } else { "off" }.into()
}

/// `r,g,b`, `#rrggbb` (sRGB, made linear) or one number for grey; linear unless `#`.
fn color(text: &str) -> Result<[f32; 3]> {
    if let Some(hex) = text.strip_prefix('#') {
        let bits = u32::from_str_radix(hex, 16)
            .ok()
            .filter(|_| hex.len() == 6)
            .ok_or_else(|| Error::usage(format!("`{text}` is not a colour like #a0b0c0")))?;
        return Ok([16, 8, 0].map(|s| crate::math::colour::srgb8_to_linear((bits >> s) as u8)));
    }
    let parts: Vec<f32> = text
        .split(',')
        .map(|p| number32(p, 0.0..=1e6))
        .collect::<Result<_>>()?;
    match parts[..] {
        [grey] => Ok([grey; 3]),
        [r, g, b] => Ok([r, g, b]),
        _ => Err(Error::usage(format!(
            "`{text}` is not a colour like 0.4,0.5,0.6"
        ))),
    }
}

fn color_text(c: [f32; 3]) -> String {
    format!("{},{},{}", c[0], c[1], c[2])
}

fn two_numbers(text: &str, what: &str) -> Result<[f64; 2]> {
    let parts: Vec<f64> = text
        .split(',')
        .filter_map(|p| p.trim().parse().ok())
        .filter(|v: &f64| v.is_finite())
        .collect();
    <[f64; 2]>::try_from(parts).map_err(|_| Error::usage(format!("`{text}` is not {what}")))
}

/// The table. Order is that of the help text.
pub const SETTINGS: &[SettingInfo] = &[
    SettingInfo {
        name: "size",
        unit: "WxH",
        help: "Pixels across and down, 1..16384",
        range: "1..16384 each",
        trades: "sharpness against time and memory, both in proportion to the pixels",
        exact_end: "changes the meaning, not the error",
        get: |s| format!("{}x{}", s.size[0], s.size[1]),
        set: |s, t| {
            let (w, h) = t
                .split_once('x')
                .ok_or_else(|| Error::usage(format!("`{t}` is not a size like 800x600")))?;
            s.size = [integer(w, 1..=16384)?, integer(h, 1..=16384)?];
            Ok(())
        },
    },
    SettingInfo {
        name: "samples",
        unit: "1|4",
        help: "Coverage samples per pixel; 4 smooths edges and leaf outlines, 1 is faster",
        range: "1, 4",
        trades: "smooth edges against four times the memory of the surface targets and twice the time of their pass",
        exact_end: "none; 4 is the closer",
        get: |s| s.samples.to_string(),
        set: |s, t| {
            s.samples = match t {
                "1" => 1,
                "4" => 4,
                _ => return Err(Error::usage(format!("`{t}` samples: 1 or 4"))),
            };
            Ok(())
        },
    },
    SettingInfo {
        name: "camera",
        unit: "AZ,EL[,DIST]|EX,EY,EZ/TX,TY,TZ",
        help: "Degrees and a factor on the framing distance, or eye and target in metres",
        range: "elevation -90..90, distance above 0; eye and target differ",
        trades: "",
        exact_end: "changes the meaning, not the error",
        get: |s| s.camera.to_string(),
        set: |s, t| {
            s.camera = t.parse()?;
            Ok(())
        },
    },
    SettingInfo {
        name: "fov",
        unit: "degrees",
        help: "Vertical field of view, 1..150",
        range: "1..150",
        trades: "",
        exact_end: "changes the meaning, not the error",
        get: |s| s.fov.to_string(),
        set: |s, t| {
            s.fov = number(t, 1.0..=150.0)?;
            Ok(())
        },
    },
    SettingInfo {
        name: "margin",
        unit: "share",
        help: "Free share of the picture on every side, 0..0.45",
        range: "0..0.45",
        trades: "",
        exact_end: "changes the meaning, not the error",
        get: |s| s.margin.to_string(),
        set: |s, t| {
            s.margin = number(t, 0.0..=0.45)?;
            Ok(())
        },
    },
    SettingInfo {
        name: "sun",
        unit: "AZ,EL",
        help: "Where the sun stands: degrees from +z towards +x, degrees above the horizon",
        range: "elevation -90..90",
        trades: "",
        exact_end: "changes the meaning, not the error",
        get: |s| format!("{},{}", s.sun.azimuth, s.sun.elevation),
        set: |s, t| {
            let [azimuth, elevation] = two_numbers(t, "azimuth and elevation like 30,45")?;
            if !(-90.0..=90.0).contains(&elevation) {
                return Err(Error::usage(format!(
                    "elevation {elevation} is not in -90..90"
                )));
            }
            (s.sun.azimuth, s.sun.elevation) = (azimuth, elevation);
            Ok(())
        },
    },
    SettingInfo {
        name: "sun-color",
        unit: "R,G,B|#rrggbb",
        help: "Linear intensity I of the sun; 0 switches it off",
        range: "0..1000000 each",
        trades: "",
        exact_end: "changes the meaning, not the error",
        get: |s| color_text(s.sun.color),
        set: |s, t| {
            s.sun.color = color(t)?;
            Ok(())
        },
    },
    SettingInfo {
        // Not `ambient`: that is how the foliage's coefficient is computed.
        name: "ambient-light",
        unit: "sky|R,G,B|#rrggbb",
        help: "Ambient intensity I_a: a sky over the ground, or the paper's constant",
        range: "sky, or 0..1000000 each",
        trades: "",
        exact_end: "changes the meaning, not the error",
        get: |s| {
            if s.sky == Sky::default() {
                "sky".into()
            } else {
                color_text(s.sky.zenith)
            }
        },
        set: |s, t| {
            s.sky = if t == "sky" {
                Sky::default()
            } else {
                Sky::constant(color(t)?)
            };
            Ok(())
        },
    },
    SettingInfo {
        name: "exposure",
        unit: "factor",
        help: "Factor on the picture before it is encoded, above 0",
        range: "0.000001..1000000",
        trades: "",
        exact_end: "changes the meaning, not the error",
        get: |s| s.exposure.to_string(),
        set: |s, t| {
            s.exposure = number32(t, 1e-6..=1e6)?;
            Ok(())
        },
    },
    SettingInfo {
        name: "specular",
        unit: "share",
        help: "Specular coefficient k_s of a smooth surface, 0..1",
        range: "0..1",
        trades: "",
        exact_end: "changes the meaning, not the error",
        get: |s| s.specular.to_string(),
        set: |s, t| {
            s.specular = number32(t, 0.0..=1.0)?;
            Ok(())
        },
    },
    SettingInfo {
        name: "shininess",
        unit: "exponent",
        help: "Exponent n of the specular term, 1..1000",
        range: "1..1000",
        trades: "",
        exact_end: "changes the meaning, not the error",
        get: |s| s.shininess.to_string(),
        set: |s, t| {
            s.shininess = number32(t, 1.0..=1000.0)?;
            Ok(())
        },
    },
    SettingInfo {
        name: "translucency",
        unit: "share",
        help: "Share of the sun's diffuse light that goes through leaves, 0..1; 0 is eq. 1 of the paper",
        range: "0..1",
        trades: "",
        exact_end: "0 is eq. 1 of the paper",
        get: |s| s.translucency.to_string(),
        set: |s, t| {
            s.translucency = number32(t, 0.0..=1.0)?;
            Ok(())
        },
    },
    SettingInfo {
        name: "flip-back-faces",
        unit: "on|off",
        help: "Turn realigned normals round on back faces, as glTF viewers do",
        range: "on, off",
        trades: "",
        exact_end: "changes the meaning, not the error",
        get: |s| switch_text(s.flip_back_faces),
        set: |s, t| {
            s.flip_back_faces = switch(t)?;
            Ok(())
        },
    },
    SettingInfo {
        name: "shadows",
        unit: "on|off",
        help: "The sun casts shadows",
        range: "on, off",
        trades: "shadows against the time and memory of the shadow map",
        exact_end: "on",
        get: |s| switch_text(s.shadows),
        set: |s, t| {
            s.shadows = switch(t)?;
            Ok(())
        },
    },
    SettingInfo {
        name: "shadow-size",
        unit: "texels",
        help: "Edge of the shadow map, 16..8192: finer shadows against time and memory",
        range: "16..8192",
        trades: "finer shadows against time and memory, both in proportion to the texels",
        exact_end: "none; 8192 is the closest",
        get: |s| s.shadow_size.to_string(),
        set: |s, t| {
            s.shadow_size = integer(t, 16..=8192)?;
            Ok(())
        },
    },
    SettingInfo {
        name: "shadow-fit",
        unit: "tight|sphere",
        help: "What the shadow map spans: the casters as the sun sees them, or the sphere around them, \
               coarser but the same from everywhere: no shimmer when the sun moves",
        range: "tight, sphere",
        trades: "texels as fine as the casters allow against a map that keeps its scale when the sun moves",
        exact_end: "none; tight is the closer",
        get: |s| match s.shadow_fit {
            ShadowFit::Tight => "tight".into(),
            ShadowFit::Sphere => "sphere".into(),
        },
        set: |s, t| {
            s.shadow_fit = match t {
                "tight" => ShadowFit::Tight,
                "sphere" => ShadowFit::Sphere,
                _ => {
                    return Err(Error::usage(format!("shadow fit `{t}`: tight or sphere")));
                }
            };
            Ok(())
        },
    },
    SettingInfo {
        name: "shadow-radius",
        unit: "texels",
        help: "Radius of the shadow filter, 0.5..16: softer edges against detail",
        range: "0.5..16",
        trades: "smooth edges of shadows against their detail",
        exact_end: "none: every map has texels; 0.5 filters least",
        get: |s| s.shadow_radius.to_string(),
        set: |s, t| {
            s.shadow_radius = number32(t, 0.5..=16.0)?;
            Ok(())
        },
    },
    SettingInfo {
        name: "textures",
        unit: "on|off",
        help: "Decode and use textures; off also leaves leaf cards uncut",
        range: "on, off",
        trades: "colour and outline of leaves against decoding, memory and time",
        exact_end: "on",
        get: |s| switch_text(s.textures),
        set: |s, t| {
            s.textures = switch(t)?;
            Ok(())
        },
    },
    SettingInfo {
        name: "texture-size",
        unit: "texels",
        help: "Longest texture edge that is used, 1..16384: sharpness against memory",
        range: "1..16384",
        trades: "sharpness against memory and decoding",
        exact_end: "the longest edge of the textures, or more",
        get: |s| s.texture_size.to_string(),
        set: |s, t| {
            s.texture_size = integer(t, 1..=16384)?;
            Ok(())
        },
    },
    SettingInfo {
        name: "anisotropy",
        unit: "ratio",
        help: "Largest ratio of anisotropic filtering, 1..16; 1 is off",
        range: "1..16",
        trades: "sharp textures at grazing angles against the time to sample them",
        exact_end: "none; 16 is the closest",
        get: |s| s.anisotropy.to_string(),
        set: |s, t| {
            s.anisotropy = number32(t, 1.0..=16.0)?;
            Ok(())
        },
    },
    SettingInfo {
        name: "leaf-outline",
        unit: "texels",
        help: "Cut leaf cards to the outline of all texture levels with edges of at least this, 0..1024: \
               fewer fragments against faint edges of leaves a few pixels across; 0 leaves them whole",
        range: "0..1024",
        trades: "fewer fragments against faint edges of leaves a few pixels across",
        exact_end: "0: whole cards",
        get: |s| s.leaf_outline.to_string(),
        set: |s, t| {
            s.leaf_outline = integer(t, 0..=1024)?;
            Ok(())
        },
    },
    SettingInfo {
        name: "ground",
        unit: "on|off",
        help: "A ground plane that receives the shadow",
        range: "on, off",
        trades: "",
        exact_end: "changes the meaning, not the error",
        get: |s| switch_text(s.ground),
        set: |s, t| {
            s.ground = switch(t)?;
            Ok(())
        },
    },
    SettingInfo {
        name: "background",
        unit: "neutral|sky|R,G,B|#rrggbb",
        help: "What stands behind the subject",
        range: "neutral, sky, or 0..1000000 each",
        trades: "",
        exact_end: "changes the meaning, not the error",
        get: |s| match s.background {
            Background::Neutral => "neutral".into(),
            Background::Sky => "sky".into(),
            Background::Color(c) => color_text(c),
        },
        set: |s, t| {
            s.background = match t {
                "neutral" => Background::Neutral,
                "sky" => Background::Sky,
                _ => Background::Color(color(t)?),
            };
            Ok(())
        },
    },
    SettingInfo {
        name: "encoding",
        unit: "packed|length|float",
        help: "Vertex form of normal and k_a: 8, 12 (the paper's) or 16 bytes",
        range: "packed, length, float",
        trades: "bytes per vertex against rounding of normal and k_a",
        exact_end: "float",
        get: |s| {
            match s.encoding {
                Encoding::Packed => "packed",
                Encoding::Length => "length",
                Encoding::Float => "float",
            }
            .into()
        },
        set: |s, t| {
            s.encoding = match t {
                "packed" => Encoding::Packed,
                "length" => Encoding::Length,
                "float" => Encoding::Float,
                _ => {
                    return Err(Error::usage(format!(
                        "encoding `{t}`: packed, length or float"
                    )));
                }
            };
            Ok(())
        },
    },
];

impl RenderSettings {
    /// Sets one setting of [`SETTINGS`] by name.
    ///
    /// # Errors
    /// An unknown name, or a value outside its range, naming both.
    pub fn set(&mut self, name: &str, value: &str) -> Result<()> {
        let info = SETTINGS
            .iter()
            .find(|i| i.name == name)
            .ok_or_else(|| Error::usage(format!("render setting `{name}` is unknown")))?;
        (info.set)(self, value).map_err(|e| Error::usage(format!("--{name}: {e}")))
    }

    /// Checks what single settings cannot.
    ///
    /// # Errors
    /// Names the setting and the range.
    pub fn check(&self) -> Result<()> {
        for info in SETTINGS {
            // Every value that a program can write must also be one that the table accepts.
            (info.set)(&mut self.clone(), &(info.get)(self))
                .map_err(|e| Error::usage(format!("--{}: {e}", info.name)))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_default_can_be_written_and_read_back() {
        let mut s = RenderSettings::default();
        for info in SETTINGS {
            s.set(info.name, &(info.get)(&RenderSettings::default()))
                .unwrap();
        }
        assert_eq!(s, RenderSettings::default());
        s.check().unwrap();
    }

    #[test]
    fn every_setting_says_its_range_and_its_exact_end() {
        for info in SETTINGS {
            for text in [info.range, info.exact_end] {
                assert!(!text.is_empty(), "{}", info.name);
            }
            let chooses = info.exact_end.contains("changes the meaning");
            assert!(
                chooses || info.name == "translucency" || !info.trades.is_empty(),
                "{}",
                info.name
            );
        }
    }

    #[test]
    fn values_outside_their_range_are_refused_by_name() {
        for (name, value) in [
            ("size", "0x600"),
            ("size", "800"),
            ("samples", "3"),
            ("shadow-size", "1"),
            ("fov", "180"),
            ("exposure", "0"),
            ("sun", "10"),
            ("sun", "0,91"),
            ("background", "#12345"),
            ("camera", "1,2,0"),
            ("translucency", "NaN"),
        ] {
            let e = RenderSettings::default().set(name, value).unwrap_err();
            assert!(e.to_string().contains(name), "{e}");
        }
    }
}
