#ifndef LEAF_DIRECTIONAL_GLSL
#define LEAF_DIRECTIONAL_GLSL

// What light that does not come straight down meets, over what straight light meets: a table over
// the cosine for every material (`leaf/directional.rs`). The shader that includes this declares
// before it
//     layout(constant_id = 7) const uint DIRECTIONAL = 0;
//     layout(..) restrict readonly buffer Turns { LeafTurn turns[]; };

// `leaf` of a material for light at `cosine` to the normal of its front.
LeafSides leaf_for_light(LeafSides leaf, uint material, float cosine) {
    if (DIRECTIONAL == 0u) {
        return leaf;
    }
    float at = min(abs(cosine), 1.0) * float(LEAF_TURN_NODES - 1u);
    uint cell = min(uint(at), LEAF_TURN_NODES - 2u);
    float f = at - float(cell);
    LeafTurn low = turns[material * LEAF_TURN_NODES + cell];
    LeafTurn high = turns[material * LEAF_TURN_NODES + cell + 1u];
    leaf.rho_d_front *= mix(low.front, high.front, f);
    leaf.rho_d_back *= mix(low.back, high.back, f);
    leaf.rho_t *= cosine > 0.0 ? mix(low.down, high.down, f) : mix(low.up, high.up, f);
    return leaf;
}

#endif
