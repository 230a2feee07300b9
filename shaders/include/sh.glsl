#ifndef SH_GLSL
#define SH_GLSL

// Real spherical harmonics of the first `order` bands (1 to 6) at a unit direction: pole z, no
// Condon-Shortley sign, index l(l+1)+m; the rest of `sh` is left as it was. Where `order` is a
// constant, the bands above it cost nothing. The other half is src/math/sh.rs.
void spherical_harmonics(vec3 d, uint order, inout float sh[SH_MAX_COEFFICIENTS]) {
    float x = d.x;
    float y = d.y;
    float z = d.z;
    float z2 = z * z;
    float plane = x * x - y * y;
    sh[0] = 0.28209479177387814;
    if (order > 1u) {
        sh[1] = 0.4886025119029199 * y;
        sh[2] = 0.4886025119029199 * z;
        sh[3] = 0.4886025119029199 * x;
    }
    if (order > 2u) {
        sh[4] = 1.0925484305920792 * x * y;
        sh[5] = 1.0925484305920792 * y * z;
        sh[6] = 0.31539156525252005 * (3.0 * z2 - 1.0);
        sh[7] = 1.0925484305920792 * x * z;
        sh[8] = 0.5462742152960396 * plane;
    }
    if (order > 3u) {
        sh[9] = 0.5900435899266435 * y * (3.0 * x * x - y * y);
        sh[10] = 2.890611442640554 * x * y * z;
        sh[11] = 0.4570457994644658 * y * (5.0 * z2 - 1.0);
        sh[12] = 0.3731763325901154 * z * (5.0 * z2 - 3.0);
        sh[13] = 0.4570457994644658 * x * (5.0 * z2 - 1.0);
        sh[14] = 1.445305721320277 * z * plane;
        sh[15] = 0.5900435899266435 * x * (x * x - 3.0 * y * y);
    }
    if (order > 4u) {
        sh[16] = 2.5033429417967046 * x * y * plane;
        sh[17] = 1.7701307697799304 * y * z * (3.0 * x * x - y * y);
        sh[18] = 0.9461746957575601 * x * y * (7.0 * z2 - 1.0);
        sh[19] = 0.6690465435572892 * y * z * (7.0 * z2 - 3.0);
        sh[20] = 0.10578554691520431 * (35.0 * z2 * z2 - 30.0 * z2 + 3.0);
        sh[21] = 0.6690465435572892 * x * z * (7.0 * z2 - 3.0);
        sh[22] = 0.47308734787878004 * plane * (7.0 * z2 - 1.0);
        sh[23] = 1.7701307697799304 * x * z * (x * x - 3.0 * y * y);
        sh[24] = 0.6258357354491761 * (x * x * x * x - 6.0 * x * x * y * y + y * y * y * y);
    }
    if (order > 5u) {
        float fours = x * x * x * x - 6.0 * x * x * y * y + y * y * y * y;
        sh[25] = 0.6563820568401701 * y * (5.0 * x * x * x * x - 10.0 * x * x * y * y + y * y * y * y);
        sh[26] = 8.302649259524166 * x * y * z * plane;
        sh[27] = 0.4892382994352505 * y * (3.0 * x * x - y * y) * (9.0 * z2 - 1.0);
        sh[28] = 4.793536784973324 * x * y * z * (3.0 * z2 - 1.0);
        sh[29] = 0.452946651195697 * y * (21.0 * z2 * z2 - 14.0 * z2 + 1.0);
        sh[30] = 0.1169503224534236 * z * (63.0 * z2 * z2 - 70.0 * z2 + 15.0);
        sh[31] = 0.452946651195697 * x * (21.0 * z2 * z2 - 14.0 * z2 + 1.0);
        sh[32] = 2.396768392486662 * plane * z * (3.0 * z2 - 1.0);
        sh[33] = 0.4892382994352505 * x * (x * x - 3.0 * y * y) * (9.0 * z2 - 1.0);
        sh[34] = 2.0756623148810416 * z * fours;
        sh[35] = 0.6563820568401701 * x * (x * x * x * x - 10.0 * x * x * y * y + 5.0 * y * y * y * y);
    }
}

#endif
