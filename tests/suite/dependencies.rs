//! What the program is built from: declared crates are used, and come from where they should.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use toml::Table;

/// Crates whose types cross rooms: two versions of one would not fit together.
const SINGLE: &[&str] = &[
    "ash",
    "gpu-allocator",
    "glam",
    "image",
    "bytemuck",
    "serde_json",
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn table(file: &str) -> Table {
    let text = fs::read_to_string(root().join(file)).unwrap();
    toml::from_str(&text).unwrap_or_else(|e| panic!("{file}: {e}"))
}

/// Whether code below `folders` names the crate at the head of a path or in a macro.
fn is_named(name: &str, folders: &[&str]) -> bool {
    let word = name.replace('-', "_");
    let heads = [format!("{word}::"), format!("use {word};")];
    let mut open: Vec<_> = folders.iter().map(|f| root().join(f)).collect();
    while let Some(path) = open.pop() {
        if path.is_dir() {
            open.extend(fs::read_dir(path).unwrap().map(|e| e.unwrap().path()));
        } else if path.extension().is_some_and(|e| e == "rs") {
            let text = fs::read_to_string(&path).unwrap();
            let names = |line: &str| heads.iter().any(|head| line.contains(head.as_str()));
            if text
                .lines()
                .any(|line| !line.trim_start().starts_with("//") && names(line))
            {
                return true;
            }
        }
    }
    false
}

#[test]
fn every_declared_crate_is_used() {
    let manifest = table("Cargo.toml");
    for (section, folders) in [
        ("dependencies", &["src"][..]),
        ("dev-dependencies", &["src", "tests", "benches"]),
        ("build-dependencies", &["build.rs", "src/abi/gpu.rs"]),
    ] {
        let unused: Vec<&String> = manifest[section]
            .as_table()
            .unwrap()
            .keys()
            .filter(|name| !is_named(name, folders))
            .collect();
        assert!(
            unused.is_empty(),
            "[{section}] declares and nobody uses {unused:?}"
        );
    }
    assert!(!is_named("no-such-crate", &["src"]), "the search can fail");
}

#[test]
fn crates_come_from_the_registry_and_key_ones_once() {
    let lock = table("Cargo.lock");
    let mut versions: BTreeMap<&str, usize> = BTreeMap::new();
    for package in lock["package"].as_array().unwrap() {
        let name = package["name"].as_str().unwrap();
        *versions.entry(name).or_default() += 1;
        let source = package.get("source").and_then(|s| s.as_str());
        let known = match source {
            None => name == "umbrage",
            Some(source) => source.starts_with("registry+"),
        };
        assert!(known, "{name} comes from {source:?}");
    }
    for name in SINGLE {
        assert_eq!(
            versions.get(name),
            Some(&1),
            "{name}: versions in Cargo.lock"
        );
    }
}
