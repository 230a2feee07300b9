//! The local thickness of a leaf: one number for three channels.

use crate::leaf::slab_table::Column;

/// Deviations that are looked for, over the mean thickness.
const BRACKET: [f64; 2] = [-0.95, 4.0];
/// Weight of the brightness below which a channel does not count more.
const DARK: f64 = 0.02;
/// Steps of Gauss and Newton's method at most; 3 or 4 are usual.
const STEPS: usize = 12;
/// Width of the bracket in `ln (1 + d)` at which the search ends.
const WIDTH: f64 = 1e-7;

/// One channel of the mean leaf, and what a texel lets through.
#[derive(Debug, Clone)]
pub struct Channel<'a> {
    /// The tissue's albedo in the table.
    pub column: &'a Column,
    /// Mean optical thickness.
    pub delta: f64,
    /// Mean transmittance over the leaf, which weighs the channel.
    pub mean: f64,
    /// Transmittance of the texel.
    pub measured: f64,
}

impl Channel<'_> {
    /// What [`Self::error`] gives, and its slope by `ln (1 + d)`.
    fn error_and_slope(&self, thickness: f64) -> (f64, f64) {
        let (t, slope) = self.column.transmittance(self.delta * thickness);
        let scale = self.mean.max(DARK);
        ((t - self.measured) / scale, slope / scale)
    }

    fn error(&self, thickness: f64) -> f64 {
        let t = self.column.share(self.delta * thickness).t;
        (t - self.measured) / self.mean.max(DARK)
    }
}

/// The deviation d in \[-0.95, 4\] that brings `T(h (1 + d))` of all channels nearest to what was
/// measured: Gauss and Newton's method, and where that does not settle a search between the
/// channels' own answers.
#[must_use]
pub fn exact_thickness(channels: &[Channel<'_>]) -> f64 {
    let [low, high] = BRACKET.map(|d| (1.0 + d).ln());
    let mut x = 0.0_f64;
    let mut cost = f64::INFINITY;
    for _ in 0..STEPS {
        let (mut here, mut along, mut steep) = (0.0, 0.0, 0.0);
        for channel in channels {
            let (e, slope) = channel.error_and_slope(x.exp());
            here += e * e;
            along += e * slope;
            steep += slope * slope;
        }
        // Away from the minimum instead of towards it: not the place for this method.
        if here > cost * (1.0 + 1e-9) || steep <= 1e-30 {
            return searched_thickness(channels);
        }
        cost = here;
        let next = (x - (along / steep).clamp(-1.0, 1.0)).clamp(low, high);
        if (next - x).abs() < 1e-6 {
            return next.exp() - 1.0;
        }
        x = next;
    }
    searched_thickness(channels)
}

/// The same by bracketing alone. Each term is monotone in d, so the minimum lies between the
/// channels' own answers; golden section finds it there.
#[must_use]
pub fn searched_thickness(channels: &[Channel<'_>]) -> f64 {
    let own: Vec<f64> = channels.iter().filter_map(alone).collect();
    let mut low = own.iter().copied().fold(f64::INFINITY, f64::min);
    let mut high = own.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if own.is_empty() {
        return 0.0;
    }
    let cost = |x: f64| -> f64 {
        let thickness = x.exp();
        channels.iter().map(|c| c.error(thickness).powi(2)).sum()
    };
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
    let (mut fa, mut fb) = (cost(a), cost(b));
    while high - low > WIDTH {
        if fa < fb {
            high = b;
            (b, fb) = (a, fa);
            a = high - golden * (high - low);
            fa = cost(a);
        } else {
            low = a;
            (a, fa) = (b, fb);
            b = low + golden * (high - low);
            fb = cost(b);
        }
    }
    (0.5 * (low + high)).exp() - 1.0
}

/// `ln (1 + d)` of one channel alone, at an end of the bracket where it has no answer; `None` for a
/// channel that does not depend on the thickness.
fn alone(channel: &Channel<'_>) -> Option<f64> {
    if channel.delta <= 0.0 {
        return None;
    }
    let [mut low, mut high] = BRACKET.map(|d| (1.0 + d).ln());
    if channel.error(low.exp()) <= 0.0 {
        return Some(low);
    }
    if channel.error(high.exp()) >= 0.0 {
        return Some(high);
    }
    // Transmittance falls: positive at low, negative at high. False position, halved when it
    // sticks (Illinois), on an almost exponential function.
    let (mut f_low, mut f_high) = (channel.error(low.exp()), channel.error(high.exp()));
    for _ in 0..60 {
        let x = (low * f_high - high * f_low) / (f_high - f_low);
        let f = channel.error(x.exp());
        if f > 0.0 {
            (low, f_low) = (x, f);
            f_high *= 0.5;
        } else {
            (high, f_high) = (x, f);
            f_low *= 0.5;
        }
        if f.abs() < 1e-10 || high - low < WIDTH {
            return Some(x);
        }
    }
    Some(0.5 * (low + high))
}

/// The paper's closed form for one channel, `h + delta = -ln(T - B omega / 2) / sigma_t`, as a
/// deviation over the mean thickness; `None` where `T <= B omega / 2`: such veins have no answer.
#[must_use]
pub fn paper_thickness(delta: f64, scattered: f64, measured: f64) -> Option<f64> {
    let unscattered = measured - scattered;
    (unscattered > 0.0 && delta > 0.0).then(|| -unscattered.ln() / delta - 1.0)
}
