#!/usr/bin/env bash
# Builds the library for arm64 with Debian's cross compiler and follows a short drive with it under emulation: the results are those of this
# machine. Then makes Debian's packages for arm64 of the library, its header and its modules, in build/arm64/packages. Needs root, for packages;
# what arm64 itself needs is unpacked into build/arm64_root, not installed.
#   tests/arm64.sh
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD/build/arm64_root build=build/arm64

apps/setup.sh g++-aarch64-linux-gnu debootstrap dpkg-dev file qemu-user
if [[ ! -e $root/usr/lib/aarch64-linux-gnu/libdeflate.so ]]; then
  debootstrap --foreign --arch=arm64 --variant=minbase \
    --include=libtbb-dev,libsuitesparse-dev,libpng-dev,libjpeg62-turbo-dev,libdeflate-dev,zlib1g-dev,libyaml-cpp-dev,libeigen3-dev,nlohmann-json3-dev,libtomlplusplus-dev,libhwy-dev \
    bookworm "$root" >/dev/null
  for package in "$root"/var/cache/apt/archives/*.deb; do dpkg-deb --extract "$package" "$root"; done
fi

cat >$build.toolchain.cmake <<TOOLCHAIN
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH $root)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
include_directories(SYSTEM $root/usr/include/aarch64-linux-gnu)
add_link_options(LINKER:-rpath-link,$root/usr/lib/aarch64-linux-gnu)
TOOLCHAIN
cmake --preset release -B $build -DCMAKE_TOOLCHAIN_FILE=$PWD/$build.toolchain.cmake -DMOTORCADE_SIFT=OFF \
  -DCMAKE_INSTALL_PREFIX=/usr -DCMAKE_INSTALL_LIBDIR=lib/aarch64-linux-gnu -DMOTORCADE_BUILD_APPS=OFF -DMOTORCADE_BUILD_TESTS=OFF \
  --log-level=WARNING
cmake --build $build --target libmotorcade
aarch64-linux-gnu-g++ -std=c++20 -O2 -ffp-contract=off tests/support/print_results.cpp -Iinclude -L$build/apps/interface -lmotorcade \
  -Wl,-rpath-link,"$root/usr/lib/aarch64-linux-gnu" -o $build/print_results

cmake --preset release --log-level=WARNING
cmake --build --preset release --target motorcade print_results
drive=build/arm64_drive
[[ -d $drive ]] || build/release/apps/motorcade synth $drive --scene lead --frames 14 --size 310x94 >/dev/null
build/release/tests/interface/print_results $drive >$build/here.txt
qemu-aarch64 -L "$root" -E LD_LIBRARY_PATH="$PWD/$build/apps/interface:$root/usr/lib/aarch64-linux-gnu" $build/print_results $drive >$build/arm64.txt
cmp $build/here.txt $build/arm64.txt
[[ -s $build/here.txt ]]
echo "arm64: the same bits in $(wc -l <$build/here.txt) lines"

# dpkg-shlibdeps knows the libraries of this machine alone. Those of arm64 have the same names and versions in the same release of Debian.
[[ -e $(echo build/release/packages/libmotorcade1_*.deb) ]] || apps/package.sh
dependencies() { dpkg-deb --field build/release/packages/"$1"_*.deb Depends | sed 's/libopencv[^,]*, //g'; }
cmake --build $build
(cd $build && cpack -G DEB -D CPACK_DEBIAN_PACKAGE_ARCHITECTURE=arm64 -D CPACK_DEBIAN_PACKAGE_SHLIBDEPS=OFF -D CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS=OFF \
  -D CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS="$(cd "$OLDPWD" && dependencies libmotorcade1)" \
  -D CPACK_DEBIAN_MODULES_PACKAGE_DEPENDS="$(cd "$OLDPWD" && dependencies libmotorcade1-modules)") >$build/cpack.log || { cat $build/cpack.log; exit 1; }
rm -rf $build/unpacked
for package in $build/packages/*.deb; do
  [[ $(dpkg-deb --field "$package" Architecture) == arm64 ]]
  dpkg-deb --extract "$package" $build/unpacked
done
for library in $(find $build/unpacked -type f -name '*.so*'); do file "$library" | grep -q 'ARM aarch64'; done
ls -sh $build/packages/*.deb
