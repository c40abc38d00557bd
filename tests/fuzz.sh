#!/usr/bin/env bash
# Feeds the readers of strangers' files with what libFuzzer makes of a few small inputs, under AddressSanitizer and
# UndefinedBehaviorSanitizer (tests/fuzz, clang): first the committed inputs, among them one for each fault that was found, then new ones.
#   tests/fuzz.sh [SECONDS [TARGET ...]]   SECONDS per target (default 10), as many at a time as there are processors
# A finding ends with exit code 1 and stays in build/fuzz/findings; put it into tests/fuzz/corpus/TARGET with its fix.
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=${1:-10}
targets=("${@:2}")
[[ ${#targets[@]} -gt 0 ]] || targets=(bag calibration configuration image labels manifest oxts pose_graph rig run_tables times vehicle_motion y4m)
apps/setup.sh clang libclang-rt-dev llvm
cmake --preset fuzz --log-level=WARNING >/dev/null
cmake --build --preset fuzz

fuzz() {  # SECONDS TARGET
  local corpus=tests/fuzz/corpus/$2 findings=build/fuzz/findings/$2 log
  log=build/fuzz/$2.log
  rm -rf "$findings"
  mkdir -p "$findings/grown"
  # An input takes 2 s and 512 MB at most. What freed memory AddressSanitizer keeps back does not count.
  export ASAN_OPTIONS=quarantine_size_mb=32:detect_leaks=1
  local limits=(-timeout=2 -rss_limit_mb=512 -max_len=4096 -artifact_prefix="$findings/")
  if build/fuzz/tests/fuzz/"$2"_fuzz "${limits[@]}" -runs=0 "$corpus" >"$log" 2>&1 &&
    build/fuzz/tests/fuzz/"$2"_fuzz "${limits[@]}" -max_total_time="$1" "$findings/grown" "$corpus" >>"$log" 2>&1; then
    echo "$2: $(sed -n 's/^Done \([0-9]*\) runs.*/\1/p' "$log" | tail -1) inputs, no finding"
  else
    echo "$2: a finding in $findings" && tail -n 40 "$log"
    return 1
  fi
}
export -f fuzz
printf '%s\n' "${targets[@]}" | xargs -P"$(nproc)" -I{} bash -c "fuzz $seconds {}" || { echo "The fuzzers found faults" >&2; exit 1; }
