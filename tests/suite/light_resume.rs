//! A precomputation that is interrupted by Ctrl-C leaves no half-written file and goes on.
#![cfg(unix)]

use std::fs;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::place::{Place, files, stderr};
use crate::small_model::small_tree;

/// Enough paths and directions for some dozens of checkpoints.
const WORK: [&str; 11] = [
    "light",
    "tree.glb",
    "--paths",
    "20000",
    "--transfer",
    "both",
    "--minutes",
    "0.5",
    "--splits",
    "3",
    "-o",
];

/// What an interrupted program ends with, by the shell's convention.
const INTERRUPTED: i32 = 130;

fn names(place: &Place) -> Vec<String> {
    let all = files(&place.path(""));
    let name = |p: &std::path::PathBuf| p.file_name().unwrap().to_str().unwrap().to_owned();
    all.iter().map(name).collect()
}

/// Runs until a checkpoint of a size that `wanted` accepts has been written, then presses Ctrl-C;
/// the size.
fn interrupt(place: &Place, more: &[&str], mut wanted: impl FnMut(u64) -> bool) -> u64 {
    let mut child = Command::new(env!("CARGO_BIN_EXE_umbrage"))
        .args(WORK)
        .args(["a.light", "--checkpoint", "0"])
        .args(more)
        .current_dir(place.path(""))
        .env("XDG_CACHE_HOME", place.path("cache"))
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let part = place.path("a.light.part");
    let written = || {
        fs::metadata(&part)
            .and_then(|m| Ok((m.modified()?, m.len())))
            .ok()
    };
    let (start, mut last) = (Instant::now(), written());
    let size = loop {
        assert!(start.elapsed() < Duration::from_secs(120), "no checkpoint");
        assert!(child.try_wait().unwrap().is_none(), "ended too early");
        let now = written();
        if let Some((_, size)) = now.filter(|_| now != last)
            && wanted(size)
        {
            break size;
        }
        last = now;
        std::thread::sleep(Duration::from_millis(1));
    };
    let pressed = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(pressed.success(), "the signal is sent");
    assert_eq!(
        child.wait().unwrap().code(),
        Some(INTERRUPTED),
        "ends at once"
    );
    size
}

/// Interrupted in the midst of vectors, of matrices and of maps, and resumed: the same bytes.
#[test]
fn an_interrupted_light_goes_on_where_it_stood() {
    let place = Place::new();
    place.write("tree.glb", small_tree().glb());
    let whole = place.umbrage(&[&WORK[..], &["whole.light"]].concat());
    assert!(whole.status.success(), "{}", stderr(&whole));
    let whole = fs::read(place.path("whole.light")).unwrap();
    let mut times = 0;
    let vectors = interrupt(&place, &[], |_| {
        times += 1;
        times == 3
    });
    assert_eq!(
        names(&place),
        ["a.light.part", "tree.glb", "whole.light"],
        "no half-written file"
    );
    // Sums of matrices are many times larger, and gone when there are maps.
    let matrices = interrupt(&place, &["--resume"], |size| size > 3 * vectors);
    interrupt(&place, &["--resume"], |size| size < matrices / 2);
    let other = [&WORK[..], &["a.light", "--resume", "--seed", "2"]].concat();
    place.assert_refused(&other, &["a.light.part", "other settings"]);
    let resumed = place.umbrage(&[&WORK[..], &["a.light", "--resume"]].concat());
    assert!(resumed.status.success(), "{}", stderr(&resumed));
    assert!(
        fs::read(place.path("a.light")).unwrap() == whole,
        "the same in every bit"
    );
    assert_eq!(names(&place), ["a.light", "tree.glb", "whole.light"]);
}

/// A damaged rest is told, not used.
#[test]
fn a_damaged_rest_is_refused() {
    let place = Place::new();
    place.write("tree.glb", small_tree().glb());
    place.write("a.light.part", "half a checkpoint");
    let resume = [&WORK[..], &["a.light", "--resume"]].concat();
    place.assert_refused(&resume, &["a.light.part", "damaged"]);
}
