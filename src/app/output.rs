//! Files the program writes: whole, or not at all.
//!
//! A [`PendingFile`] is made before the long work starts, so that an unwritable place is told at
//! once; it holds a temporary file in the same folder, which is renamed over the wanted name only
//! when everything is in it. A failure, a panic or Ctrl-C removes it.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use crate::{Error, Result};

/// Temporary files that exist at the moment, for the interrupt handler.
static TEMPORARY: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Exit code of a program ended by Ctrl-C, by the shell's convention (128 + SIGINT).
const INTERRUPTED: i32 = 130;

/// A file under way to its final name.
#[derive(Debug)]
pub struct PendingFile {
    path: PathBuf,
    temporary: PathBuf,
    file: Option<File>,
}

impl PendingFile {
    /// Reserves `path`: makes the temporary file beside it.
    ///
    /// # Errors
    /// The folder is missing or cannot be written, or `path` is a folder or a read-only file.
    pub fn create(path: &Path) -> Result<Self> {
        let name = path
            .file_name()
            .ok_or_else(|| Error::file(path, "output: is not the name of a file"))?;
        match fs::metadata(path) {
            Ok(m) if m.is_dir() => return Err(Error::file(path, "output: is a folder")),
            Ok(m) if m.permissions().readonly() => {
                return Err(Error::file(path, "output: exists and is read-only"));
            }
            _ => {}
        }
        let temporary = path.with_file_name(format!(
            ".{}.{}.partial",
            name.to_string_lossy(),
            std::process::id()
        ));
        // Made and registered in one go, so that an interrupt finds both or neither.
        let mut registered = registry();
        let file = File::create(&temporary).map_err(|e| unwritable(path, &e))?;
        registered.insert(temporary.clone());
        drop(registered);
        Ok(Self {
            path: path.to_owned(),
            temporary,
            file: Some(file),
        })
    }

    /// Where the file will be.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes `bytes` to the disk and gives the file its name.
    ///
    /// # Errors
    /// The disk is full, or the rename is refused; nothing is left then.
    pub fn commit(mut self, bytes: &[u8]) -> Result<()> {
        let mut file = self.file.take().expect("present until committed");
        file.write_all(bytes)
            .and_then(|()| file.sync_all())
            .map_err(|e| unwritable(&self.path, &e))?;
        drop(file);
        fs::rename(&self.temporary, &self.path).map_err(|e| unwritable(&self.path, &e))
    }
}

impl Drop for PendingFile {
    fn drop(&mut self) {
        // After a commit the temporary name is gone already.
        let _ = fs::remove_file(&self.temporary);
        registry().remove(&self.temporary);
    }
}

/// Refuses a name whose ending is none of `endings`: what is written is what the name says.
///
/// # Errors
/// Names the endings.
pub fn check_ending(path: &Path, endings: &[&str]) -> Result<()> {
    let extension = path.extension().unwrap_or_default();
    if endings.iter().any(|e| extension.eq_ignore_ascii_case(e)) || path.is_dir() {
        // A folder has a message of its own.
        return Ok(());
    }
    let endings: Vec<String> = endings.iter().map(|e| format!(".{e}")).collect();
    let reason = format!("output: the name must end in {}", endings.join(" or "));
    Err(Error::file(path, reason))
}

/// Refuses to write over one of `inputs`.
///
/// # Errors
/// `path` is one of them, by whatever name.
pub fn check_apart<'a>(path: &Path, inputs: impl IntoIterator<Item = &'a Path>) -> Result<()> {
    let Ok(output) = fs::canonicalize(path) else {
        return Ok(());
    };
    let same = |input: &&Path| fs::canonicalize(input).is_ok_and(|i| i == output);
    match inputs.into_iter().find(same) {
        Some(_) => Err(Error::file(
            path,
            "output: is an input too and would be overwritten; choose another name",
        )),
        None => Ok(()),
    }
}

/// Makes `folder` and sees whether files can be made in it.
///
/// # Errors
/// Says why not.
pub fn check_folder(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).map_err(|e| Error::file(folder, e))?;
    let probe = folder.join(format!(".{}.probe", std::process::id()));
    let made = File::create(&probe).map_err(|e| Error::file(folder, e));
    // Gone at once; when it was not made there is nothing to remove.
    let _ = fs::remove_file(&probe);
    made.map(|_| ())
}

/// Writes `bytes` to `path`, whole or not at all.
///
/// # Errors
/// As [`PendingFile::create`] and [`PendingFile::commit`].
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<()> {
    PendingFile::create(path)?.commit(bytes)
}

/// Removes half-written files when the user presses Ctrl-C or the process is asked to end.
pub fn remove_on_interrupt() {
    let installed = ctrlc::set_handler(|| {
        // Held until the end: no other thread makes a file in between.
        let registered = registry();
        for path in registered.iter() {
            let _ = fs::remove_file(path);
        }
        std::process::exit(INTERRUPTED);
    });
    if let Err(error) = installed {
        log::debug!("no interrupt handler: {error}");
    }
}

fn registry() -> std::sync::MutexGuard<'static, BTreeSet<PathBuf>> {
    TEMPORARY.lock().unwrap_or_else(PoisonError::into_inner)
}

fn unwritable(path: &Path, error: &std::io::Error) -> Error {
    Error::file(path, format!("output: cannot be written: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_committed_file_is_whole_and_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        fs::write(&path, b"old").unwrap();
        let pending = PendingFile::create(&path).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"old", "untouched until commit");
        pending.commit(b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new", "replaced by commit");
        assert_eq!(entries(folder.path()), ["a.bin"], "no temporary file");
    }

    #[test]
    fn an_abandoned_file_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        drop(PendingFile::create(&folder.path().join("a.bin")).unwrap());
        assert!(entries(folder.path()).is_empty(), "temporary file removed");
    }

    #[test]
    fn names_say_what_is_written() {
        for good in ["a.png", "b/a.JPG"] {
            check_ending(Path::new(good), &["png", "jpg"]).unwrap();
        }
        for bad in ["a.bmp", "a", "png", ".png"] {
            let error = check_ending(Path::new(bad), &["png", "jpg"]).expect_err(bad);
            assert!(error.to_string().contains(".png or .jpg"), "{error}");
        }
    }

    #[test]
    fn an_input_is_not_written_over_by_whatever_name() {
        let folder = tempfile::tempdir().unwrap();
        let input = folder.path().join("a.glb");
        fs::write(&input, b"x").unwrap();
        let around = folder.path().join(".").join("a.glb");
        assert!(check_apart(&around, [&*input]).is_err(), "the same file");
        check_apart(&folder.path().join("b.glb"), [&*input]).unwrap();
        fs::write(folder.path().join("b.glb"), b"x").unwrap();
        check_apart(&folder.path().join("b.glb"), [&*input]).unwrap();
    }

    #[test]
    fn unwritable_places_are_told_at_once() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("file"), b"x").unwrap();
        for bad in ["missing/a.bin", "file/a.bin", "", ".."] {
            let error = PendingFile::create(&folder.path().join(bad)).expect_err(bad);
            assert_eq!(error.exit_code(), 2, "{error}");
        }
        assert_eq!(entries(folder.path()), ["file"], "nothing was made");
    }
}
