//! Twin of `leaf/albedo.comp` and `leaf_slab.glsl`: the slab table's read and a texel's shares.

use crate::abi::{
    LEAF_PAPER, LeafTissue, SLAB_COEFFICIENTS, SLAB_LN_THICK, SLAB_LN_THIN, SLAB_NODES,
    SLAB_SQRT_3, SLAB_TWO_ENDS,
};

fn slab_weights(f: f64) -> [f64; 4] {
    let g = 1.0 - f;
    [
        g * g * g / 6.0,
        ((3.0 * f - 6.0) * f * f + 4.0) / 6.0,
        ((3.0 * g - 6.0) * g * g + 4.0) / 6.0,
        f * f * f / 6.0,
    ]
}

fn slab_spline(table: &[[f32; 2]], s: f64, ln_delta: f64) -> [f64; 2] {
    let (thin, thick) = (f64::from(SLAB_LN_THIN), f64::from(SLAB_LN_THICK));
    let nodes = f64::from(SLAB_NODES - 1);
    let at = [s, (ln_delta - thin) / (thick - thin)].map(|x| (x * nodes).clamp(0.0, nodes));
    let cell = at.map(|x| x.floor().min(nodes - 1.0));
    let [ws, wv] = [0, 1].map(|k| slab_weights(at[k] - cell[k]));
    let mut sum = [0.0; 2];
    for (i, w) in ws.iter().enumerate() {
        for (j, v) in wv.iter().enumerate() {
            let at = (cell[0] as usize + i) * SLAB_COEFFICIENTS as usize + cell[1] as usize + j;
            for q in 0..2 {
                sum[q] += w * v * f64::from(table[at][q]);
            }
        }
    }
    sum
}

fn slab_inside(table: &[[f32; 2]], omega: f64, delta: f64) -> [f64; 2] {
    let q = (1.0 - omega).clamp(0.0, 1.0);
    let s = q.sqrt();
    let spline = slab_spline(table, s, delta.ln());
    let k = f64::from(SLAB_SQRT_3) * s * (1.0 - q * (0.4 + q * (12.0 / 175.0)));
    let x = delta + f64::from(SLAB_TWO_ENDS);
    let kx = k * x;
    let rest = if kx < 1e-4 {
        x * (1.0 - kx)
    } else {
        -(-2.0 * kx).exp_m1() / (2.0 * k)
    };
    let b = (spline[1] - kx - rest.ln()).max(-80.0).exp();
    [spline[0].exp() - b * (-kx.min(80.0)).exp(), b]
}

/// A and B from the spline's coefficients.
#[must_use]
pub fn slab_read(table: &[[f32; 2]], omega: f64, delta: f64) -> [f64; 2] {
    let edge = f64::from(SLAB_LN_THIN).exp();
    if delta >= edge {
        return slab_inside(table, omega, delta);
    }
    if delta.is_nan() || delta <= 0.0 {
        return [0.0; 2];
    }
    let t = delta / edge * (1.0 - delta.ln()) / (1.0 - f64::from(SLAB_LN_THIN));
    slab_inside(table, omega, edge).map(|v| delta * ((v / edge).ln() * t).exp())
}

/// Diffuse reflectance and transmittance of a texel, gamma in RGB and deviation in A.
#[must_use]
pub fn leaf_albedo(table: &[[f32; 2]], side: &LeafTissue, texel: [f32; 4]) -> [[f64; 3]; 2] {
    let mut out = [[0.0; 3]; 2];
    for c in 0..3 {
        let (absorption, scattering) =
            (f64::from(side.absorption[c]), f64::from(side.scattering[c]));
        let total = absorption + scattering;
        let omega = if total > 0.0 { scattering / total } else { 0.0 };
        let delta = total * (1.0 + f64::from(texel[3])).max(0.0);
        let [a, b] = if side.mode == LEAF_PAPER {
            [f64::from(side.a[c]), f64::from(side.b[c])]
        } else {
            slab_read(table, omega, delta)
        };
        let through = (-delta).exp() + 0.5 * omega * b;
        let mut back = f64::from(texel[c]) * 0.5 * omega * a;
        if side.mode != LEAF_PAPER {
            back = back.min(1.0 - through).max(0.0);
        }
        out[0][c] = back;
        out[1][c] = through;
    }
    out
}
