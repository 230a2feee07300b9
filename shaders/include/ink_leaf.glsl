#ifndef INK_LEAF_GLSL
#define INK_LEAF_GLSL

// Where a leaf goes and how it turns (Coconu, Deussen, Hege 2006, section 5).

// From the cluster's centre to the leaf; the leaf's own normal where it lies in the centre.
vec3 cluster_normal(InkLeaf leaf, InkCluster cluster) {
    vec3 away = leaf.centre - cluster.centre;
    float distance = length(away);
    return distance > 1e-6 * cluster.radius ? away / distance : leaf.normal;
}

// P(beta) = (1 - beta) P + beta (C + r n).
vec3 displaced(InkLeaf leaf, InkCluster cluster, vec3 outward, float beta) {
    return mix(leaf.centre, cluster.centre + cluster.radius * outward, beta);
}

// Own normal, cluster's normal, viewer's direction, blended one after the other. Two-sided: what
// points away turns round first.
vec3 turned_normal(InkLeaf leaf, vec3 outward, vec3 to_viewer, float orientation, float facing) {
    vec3 own = dot(leaf.normal, outward) < 0.0 ? -leaf.normal : leaf.normal;
    vec3 n = mix(own, outward, orientation);
    n = dot(n, n) > 1e-12 ? normalize(n) : outward;
    vec3 seen = dot(n, to_viewer) < 0.0 ? -n : n;
    vec3 t = mix(seen, to_viewer, facing);
    t = dot(t, t) > 1e-12 ? normalize(t) : to_viewer;
    // The side that it showed stays: nothing turns over when facing sets in.
    return facing > 0.0 ? (dot(n, to_viewer) < 0.0 ? -t : t) : n;
}

// The axis after the smallest turn that takes `from` (or its opposite) to `to`.
vec3 turned_axis(vec3 axis, vec3 from, vec3 to) {
    vec3 f = dot(from, to) < 0.0 ? -from : from;
    vec3 w = cross(f, to);
    float c = dot(f, to);
    // Rodrigues' formula with 1 / (1 + c); c is at least 0.
    vec3 a = axis + cross(w, axis) + cross(w, cross(w, axis)) / (1.0 + c);
    return normalize(a - dot(a, to) * to);
}

// The axis turned in the leaf's plane towards `along` (or its opposite): strokes that go round.
vec3 swirled_axis(vec3 axis, vec3 normal, vec3 along, float swirl) {
    vec3 a = along - dot(along, normal) * normal;
    float size = length(a);
    a = dot(a, axis) < 0.0 ? -a : a;
    vec3 turned = mix(axis, a / max(size, 1e-6), swirl * smoothstep(0.0, 0.2, size));
    return dot(turned, turned) > 1e-8 ? normalize(turned) : axis;
}

// Size of a leaf when a share of them is kept: it shrinks over a small part of the order before it
// is gone, so that nothing pops. All have their size where all are kept.
float presence(float rank, float kept) {
    return clamp((kept * (1.0 + INK_FADE) - rank) / INK_FADE, 0.0, 1.0);
}

// A corner of the square that the leaf's shape fits in, `local` in radii, as a style places, turns
// and sizes the leaf for an eye that looks along `forward`.
vec3 leaf_corner(InkLeaf leaf, InkCluster cluster, InkStyle style, float rank, vec3 outward,
                 vec3 forward, vec2 local) {
    vec3 place = displaced(leaf, cluster, outward, style.displacement);
    // Facing means parallel to the picture: depth is constant over the leaf, so that no threshold of
    // contours depends on the place in the picture.
    vec3 normal = turned_normal(leaf, outward, -forward, style.orientation, style.facing);
    vec3 axis = turned_axis(leaf.axis, leaf.normal, normal);
    axis = swirled_axis(axis, normal, cross(outward, forward), style.swirl);
    float radius = leaf.radius * style.size * presence(rank, style.kept);
    // Longer and narrower, with the area that it had.
    vec2 extent = radius * vec2(inversesqrt(style.elongation), sqrt(style.elongation));
    // Of the two sides that a leaf has the normal may be the other one's; it is not mirrored by that.
    vec3 side = dot(leaf.normal, normal) < 0.0 ? cross(normal, axis) : cross(axis, normal);
    return place + extent.x * local.x * side + extent.y * local.y * axis;
}

#endif
