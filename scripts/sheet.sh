#!/usr/bin/env bash
# Draws the sheet of the README from three trees that nobody here made:
#   scripts/sheet.sh FOLDER_OF_MODELS [OUTPUT.jpg]
set -euo pipefail
models=$(realpath "${1:-$(dirname "$0")/../../shared/models}")
output=$(realpath -m "${2:-docs/pictures/standard-textured.jpg}")
cd "$(dirname "$0")/.."
scripts/setup.sh
mkdir -p "$(dirname "$output")"
cargo run --release --quiet -- render \
    "$models/eztree/oak_medium.glb" "$models/eztree/ash_large.glb" "$models/eztree/pine_medium.glb" \
    --compare standard,textured --size 480x480 --output "$output"
