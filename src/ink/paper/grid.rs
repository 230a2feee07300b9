//! Ends of lines in square cells, to find the nearest.

use std::collections::HashMap;

use glam::{DVec2, IVec2};

/// Points in square cells.
pub(super) struct Grid {
    cell: f64,
    cells: HashMap<IVec2, Vec<u32>>,
    low: IVec2,
    high: IVec2,
}

impl Grid {
    pub(super) fn new(cell: f64) -> Self {
        Self {
            cell,
            cells: HashMap::new(),
            low: IVec2::MAX,
            high: IVec2::MIN,
        }
    }

    fn key(&self, p: DVec2) -> IVec2 {
        (p / self.cell).floor().as_ivec2()
    }

    pub(super) fn add(&mut self, p: DVec2, number: u32) {
        let key = self.key(p);
        self.low = self.low.min(key);
        self.high = self.high.max(key);
        self.cells.entry(key).or_default().push(number);
    }

    pub(super) fn remove(&mut self, p: DVec2, number: u32) {
        if let Some(list) = self.cells.get_mut(&self.key(p)) {
            list.retain(|&n| n != number);
        }
    }

    /// The entry nearest to `p`; `place` tells where an entry is.
    pub(super) fn nearest(&self, p: DVec2, place: impl Fn(u32) -> DVec2) -> Option<u32> {
        let middle = self.key(p);
        let reach = (self.high - middle).max(middle - self.low);
        let last = reach.x.max(reach.y).max(0);
        // Rings that do not reach the entries are empty.
        let apart = (self.low - middle).max(middle - self.high).max(IVec2::ZERO);
        let mut best: Option<(f64, u32)> = None;
        for ring in apart.x.max(apart.y)..=last {
            // Everything in this ring and beyond is at least so far.
            if best.is_some_and(|b| b.0 <= f64::from(ring - 1).max(0.0) * self.cell) {
                break;
            }
            let mut look = |x: i32, y: i32| {
                let Some(list) = self.cells.get(&IVec2::new(x, y)) else {
                    return;
                };
                for &n in list {
                    let d = place(n).distance(p);
                    if best.is_none_or(|b| (d, n) < b) {
                        best = Some((d, n));
                    }
                }
            };
            for k in -ring..=ring {
                look(middle.x + k, middle.y - ring);
                if ring > 0 {
                    look(middle.x + k, middle.y + ring);
                }
            }
            for k in 1 - ring..ring {
                look(middle.x - ring, middle.y + k);
                look(middle.x + ring, middle.y + k);
            }
        }
        best.map(|b| b.1)
    }
}
