#!/usr/bin/env bash
# The shared library needs few others (with Debian 13's SuiteSparse OpenMP, too), and neither OpenCV nor yaml-cpp; its modules need those,
# and export one function each:
#   dependencies_test.sh LIBRARY MODULE...
set -euo pipefail
library=$1
shift
needed=$(ldd "$library")
[[ $(wc -l <<<"$needed") -le 13 ]] || { echo "More than 13 libraries come with $library:"$'\n'"$needed"; exit 1; }
if grep -i 'opencv\|yaml' <<<"$needed"; then echo "come with $library"; exit 1; fi
for module in "$@"; do
  exported=$(nm -D --defined-only "$module" | sed 's/.* //')
  name=$(basename "$module" .so)
  [[ $exported =~ ^motorcade_${name}_[0-9]+$ ]] || { echo "$module exports:"$'\n'"$exported"; exit 1; }
done
echo "$(wc -l <<<"$needed") libraries come with the shared one"
