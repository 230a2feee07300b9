#ifndef BINS_GLSL
#define BINS_GLSL

// Bin coordinates of a point; points outside belong to the bins at the border.
uvec3 bin_of(vec3 p, vec3 origin, float inverse_edge, uvec3 bins) {
    vec3 b = floor((p - origin) * inverse_edge);
    return uvec3(clamp(b, vec3(0.0), vec3(bins - 1u)));
}

// Bins in rows, x fastest, so that a run of bins along x is one range of sorted points.
uint row_index(uvec3 b, uvec3 bins) {
    return b.x + bins.x * (b.y + bins.y * b.z);
}

// Every third bit of the ten lowest bits.
uint spread(uint v) {
    v = (v | (v << 16u)) & 0x030000ffu;
    v = (v | (v << 8u)) & 0x0300f00fu;
    v = (v | (v << 4u)) & 0x030c30c3u;
    v = (v | (v << 2u)) & 0x09249249u;
    return v;
}

// Morton order: neighbours in the order are neighbours in space.
uint morton_index(uvec3 b) {
    return spread(b.x) | (spread(b.y) << 1u) | (spread(b.z) << 2u);
}

// Distance from the interval [low, high] to bin `b` along one axis.
float bin_gap(float low, float high, float origin, float edge, int b) {
    float bin_low = origin + float(b) * edge;
    return max(max(low - (bin_low + edge), bin_low - high), 0.0);
}

// First and last bin along one axis that meet [low - reach, high + reach].
ivec2 bin_range(float low, float high, float reach, float origin, float inverse_edge, uint bins) {
    float last = float(bins) - 1.0;
    float a = floor((low - reach - origin) * inverse_edge);
    float b = floor((high + reach - origin) * inverse_edge);
    return ivec2(int(clamp(a, 0.0, last)), int(clamp(b, 0.0, last)));
}

#endif
