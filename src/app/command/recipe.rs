//! What a picture was drawn from: the arguments of `render` without the output and without what
//! every command takes. Drawings hold it; drawing again changes it option by option.

use std::path::{Path, PathBuf};

use clap::Args as _;

use crate::app::cli::{GlobalArgs, RenderArgs};

/// Models and options of `render`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Recipe {
    /// Models, as they were named.
    pub(super) inputs: Vec<String>,
    /// Options without their `--`, with their values.
    options: Vec<(String, Option<String>)>,
}

/// Options that are none of what is drawn.
const OUTPUT: &str = "output";
/// The option that may be given several times, once for each material.
const TEXTURE: &str = "texture";
/// Options whose values may name files, and the endings that say that they do.
const FILES: [(&str, &[&str]); 2] = [("style", &["toml"]), ("camera-path", &["toml", "json"])];

impl Recipe {
    /// Of this run of the program.
    pub(super) fn given() -> Self {
        let all = std::env::args_os().skip(1);
        Self::of(all.map(|a| a.to_string_lossy().into_owned()))
    }

    /// Of a command line without the program's name.
    pub(super) fn of(tokens: impl Iterator<Item = String>) -> Self {
        let command = RenderArgs::augment_args(clap::Command::new("render"));
        let globals = GlobalArgs::augment_args(clap::Command::new("umbrage"));
        let mut out = Self::default();
        let mut tokens = tokens.peekable();
        let (mut named, mut plain) = (false, false);
        while let Some(token) = tokens.next() {
            if plain || !token.starts_with('-') || token == "-" {
                // The first is the command's own name.
                if named {
                    out.inputs.push(token);
                }
                named = true;
                continue;
            }
            if token == "--" {
                plain = true;
                continue;
            }
            let (name, value) = match token.strip_prefix("--").map(|t| t.split_once('=')) {
                Some(Some((name, value))) => (name.to_owned(), Some(value.to_owned())),
                Some(None) => (token[2..].to_owned(), None),
                None => short(&token),
            };
            let known = |c: &clap::Command| {
                let found = c.get_arguments().find(|a| {
                    a.get_long() == Some(&name)
                        || a.get_short().map(String::from) == Some(name.clone())
                });
                found.map(|a| {
                    let long = a.get_long().unwrap_or(&name).to_owned();
                    (long, a.get_action().takes_values())
                })
            };
            let own = known(&command);
            let Some((long, takes)) = own.clone().or_else(|| known(&globals)) else {
                continue;
            };
            let value = match value {
                None if takes => tokens.next(),
                value => value,
            };
            if own.is_some() && long != OUTPUT {
                out.options.push((long, value));
            }
        }
        out
    }

    /// Names of its options, without their `--`.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.options.iter().map(|o| o.0.as_str())
    }

    /// The value of an option.
    pub(super) fn value(&self, name: &str) -> Option<&str> {
        let found = self.options.iter().rfind(|o| o.0 == name);
        found.and_then(|o| o.1.as_deref())
    }

    /// Puts an option in the place of the same.
    pub(super) fn set(&mut self, name: &str, value: Option<String>) {
        let material = |v: &Option<String>| -> Option<String> {
            let (material, _) = v.as_deref()?.split_once('=')?;
            Some(material.to_owned())
        };
        let wanted = material(&value);
        self.options
            .retain(|o| o.0 != name || (name == TEXTURE && material(&o.1) != wanted));
        self.options.push((name.to_owned(), value));
    }

    /// Itself, with the options of another in place of its own.
    pub(super) fn changed(mut self, by: &Self) -> Self {
        for (name, value) in &by.options {
            self.set(name, value.clone());
        }
        self
    }

    /// Itself, of one frame of a sequence.
    pub(super) fn of_frame(mut self, frame: Option<u32>) -> Self {
        if let Some(frame) = frame {
            self.set("frames", Some(format!("{frame}..{frame}")));
        }
        self
    }

    /// Itself, with every name of a file as `change` says: given are the name and whether it must
    /// be there to draw.
    ///
    /// # Errors
    /// Those of `change`.
    pub(super) fn with_files<E>(
        mut self,
        mut change: impl FnMut(&Path, bool) -> Result<PathBuf, E>,
    ) -> Result<Self, E> {
        let text = |path: PathBuf| path.to_string_lossy().into_owned();
        for input in self.inputs.iter_mut().filter(|i| !i.starts_with("grow:")) {
            *input = text(change(Path::new(input), true)?);
        }
        for (name, value) in &mut self.options {
            let Some(value) = value else { continue };
            if name == TEXTURE
                && let Some((material, file)) = value.split_once('=')
            {
                let file = change(Path::new(file), true)?;
                *value = format!("{material}={}", text(file));
            }
            let is_file = |ending: &&str| {
                Path::new(value.as_str())
                    .extension()
                    .is_some_and(|e| e.eq_ignore_ascii_case(ending))
            };
            let known = FILES.iter().find(|f| f.0 == name);
            if known.is_some_and(|f| f.1.iter().any(is_file)) {
                // The style itself is in the drawing.
                *value = text(change(Path::new(value), name != "style")?);
            }
        }
        Ok(self)
    }

    /// The arguments, without the program's name.
    pub(super) fn arguments(&self) -> Vec<String> {
        let mut out = vec!["render".to_owned()];
        out.extend(self.inputs.iter().cloned());
        for (name, value) in &self.options {
            match value {
                Some(value) if value.starts_with('-') => out.push(format!("--{name}={value}")),
                Some(value) => out.extend([format!("--{name}"), value.clone()]),
                None => out.push(format!("--{name}")),
            }
        }
        out
    }
}

