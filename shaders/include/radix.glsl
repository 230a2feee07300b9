#ifndef RADIX_GLSL
#define RADIX_GLSL

// First number of a block of the radix sort.
uint radix_first(uint block) {
    return block * RADIX_BLOCK;
}

// One past the last number of a block of the radix sort.
uint radix_last(uint block, uint count) {
    return min(count, (block + 1u) * RADIX_BLOCK);
}

// Place of a key's digit in the table of counts, digit by digit and then block by block.
uint radix_column(uint key, uint shift, uint block, uint blocks) {
    uint digit = (key >> shift) & ((1u << RADIX_BITS) - 1u);
    return digit * blocks + block;
}

#endif
