//! Results kept between runs, found by a hash of everything they depend on.
//!
//! An entry is a file with a header (what it is, version, length) and a BLAKE3 checksum of its
//! content. Whatever does not match in every byte is recomputed, never trusted. A cache that
//! cannot be written costs time, not the result.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::output::write_atomically;

/// First bytes of every entry.
const MAGIC: [u8; 8] = *b"umbrage\0";

/// Bytes before the content: magic, kind, version, key, length, checksum.
const HEADER: usize = 8 + 4 + 4 + 32 + 8 + 32;

/// Bytes that the entries of one kind may take together; beyond, those used longest ago go.
const MOST_BYTES: u64 = 1 << 30;

/// A kind of result, with the version of its file form.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kind {
    /// Four letters in the header and the extension of the file.
    pub tag: [u8; 4],
    /// Raised whenever the content's form or the computation changes.
    pub version: u32,
}

impl Kind {
    fn extension(self) -> String {
        String::from_utf8_lossy(&self.tag).trim().to_owned()
    }
}

/// The folder of results, or none.
#[derive(Debug, Clone)]
pub struct Cache {
    folder: Option<PathBuf>,
}

impl Cache {
    /// A cache in `folder`; `None` keeps and finds nothing.
    #[must_use]
    pub fn new(folder: Option<PathBuf>) -> Self {
        Self { folder }
    }

    /// `$XDG_CACHE_HOME/umbrage`, else `$HOME/.cache/umbrage`, else none.
    #[must_use]
    pub fn default_folder() -> Option<PathBuf> {
        let set = |name| {
            std::env::var_os(name)
                .filter(|v| !v.is_empty())
                .map(PathBuf::from)
        };
        set("XDG_CACHE_HOME")
            .filter(|p| p.is_absolute())
            .or_else(|| set("HOME").map(|home| home.join(".cache")))
            .map(|cache| cache.join("umbrage"))
    }

    /// The folder, if results are kept.
    #[must_use]
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// The content kept under `key`, if it is whole.
    #[must_use]
    pub fn load(&self, kind: Kind, key: &blake3::Hash) -> Option<Vec<u8>> {
        let path = self.path(kind, key)?;
        let bytes = fs::read(&path).ok()?;
        match content(&bytes, kind, key) {
            Ok(content) => {
                log::debug!("cache: {} read", path.display());
                // Used now; where that cannot be noted the entry only ages faster.
                let _ = fs::File::options()
                    .append(true)
                    .open(&path)
                    .and_then(|file| file.set_modified(SystemTime::now()));
                Some(content.to_vec())
            }
            Err(reason) => {
                log::warn!("cache: {}: {reason}; computed anew", path.display());
                None
            }
        }
    }

    /// Keeps `content` under `key`.
    pub fn store(&self, kind: Kind, key: &blake3::Hash, content: &[u8]) {
        let Some(path) = self.path(kind, key) else {
            return;
        };
        let mut bytes = header(kind, key, content);
        bytes.extend_from_slice(content);
        let folder = path.parent().expect("an entry is in a folder");
        let kept = fs::create_dir_all(folder)
            .map_err(|e| crate::Error::file(folder, e))
            .and_then(|()| write_atomically(&path, &bytes));
        match kept {
            Ok(()) => prune(folder, &kind.extension(), MOST_BYTES),
            Err(error) => log::warn!("cache: {error}"),
        }
    }

    fn path(&self, kind: Kind, key: &blake3::Hash) -> Option<PathBuf> {
        let name = format!("{}.{}", key.to_hex(), kind.extension());
        self.folder.as_ref().map(|folder| folder.join(name))
    }
}

/// Removes the files with `extension` that were used longest ago until the others fit into `most`
/// bytes. Never the newest: it was asked for just now.
fn prune(folder: &Path, extension: &str, most: u64) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<(SystemTime, u64, PathBuf)> = entries
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|e| e == extension))
        .filter_map(|path| {
            let metadata = fs::metadata(&path).ok()?;
            Some((metadata.modified().ok()?, metadata.len(), path))
        })
        .collect();
    files.sort_unstable_by(|a, b| b.cmp(a));
    let mut bytes = 0;
    for (i, (_, length, path)) in files.iter().enumerate() {
        bytes += length;
        if i > 0 && bytes > most {
            log::debug!("cache: {} makes room", path.display());
            // Another run may have removed it already.
            let _ = fs::remove_file(path);
        }
    }
}

