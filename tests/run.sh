#!/usr/bin/env bash
# Sets up, builds and runs every test. Arguments go to ctest: tests/run.sh -R pipeline
#   tests/run.sh --asan ...   under AddressSanitizer and UndefinedBehaviorSanitizer
#   tests/run.sh --tsan ...   the lock-free parts and the flow graph's wiring under ThreadSanitizer (arguments go to the tests)
# Tests on real drives read the folder MOTORCADE_DATA (default: ../shared/data) and are skipped where a drive is not there.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=release
case ${1:-} in
  --tsan) shift && exec tests/run_tsan.sh "$@" ;;
  --asan) shift && preset=asan ;;
esac
apps/setup.sh
cmake --preset $preset --log-level=WARNING
cmake --build --preset $preset
ctest --preset $preset "$@"
