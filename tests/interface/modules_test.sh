#!/usr/bin/env bash
# The shared library with and without its modules: the same results as the program, whose code they are part of, and errors that name what is
# missing: modules_test.sh MODULE_USER MOTORCADE LIBRARY DRIVE
set -euo pipefail
user=$1 motorcade=$2 library=$3 drive=$4
data=$(realpath -m "${MOTORCADE_DATA:-$(dirname "$0")/../../../shared/data}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0
complain() { echo "$1"; failures=$((failures + 1)); }

# with FOLDER ARGUMENTS... : follows a drive with the shared library of that folder, into $work/poses; gives the exit code
with() {
  local folder=$1
  shift
  LD_LIBRARY_PATH=$folder "$user" "$@" >"$work/poses" 2>"$work/error"
}

# expect_poses NAME : that the poses are those of the program's run NAME
expect_poses() { cmp "$work/poses" "$work/$1/camera_online.txt" || complain "$1: not what the program gives: $(cat "$work/error")"; }

# expect_close NAME : that they are but for the last bits, which hang on the order in which inline functions were linked
expect_close() {
  paste -d ' ' "$work/poses" "$work/$1/camera_online.txt" | awk '
    NF != 24 { bad = 1 }
    { for (i = 1; i <= 12; ++i) if (($i - $(i + 12)) ^ 2 > 1e-16) bad = 1 }
    END { exit bad || NR == 0 }' || complain "$1: not what the program gives: $(cat "$work/error")"
}

# expect_error PART... : that the error holds each part
expect_error() {
  for part in "$@"; do
    [[ $(cat "$work/error") == *"$part"* ]] || complain "'$(cat "$work/error")' does not hold '$part'"
  done
}

# run NAME ARGUMENTS... : a run of the program
run() {
  local out=$work/$1
  shift
  "$motorcade" run "$@" --out "$out" 2>"$work/error" || complain "motorcade run $*: $(cat "$work/error")"
}

# A folder of the library alone, and one of images with a calibration in YAML.
soname=$(basename "$(readlink -f "$library")" | grep -o 'libmotorcade\.so\.[0-9]*')
mkdir -p "$work/alone" "$work/yaml"
cp "$library" "$work/alone/$soname"
cp -r "$drive/image_0" "$work/yaml/left"
cp -r "$drive/image_1" "$work/yaml/right"
cat >"$work/yaml/camchain.yaml" <<'YAML'
cam0: {camera_model: pinhole, intrinsics: [180, 180, 152, 43], distortion_coeffs: [-0.01, 0, 0, 0], distortion_model: radtan}
cam1:
  camera_model: pinhole
  intrinsics: [180, 180, 152, 43]
  distortion_coeffs: [-0.01, 0, 0, 0]
  distortion_model: radtan
  T_cn_cnm1: [[1, 0, 0, -0.5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
YAML

sift='frontend.detector = "sift"'
echo "$sift" >"$work/sift.toml"
run sift "$drive" --config "$work/sift.toml"
run corners "$drive"
run lenses "$work/yaml"
if cmp -s "$work/sift/camera_online.txt" "$work/corners/camera_online.txt"; then complain "the detector makes no difference"; fi

folder=$(dirname "$library")
with "$folder" "$drive" "$sift" || complain "sift: $(cat "$work/error")"
expect_poses sift
with "$folder" "$work/yaml" || complain "yaml: $(cat "$work/error")"
expect_poses lenses

# The library is found by a relative path, and the modules are found all the same.
cd "$(dirname "$folder")"
with "$(basename "$folder")" "$drive" "$sift" || complain "relative: $(cat "$work/error")"
expect_poses sift

# Without modules what needs none works. The folder that the program is started in has them, and is not looked into.
cd "$folder"
with "$work/alone" "$drive" || complain "alone: $(cat "$work/error")"
expect_poses corners
if with "$work/alone" "$drive" "$sift"; then complain "SIFT without its module"; fi
expect_error "options.settings: " "$sift" "$work/alone/motorcade/sift.so is not there" "install the package libmotorcade" "motorcade_sift_module"
if with "$work/alone" "$work/yaml"; then complain "YAML without its module"; fi
expect_error "folder: " "camchain.yaml" "$work/alone/motorcade/yaml.so is not there" "install the package libmotorcade" "motorcade_yaml_module"

if [[ -d $data/euroc_v101 ]]; then
  run euroc "$data/euroc_v101"
  with "$folder" "$data/euroc_v101" || complain "EuRoC: $(cat "$work/error")"
  expect_close euroc
else
  echo "EuRoC is not in $data and is left out"
fi
exit "$failures"
