//! Orders, storage and matrices of transfer.

use glam::Vec3;
use umbrage::leaf::light::{Storage, StoredTransfer};
use umbrage::leaf::optics::Optics;
use umbrage::leaf::prt::{Prt, PrtSettings, Transfer};
use umbrage::leaf::rays::{Occluders, RayScene};
use umbrage::leaf::receivers::Receivers;
use umbrage::scene::{Geometry, Part};

use super::fixture;

/// Two squares of edge 2, one 0.5 above the other and shifted; fronts up.
fn squares() -> Geometry {
    let mut g = Geometry::default();
    for (x, y) in [(0.0, 0.0), (0.7, 0.5)] {
        let first = g.positions.len() as u32;
        for (s, t) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            g.positions.push(Vec3::new(x + s, y, t));
            g.normals.push(Vec3::Y);
            g.texcoords.push([0.0; 2]);
        }
        g.indices.extend([0, 2, 1, 0, 3, 2].map(|k| first + k));
    }
    (g.min, g.max) = (Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.7, 0.5, 1.0));
    g.parts.push(Part {
        instance: 0,
        mesh: 0,
        primitive: 0,
        material: 0,
        first_vertex: 0,
        vertex_count: 8,
        first_index: 0,
        index_count: 12,
    });
    g
}

fn leaf() -> Optics {
    Optics {
        rho_d_back: [0.2, 0.3, 0.1],
        rho_t: [0.25, 0.3, 0.05],
        ..Optics::opaque([0.3, 0.4, 0.1])
    }
}

fn transfer(settings: PrtSettings) -> Transfer {
    let gpu = fixture::gpu();
    let geometry = squares();
    let occluders = Occluders::solid(&geometry);
    let receivers = Receivers::new(&geometry, &occluders, &[leaf()]);
    let scene = RayScene::new(&gpu, &occluders).unwrap();
    let mut prt = Prt::new(&gpu, &scene, &receivers, settings).unwrap();
    prt.all(&mut |_| Ok(())).unwrap()
}

/// A lower order is the beginning of a higher one (kernels of other orders round otherwise), and
/// takes its share of the memory.
#[test]
fn orders_are_nested() {
    let of = |order: u32| {
        transfer(PrtSettings {
            order,
            paths: 24,
            ..PrtSettings::default()
        })
    };
    let all = of(6);
    for order in 1..=5 {
        let few = of(order);
        let count = (order * order) as usize;
        assert_eq!(few.values.len(), 8 * 2 * 2 * count * 3);
        for (vertex, side, part) in (0..32).map(|i| (i / 4, i / 2 % 2, i % 2)) {
            let [few, all] = [&few, &all].map(|t| t.vector(vertex, side, part));
            for (a, b) in few.iter().flatten().zip(all[..count].iter().flatten()) {
                assert!(
                    (a - b).abs() < 1e-6,
                    "{order}: {vertex} {side} {part}: {a} {b}"
                );
            }
        }
        let stored = StoredTransfer::new(&few, Storage::F32, 24, 0.0);
        assert_eq!(stored.receivers(), 8);
        assert_eq!(stored.transfer(), few);
    }
}
