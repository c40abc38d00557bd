#!/usr/bin/env bash
# A run's results are the same bytes whatever the processor: with the kernels for any x86-64 instead of those for x86-64-v3, and, where
# qemu-user is installed, on an emulated processor without AVX2 and fused multiplication, for which the C library chooses other functions too.
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

name=here follow "$motorcade"
name=any MOTORCADE_INSTRUCTIONS=any follow "$motorcade"
name=any same
if command -v qemu-x86_64 >/dev/null; then
  name=emulated follow qemu-x86_64 -cpu Nehalem "$motorcade"
  name=emulated same
else
  echo "emulated: skipped, as qemu-user is not installed"
fi
