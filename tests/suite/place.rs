//! A folder in which a test runs the program.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// A folder of its own for inputs, outputs and the cache.
pub(crate) struct Place(tempfile::TempDir);

impl Place {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> String {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, bytes).unwrap();
        path.to_str().unwrap().to_owned()
    }

    /// Runs the program here, under validation.
    pub(crate) fn umbrage(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_umbrage"))
            .args(arguments)
            .current_dir(self.0.path())
            .env("XDG_CACHE_HOME", self.path("cache"))
            .output()
            .expect("the program starts")
    }

    /// Runs the program here with a variable of the environment.
    pub(crate) fn umbrage_with(&self, arguments: &[&str], variable: &str, value: &str) -> Output {
        Command::new(env!("CARGO_BIN_EXE_umbrage"))
            .args(arguments)
            .current_dir(self.0.path())
            .env("XDG_CACHE_HOME", self.path("cache"))
            .env(variable, value)
            .output()
            .expect("the program starts")
    }

    /// Runs the program where the loader finds no driver.
    pub(crate) fn umbrage_without_driver(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_umbrage"))
            .args(arguments)
            .current_dir(self.0.path())
            .env("XDG_CACHE_HOME", self.path("cache"))
            .env("VK_DRIVER_FILES", "/nonexistent.json")
            .env("VK_ICD_FILENAMES", "/nonexistent.json")
            .output()
            .expect("the program starts")
    }

    /// Runs the program, which succeeds, and gives its JSON.
    pub(crate) fn json(&self, arguments: &[&str]) -> Value {
        let output = self.umbrage(&[arguments, &["--json"]].concat());
        assert_eq!(
            output.status.code(),
            Some(0),
            "{arguments:?}: {}",
            stderr(&output)
        );
        serde_json::from_slice(&output.stdout).unwrap()
    }

    /// Exit code 2, one line on stderr with every one of `words`, and no new file.
    pub(crate) fn assert_refused(&self, arguments: &[&str], words: &[&str]) {
        let before = files(self.0.path());
        let output = self.umbrage(arguments);
        let text = stderr(&output);
        // What was repaired on the way to the error may be told before it.
        let lines = text.lines().filter(|line| !line.starts_with("warning: "));
        let text = lines.collect::<Vec<_>>().join("\n");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert_eq!(text.lines().count(), 1, "{arguments:?}: one line: {text}");
        assert!(text.starts_with("umbrage: "), "{arguments:?}: {text}");
        for word in words {
            assert!(text.contains(word), "{arguments:?}: {word:?} in {text}");
        }
        assert_eq!(
            files(self.0.path()),
            before,
            "{arguments:?}: no file is left"
        );
    }

    /// `bake` of the broken model `bytes` is refused with every one of `words`.
    pub(crate) fn assert_model_refused(&self, name: &str, bytes: impl AsRef<[u8]>, words: &[&str]) {
        let file = self.write(name, bytes);
        let words = [&[name], words].concat();
        self.assert_refused(&["bake", &file, "-o", "out.glb"], &words);
    }
}

/// Every file below `folder`, without the program's cache.
pub(crate) fn files(folder: &Path) -> Vec<PathBuf> {
    let mut out = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.ends_with("cache") {
            continue;
        }
        if path.is_dir() {
            out.extend(files(&path));
        } else {
            out.push(path);
        }
    }
    out.sort();
    out
}

pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}
