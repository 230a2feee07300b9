//! Special functions of radiative transfer: exponential integrals, Legendre functions of the first
//! and second kind, Gauss-Legendre nodes.

/// Euler's constant.
const EULER: f64 = 0.577_215_664_901_532_9;
/// Terms of a series or continued fraction at most.
const TERMS: usize = 200;

/// Exponential integral `E_1(x)`, x > 0: series below 1, continued fraction (Lentz) above.
#[must_use]
pub fn e1(x: f64) -> f64 {
    if x <= 0.0 {
        return f64::INFINITY;
    }
    if x > 745.0 {
        return 0.0;
    }
    if x < 1.0 {
        let mut term = 1.0;
        let mut sum = -EULER - x.ln();
        for n in 1..TERMS {
            term *= -x / n as f64;
            let add = -term / n as f64;
            sum += add;
            if add.abs() < 1e-17 * sum.abs() {
                break;
            }
        }
        return sum;
    }
    // Abramowitz and Stegun 1964, 5.1.22, evaluated by the modified Lentz method.
    let mut b = x + 1.0;
    let mut c = f64::INFINITY;
    let mut d = 1.0 / b;
    let mut h = d;
    for n in 1..TERMS {
        let a = -((n * n) as f64);
        b += 2.0;
        d = 1.0 / (a * d + b);
        c = b + a / c;
        h *= c * d;
        if (c * d - 1.0).abs() < 1e-16 {
            break;
        }
    }
    h * (-x).exp()
}

/// Exponential integrals `E_2` and `E_3` of x >= 0.
#[must_use]
pub fn e2_e3(x: f64) -> (f64, f64) {
    if x <= 0.0 {
        return (1.0, 0.5);
    }
    let e = (-x).exp();
    if x < 2.0 {
        let e2 = e - x * e1(x);
        return (e2, 0.5 * (e - x * e2));
    }
    // The recurrence cancels for large x: the continued fraction of E_n keeps its digits.
    (en_fraction(2, x) * e, en_fraction(3, x) * e)
}

/// `E_n(x) e^x` by continued fraction, x >= 1.
fn en_fraction(n: u32, x: f64) -> f64 {
    let order = f64::from(n);
    let mut b = x + order;
    let mut c = f64::INFINITY;
    let mut d = 1.0 / b;
    let mut h = d;
    for i in 1..TERMS {
        let i = i as f64;
        let a = -i * (order - 1.0 + i);
        b += 2.0;
        d = 1.0 / (a * d + b);
        c = b + a / c;
        h *= c * d;
        if (c * d - 1.0).abs() < 1e-16 {
            break;
        }
    }
    h
}

/// Legendre polynomials `P_0(x)` to `P_{N-1}(x)`.
#[must_use]
pub fn legendre_p<const N: usize>(x: f64) -> [f64; N] {
    let mut p = [1.0; N];
    if N > 1 {
        p[1] = x;
    }
    for n in 1..N.saturating_sub(1) {
        let k = n as f64;
        p[n + 1] = ((2.0 * k + 1.0) * x * p[n] - k * p[n - 1]) / (k + 1.0);
    }
    p
}

/// Legendre functions of the second kind `Q_0` to `Q_{N-1}` at `1 + above`.
///
/// On the cut (`-2 < above < 0`) the principal value, by forward recurrence, which is stable
/// there; beyond it by Miller's backward recurrence, and forward where the argument is so close to
/// 1 that backward would need too many steps. The argument is given by its distance from 1,
/// because the logarithm in `Q_0` needs that distance in full precision.
#[must_use]
pub fn legendre_q<const N: usize>(above: f64) -> [f64; N] {
    let x = 1.0 + above;
    let q0 = 0.5 * ((2.0 + above) / above.abs()).ln();
    let near = above < 1e-3 / (N * N) as f64;
    let mut q = [q0; N];
    if near {
        if N > 1 {
            q[1] = x * q0 - 1.0;
        }
        for n in 1..N.saturating_sub(1) {
            let k = n as f64;
            q[n + 1] = ((2.0 * k + 1.0) * x * q[n] - k * q[n - 1]) / (k + 1.0);
        }
        return q;
    }
    let start = N + 20 + (20.0 / above.sqrt()) as usize;
    let (mut higher, mut here) = (0.0, 1e-280);
    for n in (1..=start).rev() {
        let k = n as f64;
        let lower = ((2.0 * k + 1.0) * x * here - (k + 1.0) * higher) / k;
        (higher, here) = (here, lower);
        if n - 1 < N {
            q[n - 1] = here;
        }
        if here.abs() > 1e200 {
            higher *= 1e-200;
            here *= 1e-200;
            for v in q.iter_mut().skip(n - 1) {
                *v *= 1e-200;
            }
        }
    }
    let scale = q0 / q[0];
    q.map(|v| v * scale)
}

