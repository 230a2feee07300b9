//! Wavefront MTL: the few statements that umbrage draws.

use super::json::Check;

/// A `newmtl` block.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct MtlMaterial {
    pub(super) name: String,
    /// `Kd`, display-referred (sRGB) as modelling programs write it.
    pub(super) diffuse: Option<[f32; 3]>,
    /// `Ke`.
    pub(super) emissive: Option<[f32; 3]>,
    /// `d`, or one minus `Tr`.
    pub(super) opacity: Option<f32>,
    /// `Ns`.
    pub(super) shininess: Option<f32>,
    /// `map_Kd`.
    pub(super) diffuse_map: Option<Map>,
    /// `map_d`.
    pub(super) opacity_map: Option<Map>,
}

/// A texture statement.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Map {
    pub(super) file: String,
    /// `-s u v`.
    pub(super) scale: [f32; 2],
    /// `-o u v`.
    pub(super) offset: [f32; 2],
    /// `-clamp on`.
    pub(super) clamp: bool,
}

/// Reads all materials.
pub(super) fn parse(text: &str) -> Check<Vec<MtlMaterial>> {
    let mut out: Vec<MtlMaterial> = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let line = line.trim();
        let (key, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        if key == "newmtl" {
            out.push(MtlMaterial {
                name: rest.to_owned(),
                ..MtlMaterial::default()
            });
        } else if let Some(material) = out.last_mut() {
            material
                .statement(key, rest)
                .map_err(|e| format!("line {}: {key}: {e}", i + 1))?;
        }
    }
    Ok(out)
}

impl MtlMaterial {
    fn statement(&mut self, key: &str, rest: &str) -> Check<()> {
        match key {
            "Kd" => self.diffuse = Some(color(rest)?),
            "Ke" => self.emissive = Some(color(rest)?),
            "d" => self.opacity = Some(number(last(rest))?.clamp(0.0, 1.0)),
            "Tr" => self.opacity = Some(1.0 - number(last(rest))?.clamp(0.0, 1.0)),
            "Ns" => self.shininess = Some(number(last(rest))?.max(0.0)),
            "map_Kd" => self.diffuse_map = map(rest)?,
            "map_d" => self.opacity_map = map(rest)?,
            _ => {}
        }
        Ok(())
    }
}

/// The value after options such as `-halo`.
fn last(rest: &str) -> &str {
    rest.split_whitespace().last().unwrap_or_default()
}

fn number(word: &str) -> Check<f32> {
    word.parse::<f32>()
        .ok()
        .filter(|v| v.is_finite())
        .ok_or_else(|| format!("\"{word}\" is not a number"))
}

/// `r g b`, or `r` for grey. Spectral curves and CIE values are not read.
fn color(rest: &str) -> Check<[f32; 3]> {
    if rest.starts_with("spectral") || rest.starts_with("xyz") {
        return Ok([1.0; 3]);
    }
    let v: Vec<f32> = rest.split_whitespace().map(number).collect::<Check<_>>()?;
    match v[..] {
        [r, g, b, ..] => Ok([r, g, b]),
        [grey] => Ok([grey; 3]),
        _ => Err("needs three numbers".into()),
    }
}

/// Options, then a file name that may contain spaces.
fn map(rest: &str) -> Check<Option<Map>> {
    let mut out = Map {
        file: String::new(),
        scale: [1.0; 2],
        offset: [0.0; 2],
        clamp: false,
    };
    let mut left = rest;
    while left.starts_with('-') {
        let (option, after) = word(left);
        left = after;
        let most = match option {
            "-o" | "-s" | "-t" => 3,
            "-mm" => 2,
            "-blendu" | "-blendv" | "-boost" | "-bm" | "-cc" | "-clamp" | "-imfchan"
            | "-texres" | "-type" => 1,
            _ => return Err(format!("the option {option} does not exist")),
        };
        let mut values = Vec::new();
        let numeric = matches!(
            option,
            "-o" | "-s" | "-t" | "-mm" | "-boost" | "-bm" | "-texres"
        );
        while values.len() < most {
            let (value, after) = word(left);
            // The second and third numbers of -o, -s, -t may be left out.
            if value.is_empty() || (numeric && value.parse::<f32>().is_err()) {
                break;
            }
            values.push(value);
            left = after;
        }
        let number_at = |i: usize, or: f32| values.get(i).map_or(Ok(or), |v| number(v));
        match option {
            "-s" => out.scale = [number_at(0, 1.0)?, number_at(1, 1.0)?],
            "-o" => out.offset = [number_at(0, 0.0)?, number_at(1, 0.0)?],
            "-clamp" => out.clamp = values == ["on"],
            _ => {}
        }
    }
    out.file = left.trim().trim_matches('"').replace('\\', "/");
    Ok(Some(out).filter(|m| !m.file.is_empty()))
}

fn word(text: &str) -> (&str, &str) {
    let text = text.trim_start();
    match text.split_once(char::is_whitespace) {
        Some((word, rest)) => (word, rest.trim_start()),
        None => (text, ""),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_before_a_file_name_with_spaces() {
        let m = map("-blendu on -s 2 3 -o 0.5 -clamp on my maps\\Oak leaf.png")
            .unwrap()
            .unwrap();
        assert_eq!(m.file, "my maps/Oak leaf.png");
        assert_eq!((m.scale, m.offset, m.clamp), ([2.0, 3.0], [0.5, 0.0], true));
        assert!(map("-q 1 x.png").is_err());
        assert_eq!(map("").unwrap(), None);
    }

    #[test]
    fn statements_and_faulty_lines() {
        let m = parse("# c\nnewmtl A b\n\tKd 0.5 0.25 1\nd -halo 0.5\nNs 96\nnewmtl C\nTr 0.25")
            .unwrap();
        assert_eq!((m[0].name.as_str(), m[0].opacity), ("A b", Some(0.5)));
        assert_eq!(
            (m[0].diffuse, m[1].opacity),
            (Some([0.5, 0.25, 1.0]), Some(0.75))
        );
        let e = parse("newmtl x\nKd 1 y 1").unwrap_err();
        assert!(e.contains("line 2") && e.contains("\"y\""), "{e}");
    }
}
