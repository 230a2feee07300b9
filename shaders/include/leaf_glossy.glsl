#ifndef LEAF_GLOSSY_GLSL
#define LEAF_GLOSSY_GLSL

// The glossy term of Wang et al. 2005, eq. 7, with the cosine of incidence cancelled; see
// `leaf/glossy.rs`. Includes "abi.glsl" first.

const float GLOSSY_PI = 3.14159265358979;

// Beckmann's distribution of half vectors.
float glossy_distribution(float cos_half, float m) {
    float c2 = clamp(cos_half * cos_half, 1e-12, 1.0);
    float tan2 = (1.0 - c2) / c2;
    return exp(-tan2 / (m * m)) / (GLOSSY_PI * m * m * c2 * c2);
}

// The error function of x >= 0 (Abramowitz and Stegun 1964, 7.1.26), within 1.5e-7.
float glossy_erf(float x) {
    float t = 1.0 / (1.0 + 0.3275911 * x);
    float p = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429))));
    return 1.0 - p * exp(-x * x);
}

// Smith's Lambda.
float glossy_smith(float cosine, float m) {
    float sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    float a = cosine / max(m * sine, 1e-30);
    if (a > 5.0) {
        return 0.0;
    }
    return 0.5 * (glossy_erf(a) - 1.0) + exp(-a * a) / (2.0 * a * sqrt(GLOSSY_PI));
}

// f_s cos_i / rho_s, 1/sr, from the cosines of incidence, reflection and half vector to the normal;
// `safe`: with Smith's masking and shadowing, which keeps the energy.
float glossy(float cos_i, float cos_r, float cos_half, float roughness, bool safe) {
    if (!(cos_i > 0.0 && cos_r > 0.0 && cos_half > 0.0)) {
        return 0.0;
    }
    float m = max(roughness, GLOSSY_MIN_ROUGHNESS);
    float g = safe ? 1.0 / (1.0 + glossy_smith(cos_i, m) + glossy_smith(cos_r, m)) : 1.0;
    return g * glossy_distribution(cos_half, m) / (4.0 * max(cos_r, GLOSSY_MIN_COSINE));
}

#endif
