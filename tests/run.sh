#!/usr/bin/env bash
# Sets up, builds and runs every test. Arguments go to ctest: tests/run.sh -R pipeline
#   tests/run.sh --asan ...   under AddressSanitizer and UndefinedBehaviorSanitizer
#   tests/run.sh --asan-quick ...   the same for the tests of core and io alone, without what else takes long to build
#   tests/run.sh --tsan ...   the lock-free parts and the flow graph's wiring under ThreadSanitizer (arguments go to the tests)
#   tests/run.sh --without-data   the tests that read real drives, where there is none
# A test that has not ended after ten minutes has failed. A whole run ends with the pages in a browser (tests/browser.sh), and with a line
# that says which tests were skipped and why.
# Tests on real drives read the folder MOTORCADE_DATA (default: ../shared/data) and are skipped where a drive is not there.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=release quick='' without_data=''
case ${1:-} in
  --tsan) shift && exec tests/run_tsan.sh "$@" ;;
  --asan) shift && preset=asan ;;
  --asan-quick) shift && preset=asan quick=yes ;;
  --without-data) shift && without_data=yes ;;
esac
apps/setup.sh
options=()
if [[ $preset == release ]]; then
  apps/setup.sh pybind11-dev python3-dev python3-numpy python3-matplotlib qemu-user valgrind
  options=(-DMOTORCADE_BUILD_PYTHON=ON)
fi
if [[ $quick ]]; then  # in a folder of its own, without the programs
  cmake --preset $preset -B build/asan_quick -DMOTORCADE_BUILD_APPS=OFF --log-level=WARNING
  cmake --build build/asan_quick --target core_tests io_tests
  exec ctest --test-dir build/asan_quick --output-on-failure --timeout 600 -R '^(core|io)\.' "$@"
fi
echo "== Building every test (next: running them)"
cmake --preset $preset "${options[@]}" --log-level=WARNING
apps/build.sh $preset

# The names of the tests whose sources read real drives, as a regular expression.
data_readers() {
  {
    grep -rl --include='*_test.cpp' 'dataFolder()' tests | xargs sed -nE 's/^TEST(_F|_P)?\((\w+),.*/[.]\2[.]/p'
    echo 'interface\.Modules'
  } | sort -u | paste -sd '|'
}
whole=
[[ $# -gt 0 || $without_data || $preset != release ]] || whole=yes
if [[ $without_data ]]; then
  export MOTORCADE_DATA=/nonexistent
  set -- -R "$(data_readers)" "$@"
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT
[[ ! -t 1 ]] || set -- --progress "$@"
status=0
ctest --preset $preset --parallel "$(nproc)" "$@" 2>&1 | tee "$log" || status=$?
if [[ $whole ]]; then
  tests/mcap.sh || status=$?
  tests/browser.sh || status=$?
fi

# One line on what was skipped, as ctest lists it at its end: "	 12 - io.Suite.Test (Skipped)".
skipped=$(sed -nE 's/^\s*[0-9]+ - (.*) \(Skipped\)$/\1/p' "$log")
if [[ $skipped ]]; then
  for_data=$(grep -cE "$(data_readers)" <<<"$skipped" || true)
  others=$(grep -vE "$(data_readers)" <<<"$skipped" | sed -E 's/  # .*//; s/[.\/][^.\/]*$//' | sort | uniq -c |
    awk '{ printf "%s%s (%d)", sep, $2, $1; sep = ", " }' || true)
  echo "Skipped: $for_data tests for want of real drives in ${MOTORCADE_DATA:-../shared/data}${others:+; for other reasons, as they say: $others}"
fi
exit $status
