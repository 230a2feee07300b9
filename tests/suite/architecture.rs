//! The house keeps its order: which room may use which, and where `unsafe`, Vulkan, glTF and
//! printing may stand. The scanner reads the sources; the tests at the end prove that it sees.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Rooms and the rooms they may use. `app` may use all.
const ROOMS: &[(&str, &[&str])] = &[
    ("error", &[]),
    ("abi", &[]),
    ("math", &["error"]),
    ("scene", &["math", "error"]),
    ("gpu", &["abi", "error"]),
    ("reference", &["math", "scene", "abi", "error"]),
    ("foliage", &["gpu", "scene", "math", "abi", "error"]),
    ("leaf", &["gpu", "scene", "math", "abi", "error"]),
    ("ink", &["gpu", "scene", "math", "abi", "error"]),
    (
        "render",
        &[
            "foliage", "leaf", "ink", "gpu", "scene", "math", "abi", "error",
        ],
    ),
    (
        "app",
        &[
            "render",
            "foliage",
            "leaf",
            "ink",
            "reference",
            "gpu",
            "scene",
            "math",
            "abi",
            "error",
        ],
    ),
];

/// What may stand only in files whose path begins with one of the given prefixes.
const CONFINED: &[(&str, &[&str])] = &[
    ("unsafe", &["src/gpu/"]),
    ("ash", &["src/gpu/"]),
    ("vk", &["src/gpu/"]),
    ("gpu_allocator", &["src/gpu/"]),
    ("gltf", &["src/scene/import/", "src/scene/export/"]),
    ("clap", &["src/app/"]),
    ("indicatif", &["src/app/"]),
    ("println", &["src/app/console.rs"]),
    ("eprintln", &["src/app/console.rs"]),
    ("print", &["src/app/console.rs"]),
    ("eprint", &["src/app/console.rs"]),
    ("unwrap", &[]),
    // Only the commands that compare with the twins know them.
    (
        "reference",
        &[
            "src/reference/",
            "src/lib.rs",
            "src/app/conform/",
            "src/app/tradeoff",
        ],
    ),
];

/// Lines of a source file at most.
const LONGEST_FILE: usize = 600;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Files below `folder` with one of `extensions`, as (path relative to the root, text).
fn files(folder: &str, extensions: &[&str]) -> Vec<(String, String)> {
    let mut out = Vec::new();
    let mut open = vec![root().join(folder)];
    while let Some(folder) = open.pop() {
        let mut entries: Vec<PathBuf> = fs::read_dir(&folder)
            .unwrap_or_else(|e| panic!("{}: {e}", folder.display()))
            .map(|entry| entry.unwrap().path())
            .collect();
        entries.sort();
        for path in entries {
            let extension = path.extension().unwrap_or_default().to_string_lossy();
            if path.is_dir() {
                open.push(path);
            } else if extensions.contains(&&*extension) {
                let name = path.strip_prefix(root()).unwrap();
                let text = fs::read_to_string(&path).unwrap();
                out.push((name.to_string_lossy().into_owned(), text));
            }
        }
    }
    out
}

/// Words and punctuation of Rust code with line numbers; comments and literals are left out.
fn tokens(text: &str) -> Vec<(usize, String)> {
    let c: Vec<char> = text.chars().collect();
    let word = |x: char| x.is_alphanumeric() || x == '_';
    let (mut i, mut line, mut out) = (0, 1, Vec::new());
    while i < c.len() {
        let start = i;
        let rest = |n: usize| c.get(i + n).copied().unwrap_or('\0');
        match c[i] {
            '/' if rest(1) == '/' => i = skip_while(&c, i, |x| x != '\n'),
            '/' if rest(1) == '*' => i = block_comment(&c, i),
            '"' => i = string(&c, i),
            'r' if raw_string_hashes(&c, i).is_some() => {
                i = raw_string(&c, i, raw_string_hashes(&c, i).unwrap());
            }
            // A character literal, not a lifetime: 'x' or '\n'.
            '\'' if rest(1) == '\\' => i = skip_while(&c, i + 3, |x| x != '\'') + 1,
            '\'' if rest(2) == '\'' => i += 3,
            x if word(x) => {
                i = skip_while(&c, i, word);
                out.push((line, c[start..i].iter().collect()));
            }
            ':' if rest(1) == ':' => {
                i += 2;
                out.push((line, "::".into()));
            }
            x => {
                i += 1;
                if !x.is_whitespace() {
                    out.push((line, x.into()));
                }
            }
        }
        line += c[start..i.min(c.len())]
            .iter()
            .filter(|&&x| x == '\n')
            .count();
    }
    out
}

fn skip_while(c: &[char], from: usize, keep: impl Fn(char) -> bool) -> usize {
    (from..c.len()).find(|&i| !keep(c[i])).unwrap_or(c.len())
}

fn block_comment(c: &[char], from: usize) -> usize {
    let (mut depth, mut i) = (0, from);
    while i < c.len() {
        match (c[i], c.get(i + 1)) {
            ('/', Some('*')) => (depth, i) = (depth + 1, i + 2),
            ('*', Some('/')) => (depth, i) = (depth - 1, i + 2),
            _ => i += 1,
        }
        if depth == 0 {
            break;
        }
    }
    i
}

