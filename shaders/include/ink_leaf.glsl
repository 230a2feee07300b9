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
    return facing > 0.0 && dot(t, t) > 1e-12 ? normalize(t) : n;
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

#endif