fn header(kind: Kind, key: &blake3::Hash, content: &[u8]) -> Vec<u8> {
    let mut out = Vec::with_capacity(HEADER + content.len());
    out.extend_from_slice(&MAGIC);
    out.extend_from_slice(&kind.tag);
    out.extend_from_slice(&kind.version.to_le_bytes());
    out.extend_from_slice(key.as_bytes());
    out.extend_from_slice(&(content.len() as u64).to_le_bytes());
    out.extend_from_slice(blake3::hash(content).as_bytes());
    out
}

/// The content of an entry, or why it is not trusted.
fn content<'a>(bytes: &'a [u8], kind: Kind, key: &blake3::Hash) -> Result<&'a [u8], &'static str> {
    let (head, content) = bytes.split_at_checked(HEADER).ok_or("too short")?;
    if head != header(kind, key, content) {
        return Err("damaged, or of another version");
    }
    Ok(content)
}

#[cfg(test)]
mod tests {
    use super::*;

    const KIND: Kind = Kind {
        tag: *b"test",
        version: 1,
    };

    #[test]
    fn what_is_stored_is_found_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let cache = Cache::new(Some(folder.path().join("deep/er")));
        let key = blake3::hash(b"key");
        assert_eq!(cache.load(KIND, &key), None, "nothing yet");
        cache.store(KIND, &key, b"content");
        assert_eq!(
            cache.load(KIND, &key).as_deref(),
            Some(&b"content"[..]),
            "found"
        );
        assert_eq!(
            cache.load(KIND, &blake3::hash(b"other")),
            None,
            "another key"
        );
        let newer = Kind { version: 2, ..KIND };
        assert_eq!(cache.load(newer, &key), None, "another version");
    }

    #[test]
    fn no_damaged_byte_is_trusted() {
        let folder = tempfile::tempdir().unwrap();
        let cache = Cache::new(Some(folder.path().to_owned()));
        let key = blake3::hash(b"key");
        cache.store(KIND, &key, b"content");
        let path = cache.path(KIND, &key).unwrap();
        let whole = fs::read(&path).unwrap();
        for i in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[i] ^= 0x10;
            fs::write(&path, damaged).unwrap();
            assert_eq!(cache.load(KIND, &key), None, "byte {i}");
        }
        for length in 0..whole.len() {
            fs::write(&path, &whole[..length]).unwrap();
            assert_eq!(cache.load(KIND, &key), None, "cut to {length}");
        }
        fs::write(&path, [&whole[..], b"x"].concat()).unwrap();
        assert_eq!(cache.load(KIND, &key), None, "one byte more");
    }

    #[test]
    fn what_was_used_longest_ago_makes_room() {
        let folder = tempfile::tempdir().unwrap();
        for (age, name) in [(3, "a.bake"), (1, "b.bake"), (2, "c.bake"), (9, "d.bin")] {
            let path = folder.path().join(name);
            fs::write(&path, [0; 10]).unwrap();
            let used = SystemTime::now() - std::time::Duration::from_secs(age);
            let file = fs::File::options().append(true).open(&path).unwrap();
            file.set_modified(used).unwrap();
        }
        let names = || {
            let entries = fs::read_dir(folder.path()).unwrap();
            let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name()).collect();
            names.sort();
            names
        };
        prune(folder.path(), "bake", 30);
        assert_eq!(names().len(), 4, "all fit");
        prune(folder.path(), "bake", 20);
        assert_eq!(names(), ["b.bake", "c.bake", "d.bin"], "the oldest goes");
        prune(folder.path(), "bake", 1);
        assert_eq!(names(), ["b.bake", "d.bin"], "the newest stays");
    }

    #[test]
    fn an_unwritable_cache_is_no_error() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, b"").unwrap();
        let cache = Cache::new(Some(file));
        cache.store(KIND, &blake3::hash(b"key"), b"content");
        assert_eq!(cache.load(KIND, &blake3::hash(b"key")), None, "not kept");
        assert_eq!(Cache::new(None).folder(), None, "off");
    }
}
