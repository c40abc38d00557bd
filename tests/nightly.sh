#!/usr/bin/env bash
# Runs what takes too long for every change: clang-tidy on every source, all tests with and without sanitizers, fuzzing, the packages, results
# on an arm64 processor, other systems and compilers, a long drive, and rendered scenes over ten seeds in both styles. Goes on after a
# failure; prints one table at its end,
# and ends with exit code 1 if any step failed. The scenes' figures are in build/nightly/scenes.log and scenes_film.log.
#   tests/nightly.sh [FUZZ_SECONDS]   per target, default 600
set -uo pipefail
cd "$(dirname "$0")/.."
logs=build/nightly
mkdir -p $logs
table=() failed=0

step() {  # NAME COMMAND...
  local name=$1 started=$SECONDS result=passed
  shift
  echo "== $name: $*"
  "$@" >"$logs/${name// /_}.log" 2>&1 || { result=FAILED failed=1; tail -n 30 "$logs/${name// /_}.log"; }
  table+=("$(printf '| %-12s | %-6s | %6d s |' "$name" "$result" $((SECONDS - started)))")
}

step lint .ci/lint --all
step tests tests/run.sh
step asan tests/run.sh --asan  # with UndefinedBehaviorSanitizer, and LeakSanitizer at the end of each test
step tsan tests/run.sh --tsan
step fuzz tests/fuzz.sh "${1:-600}"
step packages tests/packages.sh
step arm64 tests/arm64.sh
step "arm64 counts" perf/arm64_instructions.sh
step systems tests/systems.sh
step "long drive" perf/long_drive.sh 100000
step scenes perf/scenes.sh
step "scenes film" perf/scenes.sh --style film

echo "| step         | result | duration |"
echo "| ------------ | ------ | -------- |"
printf '%s\n' "${table[@]}"
exit $failed
