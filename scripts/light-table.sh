#!/usr/bin/env bash
# Error and size of every way to light the fifty leaves of ../shared/leaf/truth, against 1024-sample
# path tracing: the table of docs/light.md. Needs a release build.
set -euo pipefail
cd "$(dirname "$0")/.."
umbrage=${UMBRAGE:-target/release/umbrage}
paths_whole=${PATHS:-1024}
truth=../shared/leaf/truth
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
leaf=(--up z --reflectance 0.1207,0.1581,0.0469 --reflectance-below 0.1689,0.2031,0.0828
    --transmittance 0.1723,0.2025,0.0402)
sun=(--sun-direction 0.439385041770705,0.819152044288992,-0.368687826494612)

light() { "$umbrage" light $truth/leaf50.obj -o "$work/$1.light" "${leaf[@]}" "${sun[@]}" "${@:2}" >"$work/$1.txt"; }
row() {
    local name=$1 file=$2 lighting=$3
    "$umbrage" render $truth/leaf50.obj -o "$work/out.png" "${leaf[@]}" "${sun[@]}" --light "$work/$file.light" \
        --lighting "$lighting" --reference $truth/leaf50 --size 256x256 --fov 42 \
        --camera 0.42,0.22,0.34/0,0,0 "${@:4}" --timings >"$work/out.txt"
    # lighting to leaf50_full  bias  RMSE  blocks  p99
    awk -v name="$name" '/ to leaf50/ { print "| " name " | " $4 " | " $5 " | " $6 " |" }' "$work/out.txt"
}

echo '| lighting | bias % | RMSE % | blocks % |'
echo '|---|--:|--:|--:|'
light whole --paths "$paths_whole" --directions sun
row 'hard shadows, constant for the rest' whole ambient
row 'transfer alone, order 5' whole prt
for order in 1 2 3 4 5; do
    row "transfer of order $order and visibility" whole leaf --order "$order"
done
for splits in 0 1 2 3; do
    row "triangles split $splits times for visibility" whole leaf --splits "$splits"
done
for paths in 16 64 256; do
    light paths --paths $paths --directions none
    row "$paths paths a side" paths leaf
done
for storage in f32 8bit; do
    light storage --paths "$paths_whole" --directions none --storage $storage
    row "vectors as $storage" storage leaf
done
for lod in 0.02 0.05 0.1; do
    light lod --paths "$paths_whole" --directions none --lod $lod
    row "vectors $lod diagonals apart" lod leaf
done
light cube --paths "$paths_whole" --directions cube --splits 0
row 'nearest of 6144 maps, no splits' cube leaf --stored
row 'blend of 6144 maps, no splits' cube leaf --stored --blended
cat "$work/cube.txt"
