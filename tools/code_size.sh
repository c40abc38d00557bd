#!/usr/bin/env bash
# Measures the shape of the code with universal-ctags (lambdas count to the function around them) and fails where it is out of
# bounds: functions at the 90th percentile at most 19 lines, none over 50, none with over 6 parameters; sources at most 350 lines;
# headers at the 90th percentile at most 100; lines at most 120 columns.
set -euo pipefail
cd "$(dirname "$0")/.."
command -v ctags >/dev/null || { echo "tools/code_size.sh needs universal-ctags: apt-get install universal-ctags" >&2; exit 2; }

files=$(mktemp)
trap 'rm -f "$files"' EXIT
git ls-files --cached --others --exclude-standard '*.cpp' '*.hpp' | while read -r file; do [[ -f $file ]] && echo "$file"; done >"$files"

functions() {  # LINES FILE:LINE NAME PARAMETERS
  ctags --languages=C++ --kinds-C++=f --fields=+neS -L "$files" -o - 2>/dev/null | awk -F'\t' '
    {
      line = end = 0; signature = ""
      for (i = 4; i <= NF; ++i) {
        if ($i ~ /^line:/) line = substr($i, 6)
        if ($i ~ /^end:/) end = substr($i, 5)
        if ($i ~ /^signature:/) signature = substr($i, 11)
      }
      if (!end) next
      sub(/^\(/, "", signature); sub(/\)[^)]*$/, "", signature)
      do { before = signature; gsub(/<[^<>]*>|\([^()]*\)|\{[^{}]*\}/, "", signature) } while (signature != before)
      count = signature ~ /[^ ]/ ? gsub(/,/, ",", signature) + 1 : 0
      name = $1; gsub(/ /, "", name)
      print end - line + 1, $2 ":" line, name, count
    }' | sort -n
}

quantile90() { sort -n | awk '{ value[NR] = $1 } END { print value[int(0.9 * (NR - 1)) + 1] }'; }

failed=0
bound() {  # WHAT VALUE MOST
  printf '%-40s %5s (at most %s)\n' "$1" "$2" "$3"
  [[ $2 -le $3 ]] || failed=1
}

all=$(functions)
bound "functions, 90th percentile of lines" "$(quantile90 <<<"$all")" 19
bound "functions, most lines" "$(tail -1 <<<"$all" | cut -d' ' -f1)" 50
bound "functions, most parameters" "$(awk '{ if ($4 > most) most = $4 } END { print most }' <<<"$all")" 6
bound "sources, most lines" "$(xargs wc -l <"$files" | grep -v ' total$' | awk '{ if ($1 > most) most = $1 } END { print most }')" 350
bound "headers, 90th percentile of lines" "$(grep 'hpp$' "$files" | xargs wc -l | grep -v ' total$' | quantile90)" 100
bound "lines, most columns" "$(xargs cat <"$files" | awk '{ if (length > most) most = length } END { print most }')" 120
if [[ $failed -ne 0 ]]; then
  echo "Out of bounds:"
  awk '$1 > 50 { print "  " $2 " " $3 " has " $1 " lines" } $4 > 6 { print "  " $2 " " $3 " has " $4 " parameters" }' <<<"$all"
  xargs wc -l <"$files" | grep -v ' total$' | awk '$1 > 350 { print "  " $2 " has " $1 " lines" }'
  xargs awk 'length > 120 { print "  " FILENAME ":" FNR " has " length " columns" }' <"$files"
fi
exit $failed
