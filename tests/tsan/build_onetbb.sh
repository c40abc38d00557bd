#!/usr/bin/env bash
# Builds the distribution's oneTBB under ThreadSanitizer, once per version, and prints the folder of its CMake files. Debian's own
# library is not instrumented: with it TSan reports races that are none, and suppressing those hides real ones.
# Needs network for the first build of a version only. Nothing outside the cache folder changes: the package lists with sources are private.
#   tests/tsan/build_onetbb.sh [CACHE_FOLDER]
set -euo pipefail

version=$(dpkg-query --show --showformat='${source:Upstream-Version}' libtbb-dev)
cache=${1:-${XDG_CACHE_HOME:-$HOME/.cache}/motorcade}
installed=$cache/onetbb-tsan-$version-gcc$(c++ -dumpversion)
cmake_files=$installed/lib/cmake/TBB
if [[ -f $cmake_files/TBBConfig.cmake ]]; then
  echo "$cmake_files"
  exit
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work"/{parts,lists/partial,source} "$cache"

# The machine's Debian sources, with `deb-src` where it says `deb`.
for file in /etc/apt/sources.list.d/*.sources; do
  [[ -f $file ]] && grep -q '^Types:.*\bdeb\b' "$file" && sed 's/^Types:.*/Types: deb-src/' "$file" >"$work/parts/${file##*/}"
done
for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
  [[ -f $file ]] && sed -n 's/^deb /deb-src /p' "$file" >"$work/parts/${file##*/}.list"
done
apt=(-o Dir::Etc::SourceList=/dev/null -o "Dir::Etc::SourceParts=$work/parts" -o "Dir::State::Lists=$work/lists"
  -o APT::Sandbox::User=root -o Dir::Cache::pkgcache= -o Dir::Cache::srcpkgcache=)
apt-get "${apt[@]}" update -qq >&2
(cd "$work/source" && apt-get "${apt[@]}" source --download-only -qq "onetbb=$(dpkg-query --show --showformat='${source:Version}' libtbb-dev)" >&2)
tar -C "$work/source" -xf "$work"/source/onetbb_*.orig.tar.*

cmake -S "$work"/source/oneTBB-* -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_INSTALL_PREFIX="$installed" \
  -DCMAKE_INSTALL_LIBDIR=lib -DTBB_SANITIZE=thread -DTBB_STRICT=OFF -DTBBMALLOC_BUILD=OFF -DTBB_TEST=OFF >"$work/log" 2>&1 &&
  cmake --build "$work/build" --target install >>"$work/log" 2>&1 || { tail -30 "$work/log" >&2; exit 1; }
echo "$cmake_files"