/// The error function: its series below 2.5, a continued fraction of its complement above.
#[must_use]
pub fn erf(x: f64) -> f64 {
    let y = x.abs();
    let value = if y < 2.5 {
        // Abramowitz and Stegun 1964, 7.1.6: all terms are positive.
        let mut term = y;
        let mut sum = y;
        for n in 1..TERMS {
            term *= 2.0 * y * y / (2 * n + 1) as f64;
            sum += term;
            if term < 1e-17 * sum {
                break;
            }
        }
        std::f64::consts::FRAC_2_SQRT_PI * (-y * y).exp() * sum
    } else {
        // 7.1.14, from the back.
        let fraction = (1..60).rev().fold(y, |f, n| y + 0.5 * f64::from(n) / f);
        1.0 - (-y * y).exp() / (std::f64::consts::PI.sqrt() * fraction)
    };
    value.copysign(x)
}

/// Nodes and weights of Gauss-Legendre quadrature on \[-1, 1\].
#[must_use]
pub fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    (0..count)
        .map(|i| {
            let n = count as f64;
            let mut x = ((i as f64 + 0.75) / (n + 0.5) * std::f64::consts::PI).cos();
            let mut slope = 1.0;
            for _ in 0..100 {
                let (mut p0, mut p1) = (1.0, x);
                for k in 1..count {
                    let k = k as f64;
                    (p0, p1) = (p1, ((2.0 * k + 1.0) * x * p1 - k * p0) / (k + 1.0));
                }
                slope = n * (x * p1 - p0) / (x * x - 1.0);
                let step = p1 / slope;
                x -= step;
                if step.abs() < 1e-15 {
                    break;
                }
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64, relative: f64) {
        assert!((a - b).abs() <= relative * b.abs(), "{a} {b}");
    }

    /// Abramowitz and Stegun 1964, table 5.1, and identities.
    #[test]
    fn exponential_integrals() {
        close(e1(0.5), 0.559_773_595, 1e-8);
        close(e1(1.0), 0.219_383_934_4, 1e-9);
        close(e1(2.0), 0.048_900_510_7, 1e-9);
        for x in [1e-6, 1e-3, 0.1, 0.7, 1.5, 2.5, 10.0, 40.0] {
            let (e2, e3) = e2_e3(x);
            let h = 1e-3 * x;
            close((e2_e3(x - h).0 - e2_e3(x + h).0) / (2.0 * h), e1(x), 1e-3);
            close((e2_e3(x - h).1 - e2_e3(x + h).1) / (2.0 * h), e2, 1e-3);
            close(2.0 * e3 + x * e2, (-x).exp(), 1e-12);
        }
        assert_eq!(e2_e3(0.0), (1.0, 0.5));
    }

    #[test]
    fn error_function() {
        close(erf(0.5), 0.520_499_877_8, 1e-9);
        close(erf(1.0), 0.842_700_792_9, 1e-9);
        close(erf(2.0), 0.995_322_265_0, 1e-9);
        close(erf(-3.0), -0.999_977_909_503, 1e-11);
        assert!((erf(2.5 - 1e-12) - erf(2.5)).abs() < 1e-12, "no step");
        assert!(erf(0.0) == 0.0 && erf(9.0) == 1.0);
    }

    #[test]
    fn legendre_functions() {
        let p = legendre_p::<4>(0.3);
        close(p[3], 0.5 * (5.0 * 0.027 - 0.9), 1e-14);
        // Wronskian: P_n Q_{n-1} - P_{n-1} Q_n = 1/n.
        for above in [-1.7, -0.4, -1e-6, 1e-9, 1e-5, 1e-3, 0.1, 3.0, 1e4] {
            let p = legendre_p::<8>(1.0 + above);
            let q = legendre_q::<8>(above);
            let wronskian = p[1] * q[0] - p[0] * q[1];
            assert!((wronskian - 1.0).abs() < 1e-9, "{above}: {wronskian}");
            let last = 7.0 * (p[7] * q[6] - p[6] * q[7]);
            assert!((last - 1.0).abs() < 1e-5, "{above}: {last}");
        }
    }

    #[test]
    fn quadrature_integrates_polynomials() {
        for n in [1, 2, 5, 16, 40] {
            let nodes = gauss_legendre(n);
            let degree = 2 * n as i32 - 2;
            let sum: f64 = nodes.iter().map(|(x, w)| w * x.powi(degree)).sum();
            close(sum, 2.0 / f64::from(degree + 1), 1e-12);
        }
    }
}
