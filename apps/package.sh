#!/usr/bin/env bash
# Makes Debian's packages of the libraries, the program and the Python package, in build/release/packages. `apt install
# ./build/release/packages/*.deb` installs them.
set -euo pipefail
cd "$(dirname "$0")/.."
build=build/release

apps/setup.sh dpkg-dev file pybind11-dev python3-dev python3-numpy
cmake --preset release -DCMAKE_INSTALL_PREFIX=/usr -DCMAKE_INSTALL_LIBDIR="lib/$(gcc -print-multiarch)" -DMOTORCADE_BUILD_PYTHON=ON --log-level=WARNING
apps/build.sh release
rm -rf $build/packages
(cd $build && cpack -G DEB >cpack.log) || { cat $build/cpack.log; exit 1; }
ls -sh $build/packages/*.deb
