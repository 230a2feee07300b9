#!/usr/bin/env bash
# Runs every test under the Vulkan validation layer: scripts/test.sh [arguments of the runner]
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh --tests
if cargo nextest --version >/dev/null 2>&1; then
    cargo nextest run --all-targets "$@"
else
    # Device tests take every core by themselves: one at a time, as nextest's configuration has it.
    RUST_TEST_THREADS=1 cargo test --lib --bins --tests "$@"
fi
