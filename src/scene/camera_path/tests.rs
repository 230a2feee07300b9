use glam::{DVec3, Vec3};

use super::way::middle;
use super::{CameraPath, PathSpec, file, spec};
use crate::scene::{CameraSpec, Lens};

const LENS: Lens = Lens {
    fov: 40.0,
    aspect: 1.5,
    margin: 0.05,
};

fn cloud() -> Vec<Vec3> {
    (0..300)
        .map(|i| {
            let f = |k: f32| (i as f32 * k).sin();
            Vec3::new(3.0 * f(1.1), 1.0 + 5.0 * f(1.7), 2.0 * f(2.3))
        })
        .collect()
}

fn path(text: &str, start: &str) -> CameraPath {
    let start: CameraSpec = start.parse().unwrap();
    let spec = PathSpec::named(text, None).unwrap();
    spec.resolve(&start, LENS, DVec3::new(1e5, 0.0, 0.0), cloud().into_iter())
}

#[test]
fn an_orbit_stays_at_its_distance_and_sees_everything() {
    let path = path("orbit:frames=24,turns=1", "25,12");
    assert_eq!(path.last(), 23);
    let origin = DVec3::new(1e5, 0.0, 0.0);
    let first = path.pose(0.0);
    let target = middle(origin, cloud().into_iter());
    for frame in 0..24 {
        let camera = path.camera(f64::from(frame), 1.5, origin, cloud().into_iter());
        let away = camera.eye - target;
        assert!((away.length() - (first.eye - target).length()).abs() < 1e-6);
        for p in cloud() {
            let (at, _) = camera.project(origin + p.as_dvec3());
            assert!(
                at.min_element() > -1e-9 && at.truncate().max_element() < 1.0,
                "{at}"
            );
        }
    }
    // One step more than the last frame is the first again.
    let step = path.pose(0.0).forward.angle_between(path.pose(1.0).forward);
    let close = path
        .pose(23.0)
        .forward
        .angle_between(path.pose(0.0).forward);
    assert!((step - close).abs() < 1e-9, "{step} {close}");
}

#[test]
fn dolly_and_walk_go_where_they_say() {
    let dolly = path("dolly:frames=11,from=2,to=0.5,roll=30", "25,7");
    let target = middle(DVec3::new(1e5, 0.0, 0.0), cloud().into_iter());
    let away = |frame: f64| (dolly.pose(frame).eye - target).length();
    assert!((away(0.0) / away(10.0) - 4.0).abs() < 1e-9);
    // By equal factors.
    assert!((away(0.0) / away(5.0) - 2.0).abs() < 1e-9);
    assert!((dolly.pose(5.0).roll - 15.0).abs() < 1e-9);
    let walk = path("walk:frames=5,height=0.5", "0,20");
    let heights: Vec<f64> = (0..5).map(|f| walk.pose(f64::from(f)).eye.y).collect();
    assert!(
        heights.iter().all(|h| (h - heights[0]).abs() < 1e-9),
        "level"
    );
    assert!(walk.pose(0.0).eye.z > walk.pose(4.0).eye.z + 1.0, "nearer");
}

#[test]
fn smooth_ways_meet_their_keys_without_kinks() {
    let text = "format_version = 1\n[[keys]]\nframe = 0\ncamera = '0,0,2'\n\
                [[keys]]\nframe = 10\ncamera = '90,20,1'\nroll = 10\n\
                [[keys]]\ntime = 1.25\ncamera = '120,10,1.5'\nfov = 20\n";
    let file = file::PathFile::parse(text, false, None).unwrap();
    let start = CameraSpec::default();
    let scene = spec::Framed {
        start: &start,
        lens: LENS,
        origin: DVec3::ZERO,
        middle: DVec3::ZERO,
        points: cloud().into_iter(),
    };
    let path = file.resolve(&scene);
    assert_eq!(path.last(), 30, "1.25 seconds of 24 frames");
    let at = |f: f64| path.values(f);
    assert!((at(10.0)[0] - 90.0).abs() < 1e-9 && (at(10.0)[7] - 10.0).abs() < 1e-9);
    assert!((path.pose(30.0).fov - 20.0).abs() < 1e-9);
    assert!((path.pose(0.0).fov - 40.0).abs() < 1e-9);
    let h = 1e-4;
    for value in [0, 1, 2, 7] {
        let slope = |f: f64| (at(f + h)[value] - at(f - h)[value]) / (2.0 * h);
        let kink = slope(10.0 + 2.0 * h) - slope(10.0 - 2.0 * h);
        assert!(kink.abs() < 1e-3, "{value}: {kink}");
        assert!(slope(h).abs() < 1e-2, "starts from rest");
    }
    assert_eq!(path.pose(-5.0), path.pose(0.0));
    assert_eq!(path.pose(99.0), path.pose(30.0));
}