/// A short option and the value that hangs on it.
fn short(token: &str) -> (String, Option<String>) {
    let name = token.chars().nth(1).map(String::from).unwrap_or_default();
    let rest = &token[1 + name.len()..];
    let value = rest.strip_prefix('=').unwrap_or(rest);
    (name, (!value.is_empty()).then(|| value.to_owned()))
}

/// `path` as it is named from within `folder`; absolute ones stay, and those that have no way there.
pub(super) fn from_within(folder: &Path, path: &Path) -> PathBuf {
    if path.is_absolute() {
        return path.to_owned();
    }
    relative(folder, path).unwrap_or_else(|| path.to_owned())
}

/// The way from `folder` to `path`, both of which may have links and `..` in them.
pub(super) fn relative(folder: &Path, path: &Path) -> Option<PathBuf> {
    let real = |folder: Option<&Path>| {
        let folder = folder.filter(|f| *f != Path::new(""));
        folder.unwrap_or(Path::new(".")).canonicalize().ok()
    };
    let to = real(path.parent())?.join(path.file_name()?);
    let from = real(Some(folder))?;
    let common = to.components().zip(from.components());
    let common = common.take_while(|(a, b)| a == b).count();
    if common == 0 {
        return None;
    }
    let up = from.components().skip(common).map(|_| "..");
    let mut out: PathBuf = up.collect();
    out.extend(to.components().skip(common));
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(line: &str) -> Recipe {
        Recipe::of(line.split(' ').map(str::to_owned))
    }

    #[test]
    fn the_output_and_what_every_command_takes_are_no_part_of_what_is_drawn() {
        let line = "--json render a.glb -o a.svg --style ds00-fig3a --output=b.svg --output c \
                    --device lava -vq --validate -oc.svg --sun=-60,30 --camera -5,7";
        let kept = of(line).arguments();
        assert_eq!(
            kept,
            [
                "render",
                "a.glb",
                "--style",
                "ds00-fig3a",
                "--sun=-60,30",
                "--camera=-5,7"
            ]
        );
        assert_eq!(of(&kept.join(" ")).arguments(), kept, "comes back");
    }

    #[test]
    fn options_take_the_place_of_the_same() {
        let old = of("render a.glb --texture A=a.png --texture B=b.png --paper a4 --frames 2..9");
        let new = of("render x.svg --paper=a5 --texture B=c.png --profile edit");
        let both = old.changed(&new).of_frame(Some(4)).arguments().join(" ");
        assert_eq!(
            both,
            "render a.glb --texture A=a.png --paper a5 --texture B=c.png --profile edit --frames 4..4"
        );
    }

    #[test]
    fn names_of_files_are_found_and_changed() {
        let recipe = of(
            "render grow:lime a.glb --texture A=b.png --style c.toml --camera-path orbit --paper a4",
        );
        let mut needed = Vec::new();
        let moved = recipe.with_files(|p, need| {
            needed.push(need);
            Ok::<_, ()>(Path::new("x").join(p))
        });
        assert_eq!(
            moved.unwrap().arguments().join(" "),
            "render grow:lime x/a.glb --texture A=x/b.png --style x/c.toml --camera-path orbit --paper a4"
        );
        assert_eq!(needed, [true, true, false]);
    }

    #[test]
    fn ways_between_folders_go_up_and_down() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        std::fs::create_dir_all(at("out/deep")).unwrap();
        std::fs::create_dir_all(at("models")).unwrap();
        let way = |folder: &str, path: &str| relative(&at(folder), &at(path)).unwrap();
        assert_eq!(
            way("out/deep", "models/a.glb"),
            Path::new("../../models/a.glb")
        );
        assert_eq!(way("out", "out/deep/../a.glb"), Path::new("a.glb"));
        assert_eq!(way("", "a.glb"), Path::new("a.glb"));
    }
}
