#!/usr/bin/env bash
# Counts each stage's instructions per frame on arm64 with NEON, beside those of x86-64 with AVX2: both under qemu, by the same plugin, with
# the library linked into one program. Writes a table. Needs what tests/arm64.sh leaves in build/arm64_root.
#   perf/arm64_instructions.sh [DRIVE [FRAMES]]   default kitti_tracking_0003 of MOTORCADE_DATA (../shared/data), 40 frames
set -euo pipefail
cd "$(dirname "$0")/.."
drive=${1:-${MOTORCADE_DATA:-../shared/data}/kitti_tracking_0003} frames=${2:-40}
root=$PWD/build/arm64_root
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
[[ -d $root ]] || { echo "perf/arm64_instructions.sh: run tests/arm64.sh first, which makes $root" >&2; exit 2; }
gcc -O2 -shared -fPIC perf/instructions/count_functions.c -o "$work/libcount_functions.so"

parts=(
  "decoding=motorcade::PairReader::read("
  "input_check=motorcade::RigWatch::observe("
  "prepare=motorcade::StageRunner::prepare("
  "stereo_matching=motorcade::StageRunner::matchStereo("
  "optical_flow=motorcade::StageRunner::trackFlow("
  "scene_flow_segmentation=motorcade::StageRunner::segmentSceneFlow("
  "tracking=motorcade::StageRunner::trackObjects("
  "incremental_optimization=motorcade::StageRunner::optimize("
  "object_shapes=motorcade::StageRunner::shapeObjects("
)

# One program with fixed addresses, which the plugin is told.
linked() {  # BUILD COMPILER FOLDER_OF_LIBRARIES [OPTION...]
  local build=$1 compiler=$2 folder=$3 libraries=()
  shift 3
  for part in interface pipeline watch frontend backend io core; do
    libraries+=("$(find "$build" -name "libmotorcade_$part.a")")
  done
  "$compiler" -std=c++20 -O2 -ffp-contract=off -no-pie tests/support/print_results.cpp -Iinclude \
    -Wl,--start-group "${libraries[@]}" -Wl,--end-group "$folder"/lib{tbb,png,jpeg,deflate,ccolamd}.so "$@" -o "$work/print_results"
}

functions() {  # the plugin's arguments
  local part name prefix address size symbol
  nm --demangle --print-size "$work/print_results" >"$work/symbols"
  for part in "${parts[@]}"; do
    name=${part%%=*} prefix=${part#*=}
    read -r address size _ symbol < <(grep -F " $prefix" "$work/symbols" | grep -v '\[clone' | awk -v prefix="$prefix" '
      NF > 3 { text = $0; sub(/^[^ ]* [^ ]* [^ ]* /, "", text); if (index(text, prefix) == 1) { print; exit } }')
    [[ $symbol ]] || { echo "perf/arm64_instructions.sh: there is no $prefix" >&2; return 1; }
    printf ',of=%s:%x:%x' "$name" "0x$address" $((0x$address + 0x$size))
  done
}

counted() {  # NAME EMULATOR...
  local name=$1 arguments
  shift
  arguments=$(functions)
  "$1" -plugin "$work/libcount_functions.so$arguments,to=$work/$name" "${@:2}" "$work/print_results" "$drive" "$frames" 1 >"$work/$name.txt"
}

linked build/release c++ "/usr/lib/$(gcc -print-multiarch)" -lz
counted x86-64 qemu-x86_64 -cpu max
linked build/arm64 aarch64-linux-gnu-g++ "$root/usr/lib/aarch64-linux-gnu" "$root/lib/aarch64-linux-gnu/libz.so.1" \
  -Wl,-rpath-link,"$root/usr/lib/aarch64-linux-gnu"
counted arm64 qemu-aarch64 -L "$root" -E LD_LIBRARY_PATH="$root/usr/lib/aarch64-linux-gnu"
cmp "$work/x86-64.txt" "$work/arm64.txt"

echo "| stage | x86-64, AVX2 | arm64, NEON | ratio |"
echo "| --- | ---: | ---: | ---: |"
paste "$work/x86-64" "$work/arm64" | awk -v frames="$frames" '
  function row(name, x86, arm) { printf "| %s | %.2f M | %.2f M | %.2f |\n", name, x86 / frames / 1e6, arm / frames / 1e6, arm / x86 }
  { gsub(/_/, " ", $1); x86 += $3; arm += $6 }
  $1 == "all" { row("rest", $3 - (x86 - $3), $6 - (arm - $6)) }
  { row($1, $3, $6) }'
