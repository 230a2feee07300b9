// Corners in the picture so that all devices cover the same pixels with them.

// What a matrix makes of a place, by products and sums that are rounded one by one: devices may take
// the product of a matrix by fused ones.
vec4 to_clip(mat4 m, vec4 p) {
    precise vec4 clip = m[0] * p.x;
    clip += m[1] * p.y;
    clip += m[2] * p.z;
    clip += m[3] * p.w;
    return clip;
}

// A corner (clip) on a raster of sixteenths of a pixel of a picture of `size`: the coarsest that
// devices may round corners to (`subPixelPrecisionBits` is 4 or more), so that none rounds it again.
vec4 on_raster(vec4 clip, vec2 size) {
    // Behind the eye there is no place in the picture; far outside of it a float has no sixteenths.
    precise vec2 place = clip.xy / clip.w * (8.0 * size);
    if (!(clip.w > 0.0) || !all(lessThan(abs(place), vec2(4194304.0)))) {
        return clip;
    }
    return vec4(floor(place + 0.5) / (8.0 * size) * clip.w, clip.zw);
}
