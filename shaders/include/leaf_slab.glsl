#ifndef LEAF_SLAB_GLSL
#define LEAF_SLAB_GLSL

// The slab's A and B at normal incidence from the table of `leaf/slab_table.rs`. The shader that
// includes this declares before it
//     layout(..) restrict readonly buffer SlabTable { vec2 slab_table[]; };
// with the coefficients of the spline. Includes "abi.glsl" first.

// Weights of the uniform cubic B-spline at f in [0, 1] between two nodes.
vec4 slab_weights(float f) {
    float g = 1.0 - f;
    return vec4(g * g * g, (3.0 * f - 6.0) * f * f + 4.0, (3.0 * g - 6.0) * g * g + 4.0, f * f * f) / 6.0;
}

// ln P and ln (B sinh(k x) / k) at s = sqrt(1 - omega) and ln Delta, held beyond the thick end.
vec2 slab_spline(float s, float ln_delta) {
    float nodes = float(SLAB_NODES - 1u);
    vec2 at = vec2(s, (ln_delta - SLAB_LN_THIN) / (SLAB_LN_THICK - SLAB_LN_THIN)) * nodes;
    at = clamp(at, vec2(0.0), vec2(nodes));
    vec2 cell = min(floor(at), vec2(nodes - 1.0));
    vec4 ws = slab_weights(at.x - cell.x);
    vec4 wv = slab_weights(at.y - cell.y);
    uint first = uint(cell.x) * SLAB_COEFFICIENTS + uint(cell.y);
    vec2 sum = vec2(0.0);
    for (uint i = 0u; i < 4u; i++) {
        uint row = first + i * SLAB_COEFFICIENTS;
        sum += ws[i] * (wv.x * slab_table[row] + wv.y * slab_table[row + 1u]
            + wv.z * slab_table[row + 2u] + wv.w * slab_table[row + 3u]);
    }
    return sum;
}

// (A, B) from the table on, delta >= exp(SLAB_LN_THIN).
vec2 slab_inside(float omega, float delta) {
    float q = clamp(1.0 - omega, 0.0, 1.0);
    float s = sqrt(q);
    vec2 spline = slab_spline(s, log(delta));
    float k = SLAB_SQRT_3 * s * (1.0 - q * (0.4 + q * (12.0 / 175.0)));
    float x = delta + SLAB_TWO_ENDS;
    float kx = k * x;
    // (1 - e^{-2 k x}) / (2 k) by its series where the difference would lose its digits.
    float rest = kx < 0.01 ? x * (1.0 - kx * (1.0 - kx * (2.0 / 3.0))) : (1.0 - exp(-2.0 * kx)) / (2.0 * k);
    // Beyond e^-80 nothing is left that f32 could hold.
    float b = exp(max(spline.y - kx - log(rest), -80.0));
    return vec2(exp(spline.x) - b * exp(-min(kx, 80.0)), b);
}

// (A, B) of a slab of any thickness.
vec2 slab_read(float omega, float delta) {
    float edge = exp(SLAB_LN_THIN);
    if (delta >= edge) {
        return slab_inside(omega, delta);
    }
    if (!(delta > 0.0)) {
        return vec2(0.0);
    }
    float t = delta / edge * (1.0 - log(delta)) / (1.0 - SLAB_LN_THIN);
    return delta * exp(log(slab_inside(omega, edge) / edge) * t);
}

// Diffuse reflectance and transmittance of one channel of a texel: x reflected, y transmitted.
// Absorption and scattering are times the thickness, `swelling` is 1 + d, `constants` are the
// paper's A and B.
vec2 leaf_share(float absorption, float scattering, float swelling, float gamma, vec2 constants, uint mode) {
    float total = absorption + scattering;
    float omega = total > 0.0 ? scattering / total : 0.0;
    float delta = total * max(swelling, 0.0);
    vec2 ab = mode == LEAF_PAPER ? constants : slab_read(omega, delta);
    float through = exp(-delta) + 0.5 * omega * ab.y;
    float back = gamma * 0.5 * omega * ab.x;
    // gamma may not give back more than came in; the paper lets it.
    if (mode != LEAF_PAPER) {
        back = max(min(back, 1.0 - through), 0.0);
    }
    return vec2(back, through);
}

#endif
