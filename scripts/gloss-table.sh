#!/usr/bin/env bash
# Error of every way to reflect the sky in the fifty glossy leaves of ../shared/leaf/truth, and of
# matrices for the same leaves without gloss, against 1024-sample path tracing: tables of
# docs/light.md. Needs a release build and python3.
#   PATHS=256    paths of a side; matrices take twice as many of a vertex
set -euo pipefail
cd "$(dirname "$0")/.."
umbrage=${UMBRAGE:-target/release/umbrage}
paths=${PATHS:-256}
truth=../shared/leaf/truth
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
dull=(--up z --reflectance 0.1207,0.1581,0.0469 --reflectance-below 0.1689,0.2031,0.0828
    --transmittance 0.1723,0.2025,0.0402)
glossy=("${dull[@]}" --gloss 0.04 --roughness 0.3)
sun=(--sun-direction 0.439385041770705,0.819152044288992,-0.368687826494612)
view=(--fov 42 --camera 0.42,0.22,0.34/0,0,0 --size 256x256 --lighting leaf --json)

# light NAME ARGUMENTS..
light() {
    "$umbrage" light $truth/leaf50.obj -o "$work/$1.light" --paths "$paths" --directions none "${leaf[@]}" \
        "${@:2}" >"$work/$1.txt"
}

# row NAME LIGHT ARGUMENTS..: errors under the sky alone, and under sky and sun
row() {
    local how=("${leaf[@]}" "${sun[@]}" "${view[@]}" --light "$work/$2.light" "${@:3}")
    "$umbrage" render $truth/leaf50.obj -o "$work/out.png" "${how[@]}" --sun-irradiance 0 \
        --reference "$truth/${scene}_sky" >"$work/sky.json"
    "$umbrage" render $truth/leaf50.obj -o "$work/out.png" "${how[@]}" \
        --reference "$truth/$scene" >"$work/full.json"
    python3 - "$1" "$work/sky.json" "$work/full.json" <<'PYTHON'
import json, sys
cells = [sys.argv[1]]
for file in sys.argv[2:]:
    e = json.load(open(file))["errors"][0]
    cells += [f"{100 * e['bias']:.1f}", f"{100 * e['block_rmse']:.1f}"]
print("| " + " | ".join(cells) + " |")
PYTHON
}

head() {
    echo "| $1 | sky: bias % | blocks % | sky and sun: bias % | blocks % |"
    echo '|---|--:|--:|--:|--:|'
}

head 'glossy leaves'
leaf=("${glossy[@]}") scene=leaf50_gloss
light vectors
row 'gloss of the sky counts as diffuse' vectors --gloss-rays 0
for rays in 1 4 16; do
    row "--gloss-rays $rays" vectors --gloss-rays $rays
done
light both --transfer both
for gloss in none diffuse lobe; do
    row "both, --sky-gloss $gloss" both --sky-gloss $gloss --gloss-rays 0
done
row "both, the lobe with masking and shadowing" both --gloss-form safe
row 'matrices alone' both --transfer matrix
light rgb --transfer both --matrix-colours rgb --order 6
for order in 1 2 3 4 5 6; do
    row "both in RGB, order $order" rgb --order $order
done
row 'matrices alone in RGB, order 6' rgb --transfer matrix
echo
head 'leaves without gloss'
leaf=("${dull[@]}") scene=leaf50
light dull --transfer both --order 6
row 'vectors, order 6' dull --transfer vector
row 'matrices, order 6' dull --transfer matrix
row 'matrices, order 5' dull --transfer matrix --order 5
light dull --transfer matrix --matrix-colours rgb --order 6
row 'matrices in RGB, order 6' dull
row 'matrices in RGB, order 5' dull --order 5