#[test]
fn places_keep_their_up_and_json_says_the_same() {
    let toml = "format_version = 1\ninterpolation = 'linear'\n[[keys]]\nframe = 0\n\
                eye = [0.0, 1.0, 9.0]\ntarget = [0.0, 1.0, 0.0]\nup = [1.0, 1.0, 0.0]\n";
    let json = r#"{"format_version": 1, "interpolation": "linear", "keys": [{"frame": 0,
        "eye": [0, 1, 9], "target": [0, 1, 0], "up": [1, 1, 0]}]}"#;
    let a = file::PathFile::parse(toml, false, None).unwrap();
    assert_eq!(a, file::PathFile::parse(json, true, None).unwrap());
    let start = CameraSpec::default();
    let scene = spec::Framed {
        start: &start,
        lens: LENS,
        origin: DVec3::ZERO,
        middle: DVec3::ZERO,
        points: cloud().into_iter(),
    };
    let camera = a
        .resolve(&scene)
        .camera(0.0, 1.5, DVec3::ZERO, cloud().into_iter());
    let [_, up, _] = camera.basis();
    assert!(
        up.distance(DVec3::new(1.0, 1.0, 0.0).normalize()) < 1e-12,
        "{up}"
    );
}

#[test]
fn wrong_paths_are_refused_with_what_is_wrong() {
    let head = "format_version = 1\n";
    for (text, said) in [
        ("", "keys"),
        ("keys = []", "at least one"),
        ("[[keys]]\ncamera = '1,2'", "key 1: expected either `frame`"),
        ("[[keys]]\nframe = 0\ncamera = '1,95'", "elevation 95"),
        ("[[keys]]\nframe = 0\neye = [0, 0, 0]", "`target`"),
        ("[[keys]]\nframe = 0\ncamera = '1,2'\nfov = 0", "fov = 0"),
        ("[[keys]]\nframe = nan\ncamera = '1,2'", "frame NaN"),
        (
            "[[keys]]\nframe = 0\ncamera = '1,2'\nroll = 1\nup = [0, 1, 0]",
            "only one",
        ),
        (
            "[[keys]]\nframe = 1\ncamera = '1,2'\n[[keys]]\nframe = 1\ncamera = '2,2'",
            "after 1",
        ),
        ("colour = 1\n[[keys]]\nframe = 0\ncamera = '1,2'", "colour"),
    ] {
        let error = file::PathFile::parse(&format!("{head}{text}"), false, None).unwrap_err();
        assert!(error.contains(said), "{text}: {error}");
    }
    let old = file::PathFile::parse("format_version = 7\nkeys = []", false, None).unwrap_err();
    assert!(old.contains("format_version 7"), "{old}");
    for (text, said) in [
        ("spiral", "orbit, dolly, walk"),
        ("orbit:speed=1", "turns"),
        ("orbit:turns", "NAME=NUMBER"),
        ("dolly:from=0", "from=0"),
        ("missing.toml", "missing.toml"),
    ] {
        let error = PathSpec::named(text, None).unwrap_err().to_string();
        assert!(error.contains(said), "{text}: {error}");
    }
}