fn string(c: &[char], from: usize) -> usize {
    let mut i = from + 1;
    while i < c.len() && c[i] != '"' {
        i += if c[i] == '\\' { 2 } else { 1 };
    }
    i + 1
}

fn raw_string_hashes(c: &[char], from: usize) -> Option<usize> {
    let quote = skip_while(c, from + 1, |x| x == '#');
    (c.get(quote) == Some(&'"')).then_some(quote - from - 1)
}

fn raw_string(c: &[char], from: usize, hashes: usize) -> usize {
    let mut i = from + hashes + 2;
    while i < c.len() {
        if c[i] == '"' && (1..=hashes).all(|k| c.get(i + k) == Some(&'#')) {
            return i + 1 + hashes;
        }
        i += 1;
    }
    i
}

/// The tokens without `#[cfg(test)] mod name { .. }`.
fn without_unit_tests(tokens: Vec<(usize, String)>) -> Vec<(usize, String)> {
    const MARK: [&str; 8] = ["#", "[", "cfg", "(", "test", ")", "]", "mod"];
    let mut out = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let marked = MARK
            .iter()
            .enumerate()
            .all(|(k, m)| tokens.get(i + k).is_some_and(|t| t.1 == *m));
        if !marked {
            out.push(tokens[i].clone());
            i += 1;
            continue;
        }
        let mut depth = 0;
        while i < tokens.len() {
            match tokens[i].1.as_str() {
                "{" => depth += 1,
                "}" => depth -= 1,
                ";" if depth == 0 => break,
                _ => {}
            }
            i += 1;
            if depth == 0 && tokens[i - 1].1 == "}" {
                break;
            }
        }
    }
    out
}

/// What a path that starts at the crate's root names first: `crate::a::b` and `super::..::a` give
/// `a`, `crate::{a::b, c}` gives `a` and `c`.
fn named_from_root(tokens: &[(usize, String)]) -> Vec<(usize, String)> {
    let at = |i: usize| tokens.get(i).map_or("", |t| t.1.as_str());
    let mut out = Vec::new();
    for i in 0..tokens.len() {
        if !matches!(at(i), "crate" | "super" | "umbrage") || at(i + 1) != "::" {
            continue;
        }
        if at(i + 2) != "{" {
            out.push((tokens[i].0, at(i + 2).to_owned()));
            continue;
        }
        let (mut depth, mut k, mut head) = (0, i + 2, true);
        loop {
            match at(k) {
                "{" => depth += 1,
                "}" => depth -= 1,
                "," => head = depth == 1,
                name if head => {
                    out.push((tokens[k].0, name.to_owned()));
                    head = false;
                }
                _ => {}
            }
            k += 1;
            if depth == 0 || k >= tokens.len() {
                break;
            }
        }
    }
    out
}

/// The room a source file stands in, if any (`src/lib.rs` and `src/main.rs` stand in none).
fn room_of(path: &str) -> Option<&str> {
    let first = path.strip_prefix("src/")?.split('/').next()?;
    let name = first.strip_suffix(".rs").unwrap_or(first);
    ROOMS.iter().map(|r| r.0).find(|r| *r == name)
}

/// Everything wrong with one source file, one sentence each.
fn offences(path: &str, text: &str) -> Vec<String> {
    let tokens = without_unit_tests(tokens(text));
    let mut found = Vec::new();
    if let Some(room) = room_of(path) {
        let allowed = ROOMS.iter().find(|r| r.0 == room).unwrap().1;
        for (line, name) in named_from_root(&tokens) {
            let is_room = ROOMS.iter().any(|r| r.0 == name);
            if is_room && name != room && !allowed.contains(&name.as_str()) {
                found.push(format!("{path}:{line}: room `{room}` uses `{name}`"));
            }
        }
    } else if !matches!(path, "src/lib.rs" | "src/main.rs") {
        found.push(format!("{path}:1: stands in no room"));
    }
    for (i, (line, token)) in tokens.iter().enumerate() {
        let Some((_, prefixes)) = CONFINED.iter().find(|c| c.0 == token) else {
            continue;
        };
        if prefixes.iter().any(|p| path.starts_with(p)) || !is_use(&tokens, i) {
            continue;
        }
        found.push(format!("{path}:{line}: `{token}` does not belong here"));
    }
    found
}

/// Whether the confined word at `i` is meant, and not a field or variable of that name.
fn is_use(tokens: &[(usize, String)], i: usize) -> bool {
    let at = |k: usize| tokens.get(k).map_or("", |t| t.1.as_str());
    let before = |k: usize| i.checked_sub(k).map_or("", at);
    match at(i) {
        "unsafe" => true,
        "unwrap" => before(1) == "." && at(i + 1) == "(",
        "print" | "println" | "eprint" | "eprintln" => at(i + 1) == "!",
        // A crate at the head of a path, or named by `use` alone.
        _ => {
            let heads_path = at(i + 1) == "::" && before(1) != "::";
            let of_root = before(1) == "::" && matches!(before(2), "crate" | "super" | "umbrage");
            heads_path || of_root || (before(1) == "use" && at(i + 1) == ";")
        }
    }
}

