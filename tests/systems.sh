#!/usr/bin/env bash
# Builds everything and runs every test on Debian 12 and 13, with GCC and clang of each, in a root of its own for each release. Then a drive is
# followed there: its results are the bytes of the build here. Needs root. A root that is there is used again.
#   tests/systems.sh [SYSTEM...]   of bookworm-gcc, bookworm-clang, trixie-gcc, trixie-clang; all when absent
set -euo pipefail
cd "$(dirname "$0")/.."
systems=("$@")
[[ ${#systems[@]} -gt 0 ]] || systems=(bookworm-gcc bookworm-clang trixie-gcc trixie-clang)
results=(camera_online.txt camera_final.txt objects_online.csv objects_final.csv covariances.csv)
roots=$PWD/build/systems mounted=()
trap 'for place in "${mounted[@]}"; do umount --recursive --lazy "$place"; done' EXIT

apps/setup.sh debootstrap
drive=${MOTORCADE_DATA:-../shared/data}/kitti_tracking_0003
motorcade=build/release/apps/motorcade
cmake --preset release --log-level=WARNING
apps/build.sh release motorcade
if [[ ! -d $drive ]]; then
  drive=build/systems/drive
  [[ -d $drive ]] || "$motorcade" synth $drive --scene overtake --frames 40 >/dev/null
fi
"$motorcade" run "$drive" --out "$roots/here" --force --masks --quiet

in_root() {  # SUITE COMMANDS
  chroot "$roots/$1" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive bash -euo pipefail -c "$2"
}

prepare() {  # SUITE: its root, with what programs expect of a system
  local root=$roots/$1
  [[ -x $root/usr/bin/apt-get ]] || debootstrap --variant=minbase --include=ca-certificates "$1" "$root" >"$roots/$1_debootstrap.log"
  cp /etc/apt/apt.conf.d/*proxy* "$root/etc/apt/apt.conf.d/" 2>/dev/null || true
  cp /etc/resolv.conf "$root/etc/"
  for place in proc dev; do
    mountpoint -q "$root/$place" && continue
    mount --rbind "/$place" "$root/$place"
    mounted+=("$root/$place")
  done
  rm -rf "$root/drive" && cp -rL "$drive" "$root/drive"
  in_root "$1" 'apt-get update -qq'
}

try_system() {  # SUITE COMPILER
  local suite=$1 root=$roots/$1 source=/motorcade-$2 cc=gcc cxx=g++ package=g++ file
  [[ $2 == gcc ]] || cc=clang cxx=clang++ package=clang
  mkdir -p "$root$source"
  git ls-files -z | tar --create --null --files-from=- | tar --extract --directory "$root$source"
  in_root "$suite" "cd $source && apps/setup.sh $package && export CC=$cc CXX=$cxx && $cxx --version | head -1 && tests/run.sh --timeout 600
    build/release/apps/motorcade run /drive --out /run-$2 --force --masks --quiet"
  for file in "${results[@]}"; do cmp "$roots/here/$file" "$root/run-$2/$file"; done
  echo "$suite, $2: builds, passes, and gives the same bytes"
}

mkdir -p "$roots"
for system in "${systems[@]}"; do
  [[ $system =~ ^(bookworm|trixie)-(gcc|clang)$ ]] || { echo "tests/systems.sh: $system is no system; see its head" >&2; exit 2; }
  suite=${BASH_REMATCH[1]} compiler=${BASH_REMATCH[2]}
  echo "== $suite, $compiler"
  prepare "$suite"
  try_system "$suite" "$compiler"
done
