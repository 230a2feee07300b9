//! Between what values an expression lies, whatever the picture: how far the widest line reaches.

use crate::abi::{
    PAPER_ADD, PAPER_CLAMP, PAPER_LARGEST, PAPER_MAX, PAPER_MIN, PAPER_MUL, PAPER_NEG,
    PAPER_NUMBER, PAPER_SUB, PAPER_VARIABLE, PaperOp,
};

use super::expression::{VARIABLES, arguments};

/// Smallest and largest value.
type Interval = [f32; 2];

const ANYTHING: Interval = [-PAPER_LARGEST, PAPER_LARGEST];

/// The largest value that steps can leave, by the arithmetic of intervals: no less than the truth.
/// Only the shadow is known to lie between 0 and 1; what is no sum, product, least or largest can be
/// anything.
#[must_use]
pub fn largest(ops: &[PaperOp]) -> f32 {
    let mut stack: Vec<Interval> = Vec::new();
    for op in ops {
        let count = arguments(op.code).min(stack.len());
        let taken = stack.split_off(stack.len() - count);
        stack.push(left(op, &taken));
    }
    stack.last().unwrap_or(&ANYTHING)[1].min(PAPER_LARGEST)
}

fn left(op: &PaperOp, taken: &[Interval]) -> Interval {
    let shadow = VARIABLES.iter().position(|v| *v == "shadow");
    match (op.code, taken) {
        (PAPER_NUMBER, _) => [op.value; 2],
        (PAPER_VARIABLE, _) if shadow.is_some_and(|n| op.value == n as f32) => [0.0, 1.0],
        (PAPER_NEG, [a]) => [-a[1], -a[0]],
        (PAPER_ADD, [a, b]) => [a[0] + b[0], a[1] + b[1]],
        (PAPER_SUB, [a, b]) => [a[0] - b[1], a[1] - b[0]],
        (PAPER_MUL, [a, b]) => {
            let products = [a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]];
            [
                products.into_iter().fold(f32::INFINITY, f32::min),
                products.into_iter().fold(f32::NEG_INFINITY, f32::max),
            ]
        }
        (PAPER_MIN, [a, b]) => [a[0].min(b[0]), a[1].min(b[1])],
        (PAPER_MAX, [a, b]) => [a[0].max(b[0]), a[1].max(b[1])],
        (PAPER_CLAMP, [a, low, high]) => {
            [a[0].max(low[0]).min(high[0]), a[1].max(low[1]).min(high[1])]
        }
        _ => ANYTHING,
    }
}

#[cfg(test)]
mod tests {
    use super::super::expression::Program;
    use super::*;

    #[test]
    fn bounds_are_no_less_than_the_largest_value() {
        let most = |text: &str| largest(&Program::new(text).unwrap().ops);
        assert!((most("0.4 + 1.8*shadow") - 2.2).abs() < 1e-6);
        assert!((most("2 - 3*(1 - shadow)") - 2.0).abs() < 1e-6);
        assert!((most("min(x, 3) + max(shadow, 0.5)") - 4.0).abs() < 1e-6);
        assert!((most("clamp(z, 0.5, 1.5)") - 1.5).abs() < 1e-6);
        assert!((most("-(0.5 - shadow)") - 0.5).abs() < 1e-6);
        for anything in ["x", "sqrt(shadow)", "1/shadow", "tone", "2*y"] {
            assert!(most(anything) >= PAPER_LARGEST, "{anything}");
        }
        assert!(largest(&[]) >= PAPER_LARGEST);
    }
}
