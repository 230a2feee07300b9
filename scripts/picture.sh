#!/usr/bin/env bash
# Draws a picture of a plant that the program grows itself: scripts/picture.sh [OUTPUT.png]
set -euo pipefail
output=$(realpath -m "${1:-picture.png}")
cd "$(dirname "$0")/.."
scripts/setup.sh
cargo run --release -- render --output "$output"
echo "$output"
