#!/usr/bin/env bash
# Makes Debian's packages, looks at them with lintian, and tries them where nothing else is: in a new root, with compilers from Debian, the
# programs of examples/ are built against what the packages hold, and follow a drive. Needs root.
#   tests/packages.sh [ROOT]   the folder of the new root (default build/clean_root); one that is there is used again
set -euo pipefail
cd "$(dirname "$0")/.."
root=${1:-build/clean_root}
build=build/release tried=build/packages_tried

apps/setup.sh debootstrap lintian gzip
mkdir -p $tried
echo "== Packages"
apps/package.sh
lintian --fail-on error --suppress-tags bogus-mail-host,initial-upload-closes-no-bugs $build/packages/*.deb
tests/symbols.sh $build/apps/interface/libmotorcade.so

echo "== Another prefix"
moved=$tried/moved
rm -rf $moved
cmake --install $build --prefix $moved/first >/dev/null
mv $moved/first $moved/second
cmake -S examples/embed -B $moved/embed -DCMAKE_PREFIX_PATH="$PWD/$moved/second" --log-level=WARNING
cmake --build $moved/embed >/dev/null
library_dir=$(dirname "$(find "$PWD/$moved/second" -name motorcade.pc)")
c++ -std=c++20 examples/embed/main.cpp -o $moved/by_pkg_config $(PKG_CONFIG_PATH=$library_dir pkg-config --cflags --libs motorcade)

echo "== A new root"
if [[ ! -x $root/usr/bin/apt-get ]]; then debootstrap --variant=minbase bookworm "$root" >$tried/debootstrap.log; fi
cp /etc/apt/sources.list "$root/etc/apt/" 2>/dev/null || true
cp /etc/apt/apt.conf.d/*proxy* "$root/etc/apt/apt.conf.d/" 2>/dev/null || true
cp /etc/resolv.conf "$root/etc/"
rm -rf "$root/try" && mkdir -p "$root/try"
cp -r examples python/examples $build/packages "$root/try/"
drive=${MOTORCADE_DATA:-../shared/data}/kitti_tracking_0003
if [[ -d $drive ]]; then cp -r "$drive" "$root/try/drive"; else $build/apps/motorcade synth "$root/try/drive" --scene lead --frames 14 >/dev/null; fi

in_root() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 bash -euo pipefail -c "$1"; }
in_root 'apt-get update -qq
  apt-get install -y -qq --no-install-recommends g++ cmake make pkg-config >/dev/null
  apt-get install -y -qq --no-install-recommends /try/packages/*.deb >/dev/null'
in_root 'cd /try/examples
  for example in embed embed_c vehicle_stack; do
    cmake -S $example -B /try/build/$example >/dev/null
    cmake --build /try/build/$example >/dev/null
  done
  /try/build/embed/embed /try/drive >/try/cpp.txt
  /try/build/embed_c/embed_c /try/drive >/try/c.txt
  python3 embed_python/embed.py /try/drive >/try/python.txt
  motorcade --version | head -1
  for language in cpp c python; do grep -m1 "covariance" /try/$language.txt; done
  echo "compiling the example in C++:"; time g++ -std=c++20 -O2 -c embed/main.cpp -o /dev/null
  echo "compiling the example in C:"; time gcc -std=c11 -O2 -c embed_c/main.c -o /dev/null'
headers=$(in_root 'dpkg -L libmotorcade-dev | grep "^/usr/include/.*\.h"')
lines=$(in_root "cat $(tr '\n' ' ' <<<"$headers") | wc -l")
libraries=$(in_root 'ldd /usr/lib/*/libmotorcade.so | wc -l')
echo "$(wc -l <<<"$headers") headers of $lines lines; the library needs $libraries others"
[[ $(wc -l <<<"$headers") -eq 2 && $lines -le 460 && $libraries -le 12 ]]
in_root 'apt-get purge -y -qq libmotorcade1 libmotorcade-dev motorcade python3-motorcade libmotorcade1-modules >/dev/null; ! ls /usr/lib/*/libmotorcade* 2>/dev/null'
echo "The packages install, what is built with them runs, and they go again"
