#!/usr/bin/env bash
# Installs the missing ones of Motorcade's dependencies from Debian's packages, and the packages named as arguments. Needs root or sudo
# only when something is missing.
set -euo pipefail

packages=(
  g++ cmake ninja-build
  libeigen3-dev libtbb-dev libsuitesparse-dev
  libopencv-core-dev libopencv-imgproc-dev libopencv-features2d-dev
  libpng-dev libjpeg62-turbo-dev libdeflate-dev libhwy-dev zlib1g-dev libzstd-dev liblz4-dev libsqlite3-dev
  libspdlog-dev libcli11-dev libtomlplusplus-dev nlohmann-json3-dev libyaml-cpp-dev libxxhash-dev
  pkg-config libcairo2-dev fonts-dejavu-core libcpp-httplib-dev libjs-three libjs-chart.js libprotobuf-dev protobuf-compiler
  help2man
  cyclonedds-dev cyclonedds-tools
  libgtest-dev libgmock-dev
  "$@"
)

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $status == installed ]] || missing+=("$package")
done
[[ ${#missing[@]} -gt 0 ]] || exit 0

as_root=()
if [[ $(id -u) -ne 0 ]]; then
  command -v sudo >/dev/null || { echo "These packages are missing, and neither root nor sudo is there: ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
echo "Installing ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
