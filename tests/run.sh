#!/usr/bin/env bash
# Sets up, builds and runs every test. Arguments go to ctest: tests/run.sh -R pipeline
#   tests/run.sh --asan ...   under AddressSanitizer and UndefinedBehaviorSanitizer
#   tests/run.sh --asan-quick ...   the same for the tests of core and io alone, without what else takes long to build
#   tests/run.sh --tsan ...   the lock-free parts and the flow graph's wiring under ThreadSanitizer (arguments go to the tests)
# A test that has not ended after ten minutes has failed. A whole run ends with the pages in a browser (tests/browser.sh).
# Tests on real drives read the folder MOTORCADE_DATA (default: ../shared/data) and are skipped where a drive is not there.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=release quick=
case ${1:-} in
  --tsan) shift && exec tests/run_tsan.sh "$@" ;;
  --asan) shift && preset=asan ;;
  --asan-quick) shift && preset=asan quick=yes ;;
esac
apps/setup.sh
options=()
if [[ $preset == release ]]; then
  apps/setup.sh pybind11-dev python3-dev python3-numpy python3-matplotlib qemu-user valgrind
  options=(-DMOTORCADE_BUILD_PYTHON=ON)
fi
if [[ $quick ]]; then  # in a folder of its own: precompiled headers would have io wait for the back-end
  cmake --preset $preset -B build/asan_quick -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DMOTORCADE_BUILD_APPS=OFF --log-level=WARNING
  cmake --build build/asan_quick --target core_tests io_tests
  exec ctest --test-dir build/asan_quick --output-on-failure --timeout 600 -R '^(core|io)\.' "$@"
fi
cmake --preset $preset "${options[@]}" --log-level=WARNING
cmake --build --preset $preset
ctest --preset $preset "$@"
if [[ $preset == release && $# -eq 0 ]]; then
  tests/mcap.sh
  tests/browser.sh
fi
