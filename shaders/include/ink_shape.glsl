#ifndef INK_SHAPE_GLSL
#define INK_SHAPE_GLSL

// Alpha of a shape at a place in radii: 1 at the leaf's outline and within, less on the way to the
// disc, below 0 outside of that.
float leaf_alpha(sampler2D shapes, vec2 local, uint shape) {
    float size = float(INK_SHAPE_SIZE);
    vec2 inside = clamp((vec2(local.x, -local.y) * 0.5 + 0.5) * size, vec2(0.5), vec2(size - 0.5));
    vec2 at = vec2(inside.x, inside.y + size * float(shape)) / vec2(textureSize(shapes, 0));
    float alpha = textureLod(shapes, at, 0.0).r * (255.0 / 128.0);
    return dot(local, local) <= 1.0 ? alpha : -1.0;
}

#endif
