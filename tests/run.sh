#!/usr/bin/env bash
# Sets up, builds and runs every test. Arguments go to ctest: tests/run.sh -R pipeline
set -euo pipefail
cd "$(dirname "$0")/.."

apps/setup.sh
cmake --preset release --log-level=WARNING
cmake --build --preset release
ctest --preset release "$@"
