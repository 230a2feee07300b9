#ifndef INK_BODY_GLSL
#define INK_BODY_GLSL

// Hatch coordinates of smooth bodies, tiles (Coconu, Deussen, Hege 2006, equations 9 and 10): the
// direction from the cluster's centre, as an angle from the front point R, times the distance in
// radii. The angle is kept along its own direction (as on a map that is true from its middle):
// with the two angles of equation 3 strokes would fold where the direction is near up. A surface also
// has places behind the middle, where that angle passes a right one and would go round in a leap:
// they are hatched as the picture shows them, by what a right angle makes of their distance.
vec2 body_hatch(InkCluster cluster, vec3 place, vec3 eye, vec3 right, vec3 up) {
    vec3 away = place - cluster.centre;
    float reach = length(away);
    vec3 front = normalize(eye - cluster.centre);
    // Seen from along `right` the picture's up says what is across.
    vec3 across = right - dot(right, front) * front;
    vec3 x = dot(across, across) > 1e-6 ? normalize(across) : normalize(cross(up, front));
    vec3 y = cross(front, x);
    vec2 flat_part = vec2(dot(away, x), dot(away, y));
    float size = length(flat_part);
    if (size <= 1e-9 * cluster.radius) {
        return cluster.reference;
    }
    float before = dot(away, front);
    float scale = before > 0.0 ? atan(size, before) * reach / size : 0.5 * 3.14159265;
    vec2 offset = flat_part * (scale / cluster.radius);
    vec2 v = cluster.texture_up;
    vec2 turned = vec2(v.y * offset.x - v.x * offset.y, v.x * offset.x + v.y * offset.y);
    return cluster.reference + cluster.tiles * (1.0 / 3.14159265) * turned;
}

#endif
