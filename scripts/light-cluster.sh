#!/usr/bin/env bash
# Draws a cluster of birch leaves under sun and sky, as figure 10 of Wang et al. 2005:
#   scripts/light-cluster.sh [OUTPUT.jpg]
# Needs a release build and python3, which lays the leaves out along a twig.
#   SIZE=900x675  PATHS=512  SUPERSAMPLE=3
set -euo pipefail
output=$(realpath -m "${1:-docs/pictures/light-cluster.jpg}")
cd "$(dirname "$0")/.."
umbrage=${UMBRAGE:-target/release/umbrage}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$umbrage" leaf edit birch --gloss 0.6 --size 1024x1024 -o "$work/birch.toml" >/dev/null
python3 - "$work/cluster.obj" <<'PYTHON'
import math, random, sys

out = open(sys.argv[1], "w")
with open(sys.argv[1].replace(".obj", ".mtl"), "w") as mtl:
    mtl.write("newmtl leaf\nKd 0.3 0.4 0.2\nnewmtl twig\nKd 0.42 0.33 0.26\n")
out.write("mtllib cluster.mtl\n")
random.seed(11)
count = 0

def add(a, b, s=1.0): return tuple(x + s * y for x, y in zip(a, b))
def cross(a, b): return (a[1]*b[2]-a[2]*b[1], a[2]*b[0]-a[0]*b[2], a[0]*b[1]-a[1]*b[0])
def unit(a):
    n = math.sqrt(sum(x * x for x in a))
    return tuple(x / n for x in a)

def grid(points, uv, columns):
    """A mesh of rows of points; normals are made from the faces."""
    global count
    for p, t in zip(points, uv):
        out.write("v %.6f %.6f %.6f\nvt %.5f %.5f\n" % (*p, *t))
    rows = len(points) // columns
    for r in range(rows - 1):
        for c in range(columns - 1):
            i = count + r * columns + c + 1
            quad = (i, i + 1, i + columns + 1, i + columns)
            out.write("f " + " ".join("%d/%d" % (k, k) for k in quad) + "\n")
    count += len(points)

def tube(path, radius, taper):
    sides = 7
    points = []
    for k, p in enumerate(path):
        ahead = unit(add(path[min(k + 1, len(path) - 1)], path[max(k - 1, 0)], -1.0))
        x = unit(cross(ahead, (0.1, 0.2, 1.0)))
        y = cross(ahead, x)
        r = radius * (1 - taper * k / (len(path) - 1))
        for j in range(sides + 1):
            turn = 2 * math.pi * j / sides
            points.append(add(add(p, x, r * math.cos(turn)), y, r * math.sin(turn)))
    out.write("usemtl twig\n")
    grid(points, [(0, 0)] * len(points), sides + 1)

def blade(base, ahead, up, length, bend, fold, twist):
    """Blade from its base: an arc that droops, folded along the midrib, with a wavy margin."""
    across, along = 13, 19
    right = unit(cross(ahead, up))
    up = cross(right, ahead)
    phase = random.uniform(0, 6)
    points, uv = [], []
    y = z = 0.0
    for r in range(along):
        t = r / (along - 1)
        if r:
            slope = -bend * (t - 0.5 / along) ** 1.3
            y += math.cos(slope) / (along - 1)
            z += math.sin(slope) / (along - 1)
        turn = twist * t
        for c in range(across):
            s = 0.72 * (c / (across - 1) - 0.5)
            lift = abs(s) * math.sin(fold) + 0.035 * abs(s) / 0.3 * math.sin(17 * t + phase + (2 if s > 0 else 0))
            x = s * math.cos(fold)
            x, h = x * math.cos(turn) - lift * math.sin(turn), x * math.sin(turn) + lift * math.cos(turn)
            p = add(add(add(base, right, length * x), ahead, length * y), up, length * (z + h))
            points.append(p)
            uv.append((0.5 + s, t))
    out.write("usemtl leaf\n")
    grid(points, uv, across)

def twig(start, ahead, length, leaves, size):
    path, p, d = [], start, unit(ahead)
    for k in range(13):
        path.append(p)
        d = unit(add(d, (0.015 * math.sin(k), 0.035, 0.01 * math.cos(2.0 * k))))
        p = add(p, d, length / 12)
    tube(path, 0.0021, 0.6)
    for k in range(leaves):
        at = 0.08 + 0.92 * k / (leaves - 1)
        i = min(int(at * 12), 11)
        base = add(path[i], add(path[i + 1], path[i], -1.0), at * 12 - i)
        d = unit(add(path[i + 1], path[i], -1.0))
        # A golden angle from leaf to leaf, flattened towards the light.
        turn = 2.4 * k + random.uniform(-0.3, 0.3)
        side = unit(cross(d, (0, 0, 1)))
        over = cross(side, d)
        away = add(tuple(math.cos(turn) * v for v in side), over, 0.55 * math.sin(turn))
        ahead = unit(add(add(away, d, 0.75 + (0.9 if k == leaves - 1 else 0)), (0, 0.15, 0)))
        own = size * random.uniform(0.8, 1.1) * (0.75 if k > leaves - 3 else 1)
        stalk = [add(add(base, ahead, 0.33 * own * t), (0, -1, 0), 0.05 * own * t * t) for t in (0, 0.3, 0.6, 0.8, 1)]
        tube(stalk, 0.0008, 0.3)
        drop = unit(add(ahead, (0, -0.25, 0)))
        up = unit((random.uniform(-0.35, 0.35), 1, random.uniform(0.0, 0.7)))
        blade(stalk[-1], drop, up, own, random.uniform(0.5, 1.1), random.uniform(0.12, 0.4), random.uniform(-0.5, 0.5))

twig((-0.13, -0.05, 0.0), (1, 0.12, 0.05), 0.24, 12, 0.076)
twig((-0.03, -0.04, -0.01), (0.5, 0.75, -0.2), 0.15, 8, 0.07)
twig((-0.07, -0.045, 0.0), (0.5, 0.35, 0.85), 0.11, 6, 0.066)
twig((-0.06, -0.045, -0.01), (0.55, -0.35, -0.5), 0.13, 7, 0.074)
twig((-0.09, -0.045, -0.01), (-0.25, 0.8, -0.35), 0.12, 7, 0.072)
PYTHON
leaf=(--leaf "$work/birch.toml" --foliage leaf)
[ -n "${KEEP:-}" ] || "$umbrage" light "$work/cluster.obj" -o "$work/cluster.light" "${leaf[@]}" --paths "${PATHS:-512}" --directions none
"$umbrage" render "$work/cluster.obj" -o "$output" "${leaf[@]}" --light "$work/cluster.light" --lighting leaf \
    --size "${SIZE:-900x675}" --supersample "${SUPERSAMPLE:-3}" --splits 2 --camera "${CAMERA:-0.135,0.112,0.45/-0.005,0.01,0.0}" --fov 28 \
    --environment "${SKY:-linear:0.22,0.26,0.32/0.10,0.14,0.20}" --sun-direction="${SUN:--0.5,0.8,-0.15}" \
    --sun-irradiance "${IRRADIANCE:-3.6,3.4,3.0}" "${@:2}"
