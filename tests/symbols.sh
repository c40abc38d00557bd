#!/usr/bin/env bash
# The symbols that the shared library exports are those of apps/interface/symbols.txt; fails when they are not, so that no change of the
# binary interface goes unannounced. A symbol that is new is added to the list (and to a version of its own in symbols.map, once there are
# releases); one that is gone or changed makes programs that are built already fail: MOTORCADE_SOVERSION counts up.
# T is a function, D is data. Whether a definition is weak does not count: GCC emits the type information of `motorcade::Error`, by which
# programs catch it, as weak, clang does not, and the dynamic linker treats both alike.
#   tests/symbols.sh LIBRARY [--update]
set -euo pipefail
list=$(dirname "$0")/../apps/interface/symbols.txt
found=$(mktemp)
trap 'rm -f "$found"' EXIT
nm --dynamic --defined-only --with-symbol-versions "$1" | awk '{ sub("W", "T", $2); sub("[VBR]", "D", $2); print $2, $3 }' | LC_ALL=C sort -u >"$found"
if [[ ${2:-} == --update ]]; then cp "$found" "$list" && exit 0; fi
diff -u --label "apps/interface/symbols.txt" --label "$1" "$list" "$found" || {
  echo "The binary interface has changed: see $0 for what to do, then list the symbols anew with --update." >&2
  exit 1
}
echo "$(wc -l <"$list") symbols, all announced"
