//! Rotation of spherical harmonics, band by band.
//!
//! Ivanic and Ruedenberg 1996, Rotation Matrices for Real Spherical Harmonics, Direct
//! Determination by Recursion, with the corrections of 1998: every block follows from that of
//! band 1 and the one before. The recurrences hold with and without the Condon-Shortley sign.

use glam::{DMat3, DVec3};

use super::sh::MAX_ORDER;

/// Rows and columns of the largest block.
const SIDE: usize = 2 * MAX_ORDER - 1;

/// One block for each band.
#[derive(Debug, Clone, PartialEq)]
pub struct ShRotation {
    order: usize,
    /// Row, then column, both -l to l shifted by the band.
    blocks: [[[f64; SIDE]; SIDE]; MAX_ORDER],
}

impl ShRotation {
    /// The rotation of `order` bands (1 to 6) that goes with `turn`: what had the coefficients c
    /// as a function f has [`ShRotation::apply`] of c as the function d -> f(turn^-1 d).
    #[must_use]
    pub fn new(turn: DMat3, order: usize) -> Self {
        let mut out = Self {
            order: order.min(MAX_ORDER),
            blocks: [[[0.0; SIDE]; SIDE]; MAX_ORDER],
        };
        out.blocks[0][0][0] = 1.0;
        if out.order > 1 {
            // Band 1 is (y, z, x).
            let axes = [DVec3::Y, DVec3::Z, DVec3::X];
            for (row, own) in axes.iter().enumerate() {
                for (column, other) in axes.iter().enumerate() {
                    out.blocks[1][row][column] = own.dot(turn * *other);
                }
            }
        }
        for band in 2..out.order {
            let l = band as i32;
            for m in -l..=l {
                for n in -l..=l {
                    out.blocks[band][(m + l) as usize][(n + l) as usize] = out.element(l, m, n);
                }
            }
        }
        out
    }

    /// The coefficients of a turned function; bands above the order stay as they are.
    pub fn apply(&self, coefficients: &mut [DVec3]) {
        for band in 0..self.order {
            let range = band * band..(band + 1) * (band + 1);
            let mut turned = [DVec3::ZERO; SIDE];
            for (turned, row) in turned.iter_mut().zip(&self.blocks[band]).take(2 * band + 1) {
                *turned = row
                    .iter()
                    .zip(&coefficients[range.clone()])
                    .map(|(&r, &c)| r * c)
                    .sum();
            }
            coefficients[range].copy_from_slice(&turned[..2 * band + 1]);
        }
    }

    fn at(&self, l: i32, m: i32, n: i32) -> f64 {
        self.blocks[l as usize][(m + l) as usize][(n + l) as usize]
    }

    /// Element of band `l` from those of band 1 and of the band before (their table 1).
    fn element(&self, l: i32, m: i32, n: i32) -> f64 {
        let [lf, mf, nf] = [l, m.abs(), n.abs()].map(f64::from);
        let below = if n.abs() == l {
            2.0 * lf * (2.0 * lf - 1.0)
        } else {
            (lf + nf) * (lf - nf)
        };
        let zero = if m == 0 { 1.0 } else { 0.0 };
        let u = ((lf + mf) * (lf - mf) / below).sqrt();
        let v =
            0.5 * ((1.0 + zero) * (lf + mf - 1.0) * (lf + mf) / below).sqrt() * (1.0 - 2.0 * zero);
        let w = -0.5 * ((lf - mf - 1.0).max(0.0) * (lf - mf) / below).sqrt() * (1.0 - zero);
        let mut sum = 0.0;
        if u != 0.0 {
            sum += u * self.product(0, m, n, l);
        }
        if v != 0.0 {
            sum += v * self.second(l, m, n);
        }
        if w != 0.0 {
            let third = if m > 0 {
                self.product(1, m + 1, n, l) + self.product(-1, -m - 1, n, l)
            } else {
                self.product(1, m - 1, n, l) - self.product(-1, -m + 1, n, l)
            };
            sum += w * third;
        }
        sum
    }

    /// Their V.
    fn second(&self, l: i32, m: i32, n: i32) -> f64 {
        let root = std::f64::consts::SQRT_2;
        match m {
            0 => self.product(1, 1, n, l) + self.product(-1, -1, n, l),
            1 => root * self.product(1, 0, n, l),
            -1 => root * self.product(-1, 0, n, l),
            2.. => self.product(1, m - 1, n, l) - self.product(-1, -m + 1, n, l),
            _ => self.product(1, m + 1, n, l) + self.product(-1, -m - 1, n, l),
        }
    }

    /// Their P: row `i` of band 1 times row `a` of the band before `l`.
    fn product(&self, i: i32, a: i32, n: i32, l: i32) -> f64 {
        let before = l - 1;
        let (plus, zero, minus) = (self.at(1, i, 1), self.at(1, i, 0), self.at(1, i, -1));
        if n == l {
            plus * self.at(before, a, before) - minus * self.at(before, a, -before)
        } else if n == -l {
            plus * self.at(before, a, -before) + minus * self.at(before, a, before)
        } else {
            zero * self.at(before, a, n)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sampling::{fibonacci_directions, frame};
    use crate::math::sh::{MAX_COEFFICIENTS, evaluate};
    use glam::DQuat;

    /// Y(turn d) of the turned coefficients is Y(d) of the old ones.
    #[test]
    fn turned_functions_have_turned_coefficients() {
        let turns = [
            DMat3::IDENTITY,
            DMat3::from_quat(DQuat::from_axis_angle(DVec3::Z, 0.7)),
            DMat3::from_quat(DQuat::from_axis_angle(
                DVec3::new(1.0, -2.0, 0.5).normalize(),
                2.1,
            )),
            frame(DVec3::NEG_Z),
            frame(DVec3::new(0.3, -0.8, 0.1).normalize()).transpose(),
        ];
        let old: Vec<DVec3> = (0..MAX_COEFFICIENTS)
            .map(|k| {
                DVec3::new(
                    (k as f64).sin(),
                    (3.0 * k as f64).cos(),
                    1.0 / (k + 1) as f64,
                )
            })
            .collect();
        let value = |c: &[DVec3], d: DVec3| -> DVec3 {
            c.iter().zip(evaluate(d)).map(|(&c, y)| y * c).sum()
        };
        for turn in turns {
            let mut new = old.clone();
            ShRotation::new(turn, MAX_ORDER).apply(&mut new);
            for d in fibonacci_directions(60) {
                let error = (value(&new, turn * d) - value(&old, d)).abs().max_element();
                assert!(error < 1e-12, "{turn}: {error}");
            }
            // Fewer bands are the beginning of more.
            let mut few = old.clone();
            ShRotation::new(turn, 3).apply(&mut few);
            assert_eq!(few[..9], new[..9]);
            assert_eq!(few[9..], old[9..]);
        }
    }
}