fn assert_none(found: &[String], what: &str) {
    assert!(found.is_empty(), "{what}:\n{}", found.join("\n"));
}

#[test]
fn rooms_use_only_the_rooms_below_them() {
    let sources = files("src", &["rs"]);
    assert!(sources.len() > 10, "the sources are found");
    let found: Vec<String> = sources
        .iter()
        .flat_map(|(path, text)| offences(path, text))
        .collect();
    assert_none(&found, "the order of the house is broken");
}

#[test]
fn every_room_is_declared_here() {
    let known: BTreeSet<&str> = ROOMS.iter().map(|r| r.0).collect();
    let library = tokens(&fs::read_to_string(root().join("src/lib.rs")).unwrap());
    let declared: Vec<&str> = library
        .windows(2)
        .filter(|w| w[0].1 == "mod")
        .map(|w| w[1].1.as_str())
        .collect();
    let unknown: Vec<_> = declared.iter().filter(|d| !known.contains(*d)).collect();
    assert!(unknown.is_empty(), "rooms without a rule: {unknown:?}");
    assert!(declared.contains(&"gpu"), "the scanner reads lib.rs");
}

#[test]
fn no_file_is_too_long() {
    let mut all = files("src", &["rs"]);
    all.extend(files("tests", &["rs"]));
    all.extend(files("shaders", &["comp", "vert", "frag", "glsl"]));
    let found: Vec<String> = all
        .iter()
        .map(|(path, text)| (path, text.lines().count()))
        .filter(|(_, lines)| *lines > LONGEST_FILE)
        .map(|(path, lines)| format!("{path}: {lines} lines, at most {LONGEST_FILE}"))
        .collect();
    assert_none(&found, "files to split");
}

/// The scanner finds what it is for: each text breaks exactly one rule.
#[test]
fn the_scanner_sees_offences() {
    let bad = [
        ("src/gpu/a.rs", "use crate::render::Plan;", "uses `render`"),
        (
            "src/math/a.rs",
            "use crate::{Error, scene::{Model, Mesh}};",
            "uses `scene`",
        ),
        (
            "src/scene/a.rs",
            "fn f(g: &crate::gpu::Gpu) {}",
            "uses `gpu`",
        ),
        (
            "src/foliage/a.rs",
            "use super::super::render;",
            "uses `render`",
        ),
        (
            "src/foliage/a.rs",
            "fn f() { crate::app::run(); }",
            "uses `app`",
        ),
        ("src/render/a.rs", "unsafe { f() }", "`unsafe`"),
        ("src/render/a.rs", "use ash::vk;", "`ash`"),
        ("src/app/a.rs", "fn f(x: vk::Format) {}", "`vk`"),
        ("src/scene/model.rs", "use gltf::Gltf;", "`gltf`"),
        ("src/render/a.rs", "use clap;", "`clap`"),
        ("src/math/a.rs", "fn f() { x().unwrap() }", "`unwrap`"),
        ("src/math/a.rs", "fn f() { println!(\"x\"); }", "`println`"),
        (
            "src/app/command/bake.rs",
            "use crate::reference::density;",
            "`reference`",
        ),
        ("src/stray.rs", "", "stands in no room"),
    ];
    for (path, text, expected) in bad {
        let found = offences(path, text);
        assert_eq!(found.len(), 1, "{path}: {text}: {found:?}");
        assert!(found[0].contains(expected), "{path}: {text}: {found:?}");
    }
}

/// The scanner lets pass what is allowed, and is not fooled by comments, texts and unit tests.
#[test]
fn the_scanner_lets_pass_what_is_right() {
    let good = [
        (
            "src/gpu/a.rs",
            "use ash::vk; unsafe {} use crate::{Error, Result, abi};",
        ),
        (
            "src/render/a.rs",
            "// unsafe ash::vk\n/* crate::app /* vk::X */ */ const A: &str = \"unsafe { ash::x }\";",
        ),
        (
            "src/render/a.rs",
            "const A: &str = r#\"crate::app \" unsafe\"#; const B: char = '\"'; fn f<'a>() {}",
        ),
        (
            "src/scene/a.rs",
            "struct S { gltf: u32, reference: f32 } fn f(s: &S) -> u32 { s.gltf }",
        ),
        (
            "src/foliage/a.rs",
            "#[cfg(test)]\nmod tests { use crate::reference::a; fn f() { g().unwrap(); } }",
        ),
        (
            "src/app/conform/a.rs",
            "use crate::reference::density; use crate::gpu::Gpu;",
        ),
        (
            "src/main.rs",
            "fn main() { umbrage::app::run(std::env::args_os()); }",
        ),
    ];
    for (path, text) in good {
        assert_none(&offences(path, text), text);
    }
}

#[test]
fn code_after_unit_tests_is_still_seen() {
    let text = "#[cfg(test)] mod tests { fn f() { unsafe {} } } fn g() { unsafe {} }";
    assert_eq!(
        offences("src/app/a.rs", text).len(),
        1,
        "only the second one counts"
    );
}
