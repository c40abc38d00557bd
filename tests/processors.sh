#!/usr/bin/env bash
# Tests that a run's results are the same bytes on every processor: with the kernels for each instruction set that this one has, and, where qemu-user
# is installed, on an emulated processor without AVX2 and fused multiplication, for which the C library chooses other functions too.
#   tests/processors.sh MOTORCADE DRIVE [FRAMES]
set -euo pipefail
motorcade=$1 drive=$2 frames=${3:-1000000}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

follow() { "$@" run "$drive" --frames "0:$frames" --out "$out/$name" --masks --quiet >/dev/null 2>"$out/$name.log" || { cat "$out/$name.log"; exit 1; }; }
same() {
  for file in camera_online.txt camera_final.txt objects_online.csv objects_final.csv covariances.csv; do
    cmp "$out/here/$file" "$out/$name/$file"
    [[ -s $out/here/$file ]]
  done
  echo "$name: the same bytes"
}

instructions() { "$@" --version | sed -n 's/^instruction_set *//p'; }
kernels_are() {  # WHICH COMMAND...: else the comparison would be one of equal programs
  local which=$1 found
  shift
  found=$(instructions "$@")
  [[ $found == "$which" ]] || { echo "$* has kernels for $found, not for $which" >&2; exit 1; }
}

name=here follow "$motorcade"
best=$(instructions "$motorcade")
if [[ $best != AVX* ]]; then
  echo "skipped, as this processor has no AVX2"
  exit 77
fi
for lesser in AVX2 SSE4 SSE2; do
  [[ $lesser != "$best" ]] || continue
  kernels_are $lesser env MOTORCADE_INSTRUCTIONS=$lesser "$motorcade"
  name=$lesser MOTORCADE_INSTRUCTIONS=$lesser follow "$motorcade"
  name=$lesser same
done
if command -v qemu-x86_64 >/dev/null; then
  kernels_are SSE2 qemu-x86_64 -cpu Nehalem "$motorcade"
  name=emulated follow qemu-x86_64 -cpu Nehalem "$motorcade"
  name=emulated same
else
  echo "emulated: skipped, as qemu-user is not installed"
fi
