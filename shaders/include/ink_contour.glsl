#ifndef INK_CONTOUR_GLSL
#define INK_CONTOUR_GLSL

// Depth as the contour compares it: 0 to 1 over the plants' range. What shows nothing is
// infinitely far.
float contour_depth(float depth, uint mapping, float nearest, float farthest) {
    float span = farthest - nearest;
    if (depth <= 0.0) {
        return 1e9;
    }
    return mapping == INK_DEPTH_MAPPED ? farthest * (depth - nearest) / (depth * span)
                                       : (depth - nearest) / span;
}

#endif
