//! Which levels of detail a leaf takes: the two adjacent ones about the distance of vertices that
//! its size in the picture asks for, blended linearly (Wang et al. 2005, section 4.1).

use glam::Vec3;

use crate::scene::Geometry;

/// The leaves of a model: what hangs together by edges.
#[derive(Debug, Clone, PartialEq)]
pub struct Leaves {
    /// Leaf of each vertex.
    pub of_vertex: Vec<u32>,
    /// Middle (relative to the geometry's origin) and radius of each leaf, metres.
    pub spheres: Vec<(Vec3, f32)>,
}

impl Leaves {
    /// The leaves of `geometry`, in the order of their first vertices.
    #[must_use]
    pub fn new(geometry: &Geometry) -> Self {
        let count = geometry.positions.len();
        let mut parent: Vec<u32> = (0..count as u32).collect();
        for t in geometry.indices.chunks_exact(3) {
            for k in 1..3 {
                let [a, b] = [t[0], t[k]].map(|v| root(&mut parent, v));
                // The lowest number leads, so that leaves follow the order of vertices.
                parent[a.max(b) as usize] = a.min(b);
            }
        }
        let mut number = vec![0u32; count];
        let mut boxes: Vec<(Vec3, Vec3)> = Vec::new();
        for v in 0..count as u32 {
            let lead = root(&mut parent, v);
            if lead == v {
                number[v as usize] = boxes.len() as u32;
                boxes.push((Vec3::INFINITY, Vec3::NEG_INFINITY));
            }
            number[v as usize] = number[lead as usize];
            let (lo, hi) = &mut boxes[number[v as usize] as usize];
            let p = geometry.positions[v as usize];
            (*lo, *hi) = (lo.min(p), hi.max(p));
        }
        let sphere = |&(lo, hi): &(Vec3, Vec3)| (0.5 * (lo + hi), 0.5 * (hi - lo).length());
        Self {
            of_vertex: number,
            spheres: boxes.iter().map(sphere).collect(),
        }
    }
}

fn root(parent: &mut [u32], mut v: u32) -> u32 {
    while parent[v as usize] != v {
        parent[v as usize] = parent[parent[v as usize] as usize];
        v = parent[v as usize];
    }
    v
}

/// The levels of one leaf.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blend {
    /// The finer level.
    pub level: usize,
    /// Share of the next coarser one, in \[0,1).
    pub next: f32,
}

impl Blend {
    /// The levels of `edges` (metres, ascending) about vertices `wanted` metres apart.
    #[must_use]
    pub fn new(edges: &[f32], wanted: f32) -> Self {
        let above = edges.partition_point(|&e| e <= wanted);
        let level = above.saturating_sub(1);
        let next = match edges.get(above) {
            Some(next) if above > 0 => (wanted - edges[level]) / (next - edges[level]),
            _ => 0.0,
        };
        Self { level, next }
    }

    /// Share of a level.
    #[must_use]
    pub fn share(&self, level: usize) -> f32 {
        match level.checked_sub(self.level) {
            Some(0) => 1.0 - self.next,
            Some(1) => self.next,
            _ => 0.0,
        }
    }
}

/// Remembers from picture to picture what each leaf took, so that a trembling camera changes
/// nothing: what is wanted drags what is taken behind it, by a factor of at most `play`.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelChoice {
    play: f32,
    taken: Vec<f32>,
}

impl LevelChoice {
    /// Play that hides the trembling of a camera held by hand and delays a level by little.
    pub const PLAY: f32 = 1.1;

    /// Nothing taken yet; `play` is at least 1, and 1 follows at once.
    #[must_use]
    pub fn new(play: f32) -> Self {
        Self {
            play: play.max(1.0),
            taken: Vec::new(),
        }
    }

