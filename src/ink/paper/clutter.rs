//! How crowded a drawing is: the a-priori density of lines (Grabli, Durand, Sillion 2004) about
//! every place, of which the upper tail tells where lines run together.

use glam::DVec2;

use super::svg::Drawing;

/// Length of line on an area, about the places where there are lines.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Clutter {
    /// Mean, millimetres of line on a square millimetre.
    pub mean: f64,
    /// What one place of twenty exceeds.
    pub tail: f64,
    /// Length of all lines, millimetres.
    pub length: f64,
}

/// The density of a drawing's strokes in squares of `edge` millimetres.
#[must_use]
pub fn clutter(drawing: &Drawing, edge: f64) -> Clutter {
    let [w, h] = drawing
        .paper
        .map(|s| ((s / edge).ceil() as usize).clamp(1, 1 << 14));
    let mut squares = vec![0.0_f64; w * h];
    let mut length = 0.0;
    for stroke in drawing.layers.iter().flat_map(|l| &l.strokes) {
        let round: Vec<DVec2> = stroke.line.round().collect();
        for pair in round.windows(2) {
            let way = pair[0].distance(pair[1]);
            // Pieces shorter than a square, so that each falls into its own.
            let pieces = (4.0 * way / edge).ceil().clamp(1.0, 1e4) as u32;
            for k in 0..pieces {
                let p = pair[0].lerp(pair[1], (f64::from(k) + 0.5) / f64::from(pieces)) / edge;
                if p.x >= 0.0 && p.y >= 0.0 && p.x < w as f64 && p.y < h as f64 {
                    squares[p.y as usize * w + p.x as usize] += way / f64::from(pieces);
                }
            }
            length += way;
        }
    }
    let mut dense: Vec<f64> = squares.into_iter().filter(|&s| s > 0.0).collect();
    if dense.is_empty() {
        return Clutter::default();
    }
    dense.sort_by(f64::total_cmp);
    let area = edge * edge;
    Clutter {
        mean: dense.iter().sum::<f64>() / (area * dense.len() as f64),
        tail: dense[(dense.len() - 1) * 19 / 20] / area,
        length,
    }
}

#[cfg(test)]
mod tests {
    use super::super::curve::Polyline;
    use super::super::pen::Pen;
    use super::super::svg::Layer;
    use super::*;

    #[test]
    fn lines_a_millimetre_apart_have_a_density_of_one_and_twice_as_many_of_two() {
        let lines = |gap: f64| {
            let one = |k: u32| {
                let x = 10.0 + gap * f64::from(k) + 0.01;
                let line = Polyline {
                    points: vec![DVec2::new(x, 10.0), DVec2::new(x, 40.0)],
                    closed: false,
                };
                Pen::default().draw(&line, 0, |_| 1.0)
            };
            let strokes = (0..(30.0 / gap) as u32).map(one).collect();
            let layer = Layer {
                strokes,
                ..Layer::default()
            };
            Drawing {
                paper: [50.0, 50.0],
                layers: vec![layer],
                ..Drawing::default()
            }
        };
        let (one, two) = (clutter(&lines(1.0), 2.0), clutter(&lines(0.5), 2.0));
        assert!((one.mean - 1.0).abs() < 0.02 && (two.mean - 2.0).abs() < 0.02);
        assert!((one.tail - 1.0).abs() < 0.02 && (two.tail - 2.0).abs() < 0.02);
        assert!((one.length - 900.0).abs() < 1e-6);
        assert_eq!(clutter(&Drawing::default(), 2.0), Clutter::default());
    }
}
