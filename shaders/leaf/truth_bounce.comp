#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "random.glsl"
#include "leaf_brdf.glsl"
#include "lamp.glsl"
#include "leaf_sky.glsl"

// What becomes of the paths of light: those that meet nothing see the sky; the others ask for
// the sun or a lamp (a second ray each) and go on.

layout(local_size_x = GROUP_1D) in;
layout(constant_id = 7) const uint DIRECTIONAL = 0;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { TruthFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Hits { uvec2 hits[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Faces { vec4 faces[]; };
layout(set = 0, binding = 3, scalar) restrict readonly buffer Materials { LeafSides materials[]; };
layout(set = 0, binding = 4, scalar) restrict readonly buffer Gloss { vec4 gloss[]; };
layout(set = 0, binding = 5, scalar) restrict readonly buffer Positions { vec3 positions[]; };
layout(set = 0, binding = 6, scalar) restrict readonly buffer Normals { vec3 normals[]; };
layout(set = 0, binding = 7, scalar) restrict readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 8) uniform sampler2D sky;
layout(set = 0, binding = 9, rgba32f) uniform restrict image2D rays;
layout(set = 0, binding = 10, rgba32f) uniform restrict writeonly image2D sun_rays;
layout(set = 0, binding = 11, scalar) restrict buffer Paths { TruthPath paths[]; };
// How many go on: tells the host whether another bounce is needed, nothing else.
layout(set = 0, binding = 12, scalar) restrict buffer Alive { uint alive_count; };
layout(set = 0, binding = 13, scalar) restrict readonly buffer Lamps { LampRecord lamps[]; };
// Of the sun's shape, in units of its radius; then of the lamps.
layout(set = 0, binding = 14, scalar) restrict readonly buffer Points { vec3 points[]; };
layout(set = 0, binding = 15, scalar) restrict readonly buffer Turns { LeafTurn turns[]; };
layout(push_constant, scalar) uniform Push { TruthBatch push; };

#include "leaf_directional.glsl"

// Normal of the front at a point of a triangle.
vec3 shading_normal(uint triangle, vec3 at, vec3 face) {
    uvec3 corner = uvec3(indices[3u * triangle], indices[3u * triangle + 1u], indices[3u * triangle + 2u]);
    vec3 a = positions[corner.x] - at;
    vec3 b = positions[corner.y] - at;
    vec3 c = positions[corner.z] - at;
    vec3 weights = corner_weights(a, b, c, face);
    vec3 n = weights.x * normals[corner.x] + weights.y * normals[corner.y] + weights.z * normals[corner.z];
    float size = dot(n, n);
    n = size > 0.0 ? n * inversesqrt(size) : face;
    return dot(n, face) < 0.0 ? -n : n;
}

// A sample of the sun or of a lamp.
struct LightSample {
    // To it; the ray ends at this many lengths.
    vec3 to;
    float reach;
    // Irradiance of all lights that the sample stands for.
    vec3 irradiance;
};

LightSample sample_sun(uint key, uint counter) {
    float radius = frame.sin_radius * sqrt(random(key, counter));
    float turn = 2.0 * LEAF_PI * random(key, counter + 1u);
    vec2 place = vec2(radius * cos(turn), radius * sin(turn));
    if (frame.sun_points > 0u) {
        uint i = uint(random(key, counter) * float(frame.sun_points));
        place = frame.sin_radius * points[min(i, frame.sun_points - 1u)].xy;
    }
    vec3 to_sun = normalize(to_frame(frame.sun, vec3(place, 1.0)));
    return LightSample(to_sun, RAY_FAR, frame.irradiance);
}

LightSample sample_light(uint key, uint counter, vec3 at) {
    uint lights = frame.suns + frame.lamps;
    uint chosen = uint(random(key, counter + 6u) * float(lights));
    if (chosen < frame.suns) {
        LightSample light = sample_sun(key, counter);
        light.irradiance *= float(lights);
        return light;
    }
    if (lights == 0u) {
        return LightSample(vec3(0.0, 1.0, 0.0), -1.0, vec3(0.0));
    }
    LampRecord lamp = lamps[min(chosen, lights - 1u) - frame.suns];
    uint i = uint(random(key, counter + 7u) * float(lamp.points));
    vec3 to = points[lamp.first_point + min(i, lamp.points - 1u)] - at;
    float falloff = lamp_falloff(to, lamp.normal, lamp.least);
    float reach = falloff > 0.0 ? LAMP_REACH : -1.0;
    return LightSample(to, reach, lamp.intensity * (float(lamp.points * lights) * falloff));
}

float mean_of(vec3 v) {
    return (v.x + v.y + v.z) / 3.0;
}

void main() {
    uint path = flat_invocation();
    if (path >= push.pixels * push.samples) {
        return;
    }
    ivec2 texel = ivec2((2u * path) & ((1u << RAY_COLUMN_BITS) - 1u), (2u * path) >> RAY_COLUMN_BITS);
    imageStore(sun_rays, texel, vec4(0.0, 0.0, 0.0, -1.0));
    TruthPath state = paths[path];
    if (state.alive != PATH_ALIVE) {
        return;
    }
    vec3 origin = imageLoad(rays, texel).xyz;
    vec3 direction = imageLoad(rays, texel + ivec2(1, 0)).xyz;
    uvec2 hit = hits[path];
    if (hit.y == RAY_NOTHING || push.last != 0u) {
        // The camera does not see the sky itself: it draws a background of its own.
        paths[path].sky += push.bounce > 0u && hit.y == RAY_NOTHING ? state.weight * sky_radiance(sky, direction) : vec3(0.0);
        paths[path].alive = PATH_ENDED;
        paths[path].pending = vec3(0.0);
        imageStore(rays, texel, vec4(origin, -1.0));
        return;
    }
    uint pixel = push.first_pixel + path % push.pixels;
    uint key = path_key(pixel, push.first_sample + path / push.pixels, frame.seed + 1u);
    uint counter = 8u * push.bounce;
    vec4 face = faces[hit.y];
    vec3 at = origin + uintBitsToFloat(hit.x) * direction;
    vec3 normal = shading_normal(hit.y, at, face.xyz);
    uint material = floatBitsToUint(face.w);
    LeafSides leaf = materials[material];
    vec4 shine = gloss[floatBitsToUint(face.w)];
    vec3 to_eye = -direction;
    bool front = dot(normal, to_eye) > 0.0;
    // The sun, or a lamp.
    LightSample light = sample_light(key, counter, at);
    float light_side = dot(face.xyz, light.to) < 0.0 ? -frame.offset : frame.offset;
    vec3 start = light_side * face.xyz;
    vec3 to_light = light.reach < 1.0 ? light.to - start : light.to;
    imageStore(sun_rays, texel, vec4(at + start, light.reach));
    imageStore(sun_rays, texel + ivec2(1, 0), vec4(to_light, 0.0));
    vec3 towards = normalize(light.to);
    LeafSides lit = leaf_for_light(leaf, material, dot(normal, towards));
    paths[path].pending = state.weight * light.irradiance * leaf_scatters(lit, shine, normal, towards, to_eye);
    if (push.bounce == 0u) {
        paths[path].covered = 1.0;
    }
    // The next direction: one of three lobes.
    vec3 lobes = vec3(mean_of(front ? leaf.rho_d_front : leaf.rho_d_back), mean_of(leaf.rho_t), mean_of(shine.xyz));
    float total = lobes.x + lobes.y + lobes.z;
    float survives = push.bounce > 1u ? min(1.6 * total, 1.0) : 1.0;
    vec3 outward = front ? normal : -normal;
    float choice = random(key, counter + 2u) * total;
    vec2 u = vec2(random(key, counter + 3u), random(key, counter + 4u));
    vec3 next = cosine_direction(choice < lobes.x ? outward : -outward, u);
    if (choice >= lobes.x + lobes.y) {
        float tan2 = -shine.w * shine.w * log(max(1.0 - u.x, 1e-12));
        float z = inversesqrt(1.0 + tan2);
        float r = sqrt(max(1.0 - z * z, 0.0));
        vec3 middle = to_frame(outward, vec3(r * cos(2.0 * LEAF_PI * u.y), r * sin(2.0 * LEAF_PI * u.y), z));
        next = reflect(direction, middle);
    }
    // Density of the mixture. The glossy lobe also finds directions on the other side, and they count.
    float along = dot(outward, next);
    float density = (along > 0.0 ? lobes.x : lobes.y) * abs(along) / LEAF_PI;
    if (lobes.z > 0.0) {
        vec3 middle = normalize(next + to_eye);
        float cos_h = abs(dot(outward, middle));
        density += lobes.z * slope_distribution(cos_h, shine.w) * cos_h / (4.0 * max(abs(dot(middle, next)), 1e-6));
    }
    bool ends = !(total > 0.0) || !(density > 0.0) || random(key, counter + 5u) >= survives;
    vec3 value = leaf_scatters(leaf_for_light(leaf, material, dot(normal, next)), shine, normal, next, to_eye);
    paths[path].weight = ends ? vec3(0.0) : state.weight * value * (total / (density * survives));
    paths[path].alive = ends ? PATH_ENDED : PATH_ALIVE;
    float side = dot(face.xyz, next) < 0.0 ? -frame.offset : frame.offset;
    imageStore(rays, texel, vec4(at + side * face.xyz, ends ? -1.0 : RAY_FAR));
    imageStore(rays, texel + ivec2(1, 0), vec4(next, 0.0));
    atomicAdd(alive_count, 1u);
}
