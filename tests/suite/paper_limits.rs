//! Drawings on paper at the ends: nothing to draw, very much to draw, interrupted.
#![cfg(unix)]

use std::fs;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use umbrage::ink::paper::style::PaperStyle;

use crate::place::{Place, files, stderr};

const BASE: &str = "format_version = 1\nkind = \"paper\"\ndescription = \"x\"\n";
/// What an interrupted program ends with, by the shell's convention.
const INTERRUPTED: i32 = 130;

fn start(place: &Place, arguments: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_umbrage"))
        .args(arguments)
        .current_dir(place.path(""))
        .env("XDG_CACHE_HOME", place.path("cache"))
        .stdout(Stdio::null())
        .spawn()
        .unwrap()
}

#[test]
fn one_leaf_no_branches_and_no_leaves_are_drawn() {
    let place = Place::new();
    for (more, branches) in [(&[][..], true), (&["--foliage", "."][..], false)] {
        let arguments = [
            "render",
            "grow:shrub:1:1",
            "-o",
            "x.svg",
            "--style",
            "ds00-fig3a",
            "--paper",
            "a6",
        ];
        let report = place.json(&[&arguments, more].concat());
        let layers = report["layers"].as_array().unwrap();
        let names: Vec<_> = layers.iter().map(|l| l["name"].as_str().unwrap()).collect();
        assert!(names.contains(&"foliage contour"), "{names:?}");
        assert_eq!(names.contains(&"stem contour"), branches, "{names:?}");
    }
    let one = [
        "render",
        "grow:shrub:1:1",
        "-o",
        "z.svg",
        "--style",
        "ds00-fig3a",
    ];
    let text = stderr(&place.umbrage(&one));
    assert!(
        text.contains("its foliage is 1 piece, each drawn as one primitive"),
        "{text}"
    );
    let bare = [
        "render",
        "grow:shrub:1:0",
        "-o",
        "y.svg",
        "--style",
        "ds00-fig3a",
    ];
    let drawn = place.umbrage(&bare);
    assert_eq!(drawn.status.code(), Some(0), "{}", stderr(&drawn));
    assert!(stderr(&drawn).contains("no foliage"), "{}", stderr(&drawn));
    assert!(place.path("y.svg").exists());
}

#[test]
fn all_behind_the_camera_is_an_empty_drawing() {
    let place = Place::new();
    let behind = "0,1,90/0,1,200";
    for file in ["x.svg", "x.png"] {
        let arguments = [
            "render",
            "grow:shrub:1:40",
            "-o",
            file,
            "--style",
            "ds00-fig6f",
            "--camera",
            behind,
            "--paper",
            "a6",
            "--size",
            "60x80",
        ];
        let done = place.umbrage(&arguments);
        assert_eq!(done.status.code(), Some(0), "{file}: {}", stderr(&done));
    }
    let text = fs::read_to_string(place.path("x.svg")).unwrap();
    assert!(text.contains("</svg>") && !text.contains("<path"), "{text}");
}

/// A million particles take less than 1 GiB, of which the program without them takes a part; with all
/// their outlines at once it would be 1.9.
#[cfg(target_os = "linux")]
#[test]
fn a_million_particles_take_bounded_memory() {
    let place = Place::new();
    let style = format!(
        "{BASE}[primitive]\nform = \"ellipse\"\nsize = 0.02\n[shadow]\nform = \"black\"\n[ground]\ncount = 1000000\nsize = 0.02\n"
    );
    place.write("own.toml", style);
    let mut child = start(
        &place,
        &[
            "render",
            "grow:shrub:1:40",
            "-o",
            "x.svg",
            "--style",
            "own.toml",
            "--paper",
            "50x50",
        ],
    );
    let status = format!("/proc/{}/status", child.id());
    let mut most = 0_u64;
    let code = loop {
        if let Some(code) = child.try_wait().unwrap() {
            break code;
        }
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|l| l.strip_prefix("VmHWM:"));
        let now = line.and_then(|l| l.trim().trim_end_matches(" kB").parse().ok());
        most = most.max(now.unwrap_or(0));
        std::thread::sleep(Duration::from_millis(10));
    };
    println!("{} MiB", most / 1024);
    assert!(code.success());
    assert!(most > 0 && most < 1 << 20, "{most} KiB");
    assert!(place.path("x.svg").exists());
}

#[test]
fn an_interrupted_drawing_leaves_no_file() {
    let place = Place::new();
    place.write(
        "own.toml",
        format!("{BASE}[ground]\ncount = 1000000\n[shadow]\nform = \"black\"\n"),
    );
    let before = files(&place.path(""));
    let mut child = start(
        &place,
        &[
            "render",
            "grow:shrub:1:400",
            "-o",
            "x.svg",
            "--style",
            "own.toml",
        ],
    );
    let started = Instant::now();
    // The file is reserved before the long work begins.
    while files(&place.path("")).len() == before.len() {
        assert!(
            started.elapsed() < Duration::from_secs(60),
            "no file is under way"
        );
        assert!(child.try_wait().unwrap().is_none(), "ended too early");
        std::thread::sleep(Duration::from_millis(1));
    }
    std::thread::sleep(Duration::from_millis(200));
    let pressed = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(pressed.success(), "the signal is sent");
    assert_eq!(child.wait().unwrap().code(), Some(INTERRUPTED));
    assert_eq!(files(&place.path("")), before, "no half-written drawing");
}

/// Every number of a table with its key, replaced by `wrong` in turn.
fn each_replaced(value: &toml::Value, wrong: f64, key: &str, out: &mut Vec<(String, toml::Value)>) {
    let mut inside = |part: &toml::Value, key: String, put: &dyn Fn(toml::Value) -> toml::Value| {
        let mut parts = Vec::new();
        each_replaced(part, wrong, &key, &mut parts);
        out.extend(parts.into_iter().map(|(key, part)| (key, put(part))));
    };
    match value {
        toml::Value::Float(_) => out.push((key.to_owned(), toml::Value::Float(wrong))),
        toml::Value::Table(table) => {
            for (name, part) in table {
                inside(part, format!("{key}.{name}"), &|part| {
                    let mut table = table.clone();
                    table.insert(name.clone(), part);
                    toml::Value::Table(table)
                });
            }
        }
        toml::Value::Array(list) => {
            for (k, part) in list.iter().enumerate() {
                inside(part, format!("{key}[{k}]"), &|part| {
                    let mut list = list.clone();
                    list[k] = part;
                    toml::Value::Array(list)
                });
            }
        }
        _ => {}
    }
}

#[test]
fn every_number_has_its_range() {
    let mut count = 0;
    for name in ["ds00-fig4b", "coloured-pens", "crown-hatching"] {
        let style = PaperStyle::named(name).unwrap().unwrap();
        let value = toml::Value::try_from(&style).unwrap();
        for wrong in [f64::NAN, -1e13, 1e13] {
            let mut all = Vec::new();
            each_replaced(&value, wrong, "", &mut all);
            for (key, value) in all {
                let text = toml::to_string(&value).unwrap();
                let said = PaperStyle::parse(&text);
                assert!(said.is_err(), "{name}: {key} = {wrong} is taken");
                count += 1;
            }
        }
    }
    assert!(count > 400, "{count} numbers");
}
