#!/usr/bin/env bash
# Error, time and size of every way to light the fifty leaves of ../shared/leaf/truth, against
# 1024-sample path tracing: the table of docs/light.md. Needs a release build and python3.
#   PATHS=1024   paths of a side for all rows that do not say another number
#   REPEAT=9     frames of 800x600 whose median is told
set -euo pipefail
cd "$(dirname "$0")/.."
umbrage=${UMBRAGE:-target/release/umbrage}
paths_whole=${PATHS:-1024}
repeat=${REPEAT:-9}
truth=../shared/leaf/truth
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
leaf=(--up z --reflectance 0.1207,0.1581,0.0469 --reflectance-below 0.1689,0.2031,0.0828
    --transmittance 0.1723,0.2025,0.0402)
sun=(--sun-direction 0.439385041770705,0.819152044288992,-0.368687826494612)
view=(--fov 42 --camera 0.42,0.22,0.34/0,0,0)

light() {
    "$umbrage" light $truth/leaf50.obj -o "$work/$1.light" "${leaf[@]}" "${sun[@]}" "${@:2}" >"$work/$1.txt"
}

# draw OUT ARGUMENTS..: a picture of leaf50, its report as JSON in OUT
draw() {
    "$umbrage" render $truth/leaf50.obj -o "$work/out.png" "${leaf[@]}" "${sun[@]}" "${view[@]}" --json "${@:2}" >"$1"
}

# row NAME LIGHT LIGHTING ARGUMENTS..: error at the size of the truth, time at 800x600, bytes
row() {
    local name=$1 how=(--light "$work/$2.light" --lighting "$3" "${@:4}")
    draw "$work/error.json" "${how[@]}" --reference $truth/leaf50 --size 256x256
    draw "$work/time.json" "${how[@]}" --size 800x600 --supersample 1 --repeat "$repeat"
    python3 - "$name" "$work/error.json" "$work/time.json" <<'PYTHON'
import json, sys
name, error, time = sys.argv[1], *(json.load(open(f)) for f in sys.argv[2:])
e = error["errors"][0]
ms = lambda rows: sum(r["median_ms"] for r in rows)
frame = [r for r in time["times"] if r["on"] != "cpu"]
# What a change of the sun takes before the next frame.
change = ("unpack transfer", "project sky", "relight", "spread", "decode map", "sun map", "shadow map")
sun = [r for r in time["times"] if r["on"] == "cpu" and r["stage"] in change]
b = time["bytes"]
kib = lambda n: f"{n / 1024:,.0f}"
print(f"| {name} | {100 * e['bias']:.1f} | {100 * e['rmse']:.1f} | {100 * e['block_rmse']:.1f} "
      f"| {ms(frame):.1f} | {ms(sun):.1f} | {kib(b['transfer'])} | {kib(b['maps'])} |")
PYTHON
}

echo '| lighting | bias % | RMSE % | blocks % | frame ms | new sun ms | vectors KiB | maps KiB |'
echo '|---|--:|--:|--:|--:|--:|--:|--:|'
light whole --paths "$paths_whole" --directions sun
row 'hard shadows, constant for the rest' whole ambient
row 'shadow map, constant for the rest' whole shadow
row 'shadow map and transfer' whole shadow-prt
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
# This sun stands on no day's way: its own map stands for the maps of a day.
row "stored map of the sun's own place" whole leaf --stored
light cube --paths "$paths_whole" --directions cube --splits 0
row 'nearest of 6144 maps, no splits' cube leaf --stored
row 'blend of 6144 maps, no splits' cube leaf --stored --blended
cat "$work/cube.txt"
