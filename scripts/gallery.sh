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
# Deussen, Strothotte 2000: pixels at once, ten a millimetre (the sheet reduces them), and vectors. Grown trees have as many leaves as the paper's.
# drawing NAME MODEL [OPTION..]: $work/NAME.png and $work/NAME.svg
drawing() {
    echo "$1: $2 ${*:3}"
    "$umbrage" render "$2" "${@:3}" --size "${size:-1860x2730}" --ink-supersample 1 -o "$work/$1.png"
    "$umbrage" render "$2" "${@:3}" -o "$work/$1.svg"
}
for figure in 2:broadleaf:1:8800 3a:broadleaf:1:8800 3b:broadleaf:1:8800 4a:lime:1:6000 4b:lime:1:6000 4c:lime:1:6000 \
    6a:conifer:1:13200 6b:conifer:1:13200 6c:broadleaf:1:16200 6d:broadleaf:1:2300 6e:broadleaf:1:5000 6f:broadleaf:1:90000; do
    name=ds00-fig${figure%%:*}
    drawing "$name" "grow:${figure#*:}" --style "$name"
done
# figure 5: a tree at three distances; discs as they are (a), and enlarged up to twice (b)
for style in ds00-fig5 ds00-fig5b; do
    for distance in 1 1.7 2.9; do
        size=2000x2000 drawing "$style-$distance" grow:broadleaf:1:8800 --style $style --camera "25,7,$distance" --paper 124x124
    done
done
# styles on models that nobody here made
for style in ds00-fig4b ds00-fig4c ds00-fig6a lenient-sketch ds00-fig6f plotter-a4; do
    model=oak_medium
    if [ $style = ds00-fig6f ]; then model=oak_medium_dense; fi
    "$umbrage" render "$models/$model.glb" --style $style -o "$work/oak-$style.svg"
done
# Side by side: whatever rasterises SVG and lays pictures out, here resvg and Pillow.
if ${PYTHON:-python3} -c 'import PIL, resvg_py' 2>/dev/null; then
    ${PYTHON:-python3} scripts/gallery-sheet.py "$work" "$out"
else
    echo "no resvg-py and Pillow: the sheets of drawings on paper stay as they are" >&2
fi
