#ifndef INK_STYLE_GLSL
#define INK_STYLE_GLSL

// Style and object of a pixel are one number, 0 where nothing is: the background is the first
// style's.
float style_and_object(uint style, uint object) {
    return float(style * INK_OBJECTS + object) + 1.0;
}

uint style_of(float id) {
    return id > 0.0 ? uint(id - 1.0) / INK_OBJECTS : 0u;
}

#endif
