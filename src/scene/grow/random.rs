//! Seeded random numbers: `SplitMix64` (Steele, Lea, Flood 2014).

/// A stream of random numbers; the same seed gives the same stream everywhere.
#[derive(Debug, Clone)]
pub(super) struct Random {
    state: u64,
}

impl Random {
    /// A stream for a seed.
    pub(super) fn new(seed: u64) -> Self {
        Self {
            state: mix(seed ^ 0x5851_f42d_4c95_7f2d),
        }
    }

    /// A stream of its own for a part of the plant, which does not advance this one.
    pub(super) fn fork(&self, tag: u64) -> Self {
        Self {
            state: mix(self.state ^ mix(tag.wrapping_mul(0xd6e8_feb8_6659_fd93))),
        }
    }

    /// The next 64 bits.
    pub(super) fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mix(self.state)
    }

    /// Uniform in \[0, 1).
    pub(super) fn unit(&mut self) -> f64 {
        // 53 bits fill the mantissa of an f64
        (self.bits() >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }

    /// Uniform in (-1, 1): the paper's sign for "plus or minus the variation".
    pub(super) fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }
}

/// The finaliser of `SplitMix64`.
fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_uniform_and_repeatable() {
        let mut a = Random::new(7);
        let mut b = Random::new(7);
        let mean = (0..10_000).map(|_| a.unit()).sum::<f64>() / 10_000.0;
        assert!((mean - 0.5).abs() < 0.01, "{mean}");
        let again = (0..10_000).map(|_| b.unit()).sum::<f64>() / 10_000.0;
        assert_eq!(mean.to_bits(), again.to_bits());
        assert_ne!(Random::new(1).fork(1).bits(), Random::new(1).fork(2).bits());
    }
}
