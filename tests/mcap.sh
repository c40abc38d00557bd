#!/usr/bin/env bash
# Writes a short rendered drive as MCAP, live and from its run folder, and reads both files with the readers and schemas that others
# use (npm's @mcap/core, @foxglove/schemas). The same with an ASAM OSI trace. Then runs the drive from bags that others' writers made: the results are those of the folder.
#   tests/mcap.sh [PROGRAM] [FOLDER of a sequence with image_0, image_1 and calib.txt]
# Installs Node.js where it is missing; prints one line and ends well where that cannot be, or npm cannot reach its packages.
set -euo pipefail
cd "$(dirname "$0")/.."
program=$(realpath "${1:-build/release/apps/motorcade}")

leave_out() { echo "tests/mcap.sh: left out, $1"; exit 0; }
command -v node >/dev/null && command -v npm >/dev/null || apps/setup.sh nodejs npm >/dev/null 2>&1 || leave_out "Node.js cannot be installed"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp tests/mcap/package.json tests/mcap/read_mcap.js tests/mcap/read_osi.js tests/mcap/write_bag.js "$work"
timeout 300 npm install --prefix "$work" --no-audit --no-fund --ignore-scripts --loglevel=error >"$work/npm.log" 2>&1 ||
  leave_out "npm cannot install its packages"

sequence=${2:-$work/drive}
[[ -n ${2:-} ]] || "$program" synth "$sequence" --scene lead --frames 40 --size 621x187 --quiet
"$program" run "$sequence" --out "$work/run" --masks --mcap "$work/live.mcap" --quiet
"$program" export "$work/run" --mcap "$work/exported.mcap" --quiet
node "$work/read_mcap.js" "$work/run" "$work/live.mcap" online
node "$work/read_mcap.js" "$work/run" "$work/exported.mcap" final
"$program" export "$work/run" --osi "$work/trace.mcap" --quiet
node "$work/read_osi.js" "$work/run" "$work/trace.mcap"

# A bag's camera_info has the projections, and not how exact they are.
grep '^P[01]:' "$sequence/calib.txt" >"$work/projections.txt"
"$program" run "$sequence" --calibration "$work/projections.txt" --out "$work/folder" --quiet
for bag in "ros2 raw none" "ros2 raw lz4" "ros2 compressed zstd" "ros1 raw zstd" "ros1 compressed lz4" "foxglove raw none" "foxglove compressed zstd"; do
  read -r profile kind compression <<<"$bag"
  node "$work/write_bag.js" "$sequence" "$work/drive.mcap" "$profile" "$kind" "$compression"
  end=$([[ $kind == compressed ]] && echo /compressed || true)
  "$program" run "$work/drive.mcap" --topics "/stereo/left/image_raw$end,/stereo/right/image_raw$end" --out "$work/bag" --force --quiet
  for file in camera_online.txt camera_final.txt camera_final.tum objects_online.csv objects_final.csv covariances.csv; do
    cmp "$work/folder/$file" "$work/bag/$file"
  done
  echo "bag: $bag, the same results as of the folder"
done