    /// Takes note of the distance of vertices (metres) that each leaf wants in the next picture;
    /// what it gets.
    pub fn update(&mut self, wanted: &[f32]) -> &[f32] {
        if self.taken.len() == wanted.len() {
            for (taken, &wanted) in self.taken.iter_mut().zip(wanted) {
                *taken = taken.clamp(wanted / self.play, wanted * self.play);
            }
        } else {
            self.taken = wanted.to_vec();
        }
        &self.taken
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adjacent_levels_are_blended_and_the_ends_are_pure() {
        let edges = [0.0, 0.1, 0.4];
        for (wanted, level, next) in [
            (0.0, 0, 0.0),
            (0.05, 0, 0.5),
            (0.1, 1, 0.0),
            (0.25, 1, 0.5),
            (0.4, 2, 0.0),
            (9.0, 2, 0.0),
            (f32::INFINITY, 2, 0.0),
        ] {
            let blend = Blend::new(&edges, wanted);
            assert_eq!(blend.level, level, "{wanted}");
            assert!((blend.next - next).abs() < 1e-6, "{wanted}: {blend:?}");
            let sum: f32 = (0..3).map(|l| blend.share(l)).sum();
            assert!((sum - 1.0).abs() < 1e-6, "{wanted}");
        }
        // No level of all vertices: the finest there is.
        assert_eq!(Blend::new(&edges[1..], 0.0).share(0), 1.0);
    }

    #[test]
    fn blends_are_continuous() {
        let edges = [0.0, 0.1, 0.4, 0.7];
        let mut last = Blend::new(&edges, 0.0);
        for step in 1..1000 {
            let blend = Blend::new(&edges, 1e-3 * step as f32);
            for level in 0..4 {
                let jump = (blend.share(level) - last.share(level)).abs();
                assert!(jump < 0.011, "{step}: {jump}");
            }
            last = blend;
        }
    }

    #[test]
    fn a_trembling_camera_changes_nothing_and_a_moving_one_is_followed() {
        let mut choice = LevelChoice::new(1.1);
        let first = choice.update(&[1.0, 0.0]).to_vec();
        for step in 0..20 {
            let tremble = 1.0 + 0.08 * (step as f32).sin();
            assert_eq!(choice.update(&[tremble, 0.0]), first, "{step}");
        }
        let mut last = 1.0;
        for step in 1..=50 {
            let wanted = 1.0 + 0.1 * step as f32;
            let taken = choice.update(&[wanted, 0.0])[0];
            assert!(taken >= last && taken <= wanted && taken >= wanted / 1.1 - 1e-5);
            last = taken;
        }
        // Back again: the way there differs from the way back by the play, no more.
        for step in (0..=50).rev() {
            let wanted = 1.0 + 0.1 * step as f32;
            let taken = choice.update(&[wanted, 0.0])[0];
            assert!(taken >= wanted / 1.1 - 1e-5 && taken <= wanted * 1.1 + 1e-5);
        }
        // The exact end is reached: who wants vertices no distance apart gets them.
        assert_eq!(choice.update(&[0.0, 0.0]), [0.0, 0.0]);
        assert_eq!(choice.update(&[2.0]), [2.0], "other leaves start anew");
    }

    #[test]
    fn leaves_are_what_hangs_together() {
        let mut g = Geometry::default();
        for x in [0.0, 1.0, 5.0, 6.0, 2.0] {
            g.positions.push(Vec3::new(x, 0.0, 0.0));
            g.positions.push(Vec3::new(x, 1.0, 0.0));
        }
        // 0 to 3 and 8, 9 hang together; 4 to 7 are another leaf.
        g.indices = vec![0, 2, 1, 2, 3, 1, 4, 6, 5, 6, 7, 5, 8, 9, 3];
        let leaves = Leaves::new(&g);
        assert_eq!(leaves.of_vertex, [0, 0, 0, 0, 1, 1, 1, 1, 0, 0]);
        let (middle, radius) = leaves.spheres[0];
        assert_eq!(middle, Vec3::new(1.0, 0.5, 0.0));
        assert!((radius - 1.25_f32.sqrt()).abs() < 1e-6);
    }
}
