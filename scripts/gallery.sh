#!/usr/bin/env bash
# Draws the gallery of docs/gallery.md: the figures of Coconu, Deussen, Hege 2006 and of Deussen,
# Strothotte 2000 with trees that nobody here made.
#   scripts/gallery.sh [FOLDER_OF_MODELS]
# Needs a release build.
set -euo pipefail
cd "$(dirname "$0")/.."
models=$(realpath "${1:-../shared/models}")/eztree
umbrage=${UMBRAGE:-target/release/umbrage}
out=docs/pictures
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
presets=src/ink/presets

# variant NAME PRESET KEY=VALUE..: a preset with other numbers, in $work/NAME.toml
variant() {
    cp "$presets/$2.toml" "$work/$1.toml"
    for change in "${@:3}"; do
        local key=${change%%=*} value=${change#*=} section=${change%%.*}
        key=${key#*.}
        sed -i "/^\[$section\]/,/^\[/{/^$key = /d}" "$work/$1.toml"
        if grep -q "^\[$section\]" "$work/$1.toml"; then
            sed -i "/^\[$section\]/a $key = $value" "$work/$1.toml"
        else
            printf '\n[%s]\n%s = %s\n' "$section" "$key" "$value" >>"$work/$1.toml"
        fi
    done
}

# figure 3, left: from the photo-like picture to a drawing
"$umbrage" render "$models/oak_medium.glb" --style photo --toward silhouette-hatching \
    --share 0,0.33,0.67,1 --size 300x340 -o "$out/ink-way.png"
# figure 3, right: styles
for style in van-gogh pointillist; do
    "$umbrage" render "$models/ash_large.glb" --style $style --size 400x460 -o "$out/ink-$style.png"
done
"$umbrage" render "$models/oak_medium.glb" --style minimal --size 400x460 --margin 0.16 -o "$out/ink-minimal.png"
"$umbrage" render "$models/oak_medium.glb" --style mixed --size 560x560 -o "$out/ink-mixed.png"
"$umbrage" render "$models/oak_medium.glb" --style silhouette-hatching --size 560x560 -o "$out/ink-hatching.png"
# figure 4: leaves moved towards their clusters' spheres by 0, 0.5, 1
variant beta0 silhouette-hatching leaves.displacement=0.0
variant beta1 silhouette-hatching leaves.displacement=1.0
"$umbrage" render "$models/oak_medium.glb" --style "$work/beta0.toml" --toward "$work/beta1.toml" \
    --share 0,0.5,1 --size 360x400 -o "$out/gallery-beta.png"
# figure 6: thresholds of alpha from the leaf to the disc
variant leaf outline leaves.shape=0.7 leaves.facing=0.8 leaves.size=1.3 leaves.kept=0.3
variant disc outline leaves.shape=0.25 leaves.facing=0.8 leaves.size=1.3 leaves.kept=0.3
"$umbrage" render "$models/oak_medium.glb" --style "$work/leaf.toml" --toward "$work/disc.toml" \
    --share 0,0.33,0.67,1 --camera 10,5,0.6 --size 300x340 -o "$out/gallery-alpha.png"
# figures 7 and 9: strokes even, packed towards the limb, and in three steps
variant even silhouette-hatching hatching.packing=0.0 leaves.displacement=1.0
variant packed silhouette-hatching hatching.packing=0.5708 leaves.displacement=1.0
variant steps silhouette-hatching hatching.packing=0.5708 hatching.packing_steps=3 leaves.displacement=1.0
for name in even packed steps; do
    "$umbrage" render "$models/oak_medium.glb" --style "$work/$name.toml" --camera 0,5,0.5 --size 360x360 \
        -o "$out/gallery-$name.png"
done
# figure 11: smooth bodies
"$umbrage" render grow:rabbit --style smooth --camera 35,12 --size 480x480 -o "$out/ink-rabbit.png"
# Luft, Balzer, Deussen 2007, figure 7: an edge filter on original and on realigned normals
"$umbrage" render "$models/oak_medium.glb" --style normal-edges-original --toward normal-edges \
    --share 0,1 --size 310x360 -o "$out/ink-edges.png"
# Deussen, Strothotte 2000: pixels at once, and vectors
for style in ds00-fig2 ds00-fig3a ds00-fig3b ds00-fig4a ds00-fig4b ds00-fig4c ds00-fig5 ds00-fig6a ds00-fig6b ds00-fig6c ds00-fig6d \
    ds00-fig6e ds00-fig6f lenient-sketch plotter-a4; do
    model=oak_medium
    if [ $style = ds00-fig6f ]; then model=oak_medium_dense; fi
    "$umbrage" render "$models/$model.glb" --style "$style" -o "$work/$style.png"
    "$umbrage" render "$models/$model.glb" --style "$style" -o "$work/$style.svg"
done
# figure 5: a tree at three distances, in metres; sizes as they are (a), and enlarged up to twice (b)
for size in 0.0 1.0; do
    sed -e "s/^constant_size = .*/constant_size = $size/" -e 's/^far = .*/fitted = false\nnear = 95.0\nfar = 1045.0/' \
        src/ink/paper/presets/ds00-fig5.toml >"$work/distance.toml"
    for distance in 1 1.7 2.9; do
        "$umbrage" render "$models/oak_medium.glb" --style "$work/distance.toml" --camera "25,7,$distance" \
            --paper 115x115 -o "$work/distance-$size-$distance.png"
        "$umbrage" render "$models/oak_medium.glb" --style "$work/distance.toml" --camera "25,7,$distance" \
            --paper 115x115 -o "$work/distance-$size-$distance.svg"
    done
done
# Side by side: whatever rasterises SVG and lays pictures out, here resvg and Pillow.
if ${PYTHON:-python3} -c 'import PIL, resvg_py' 2>/dev/null; then
    ${PYTHON:-python3} scripts/gallery-sheet.py "$work" "$out"
else
    echo "no resvg-py and Pillow: the sheets of drawings on paper stay as they are" >&2
fi
