//! Lines of a drawing: polylines, and the smooth curves fitted to them.

use glam::DVec2;

/// A polyline.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Polyline {
    /// Points; of a closed line the first is not repeated.
    pub points: Vec<DVec2>,
    /// Whether the last point joins the first.
    pub closed: bool,
}

impl Polyline {
    /// Length, with the closing piece.
    #[must_use]
    pub fn length(&self) -> f64 {
        let open: f64 = self.points.windows(2).map(|p| p[0].distance(p[1])).sum();
        match (self.closed, self.points.first(), self.points.last()) {
            (true, Some(first), Some(last)) => open + last.distance(*first),
            _ => open,
        }
    }

    /// The points, and of a closed line the first again.
    pub fn round(&self) -> impl Iterator<Item = DVec2> {
        let again = self.points.first().filter(|_| self.closed);
        self.points.iter().chain(again).copied()
    }
}

/// A chain of cubic Bezier curves.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Curve {
    /// Where it starts.
    pub start: DVec2,
    /// Two control points and the end of each piece.
    pub pieces: Vec<Piece>,
    /// Whether it ends where it starts.
    pub closed: bool,
}

/// A piece of a curve, from where the one before ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Piece {
    /// Straight.
    Line(DVec2),
    /// Two control points, and the end.
    Cubic(DVec2, DVec2, DVec2),
}

impl Piece {
    /// Its end.
    #[must_use]
    pub fn end(&self) -> DVec2 {
        match *self {
            Self::Line(end) | Self::Cubic(_, _, end) => end,
        }
    }

    /// The place at `t` (0 to 1) of the piece that starts at `start`.
    #[must_use]
    pub fn at(&self, start: DVec2, t: f64) -> DVec2 {
        match *self {
            Self::Line(end) => start.lerp(end, t),
            Self::Cubic(b, c, d) => cubic([start, b, c, d], t),
        }
    }
}

impl Curve {
    /// The curve as a polyline whose points are about `step` apart.
    #[must_use]
    pub fn flattened(&self, step: f64) -> Polyline {
        let mut points = vec![self.start];
        let mut from = self.start;
        for piece in &self.pieces {
            let net = match *piece {
                Piece::Line(end) => from.distance(end),
                Piece::Cubic(b, c, d) => from.distance(b) + b.distance(c) + c.distance(d),
            };
            let count = (net / step).ceil().clamp(1.0, 4096.0) as u32;
            points.extend((1..=count).map(|k| piece.at(from, f64::from(k) / f64::from(count))));
            from = piece.end();
        }
        if self.closed && points.len() > 1 {
            points.pop();
        }
        Polyline {
            points,
            closed: self.closed,
        }
    }

    /// The curve after a map that keeps straight lines straight.
    #[must_use]
    pub fn mapped(&self, map: impl Fn(DVec2) -> DVec2) -> Self {
        let piece = |p: &Piece| match *p {
            Piece::Line(end) => Piece::Line(map(end)),
            Piece::Cubic(b, c, d) => Piece::Cubic(map(b), map(c), map(d)),
        };
        Self {
            start: map(self.start),
            pieces: self.pieces.iter().map(piece).collect(),
            closed: self.closed,
        }
    }

    /// Where it ends.
    #[must_use]
    pub fn end(&self) -> DVec2 {
        self.pieces.last().map_or(self.start, Piece::end)
    }

    /// The same curve the other way round.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let starts = std::iter::once(self.start).chain(self.pieces.iter().map(Piece::end));
        let starts: Vec<DVec2> = starts.collect();
        let turned = |(piece, start): (&Piece, &DVec2)| match *piece {
            Piece::Line(_) => Piece::Line(*start),
            Piece::Cubic(b, c, _) => Piece::Cubic(c, b, *start),
        };
        let pieces = self.pieces.iter().zip(&starts).rev().map(turned).collect();
        Self {
            start: self.end(),
            pieces,
            closed: self.closed,
        }
    }
}

/// A cubic Bezier curve at `t`.
#[must_use]
pub fn cubic([a, b, c, d]: [DVec2; 4], t: f64) -> DVec2 {
    let s = 1.0 - t;
    s * s * s * a + 3.0 * s * s * t * b + 3.0 * s * t * t * c + t * t * t * d
}
