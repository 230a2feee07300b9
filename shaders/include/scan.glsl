#ifndef SCAN_GLSL
#define SCAN_GLSL

// Values of one chunk: [scan_first, scan_last).
uint scan_first(uint chunk) {
    return chunk * SCAN_CHUNK;
}

uint scan_last(uint chunk, uint count) {
    return min((chunk + 1u) * SCAN_CHUNK, count);
}

#endif
