#!/usr/bin/env bash
# Runs the lock-free parts, the flow graph's wiring and the public interface under ThreadSanitizer, with an instrumented oneTBB (built once
# per version, two minutes, see tests/tsan/build_onetbb.sh), and makes sure that planted races are found. Arguments go to the tests:
#   tests/run_tsan.sh --gtest_filter='SpscRing.*'
set -euo pipefail
cd "$(dirname "$0")/.."

apps/setup.sh
MOTORCADE_TSAN_TBB=$(tests/tsan/build_onetbb.sh)
export MOTORCADE_TSAN_TBB
cmake --preset tsan --log-level=WARNING
cmake --build --preset tsan

build=build/tsan/tests/tsan
linked=$(ldd $build/tsan_tests)  # whole, or ldd might end by its broken pipe
[[ $linked == *"$(dirname "$(dirname "$MOTORCADE_TSAN_TBB")")"/*libtbb* ]] || { echo "The tests do not use the instrumented oneTBB" >&2; exit 1; }
for race in threads ring stage; do
  if TSAN_OPTIONS="exitcode=66 halt_on_error=0" $build/tsan_canary $race >build/tsan/canary.log 2>&1; then status=0; else status=$?; fi
  if [[ $status -ne 66 ]] || ! grep -q "ThreadSanitizer: data race" build/tsan/canary.log; then
    echo "ThreadSanitizer does not find the race planted in '$race' (exit code $status): what it says about the tests is worth nothing" >&2
    tail -5 build/tsan/canary.log >&2
    exit 1
  fi
  echo "planted race '$race': found"
done
for tests in tsan_tests tracker_tsan_tests; do
  TSAN_OPTIONS="exitcode=66 halt_on_error=1 second_deadlock_stack=1" $build/$tests "$@"
done
