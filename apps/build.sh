#!/usr/bin/env bash
# Builds targets of a configured preset and shows the progress: apps/build.sh PRESET [TARGET ...]
# Without a terminal it prints a line for each tenth of the build. The compiler's output is shown in full.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=$1 && shift
targets=("$@")
export NINJA_STATUS="[%p of the build, %e s] "
build=(cmake --build --preset "$preset" --parallel "${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}" ${targets[0]:+--target "${targets[@]}"})

if [[ -t 1 ]]; then exec "${build[@]}"; fi
"${build[@]}" 2>&1 | awk '
  /^\[ *[0-9]+% of the build, [0-9.]+ s\] / {
    tenth = int(substr($0, 2) / 10)
    if (tenth == told && told != "") next
    told = tenth
    sub(/ s\] .*/, " s]")
  }
  { print; fflush() }'
