#!/usr/bin/env bash
# Tests perf/instructions.sh on small profiles and records that are written here.
set -euo pipefail
cd "$(dirname "$0")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() { echo "$1" >&2; [[ ! -s $work/out ]] || cat "$work/out" >&2; exit 1; }
says() { grep -qF -- "$1" "$work/out" || fail "this is not said: $1"; }
is_silent_of() { ! grep -q -- "$1" "$work/out" || fail "this is said: $1"; }
ends_with() {  # CODE COMMAND...
  local expected=$1 code=0
  shift
  "$@" >"$work/out" 2>&1 || code=$?
  [[ $code -eq $expected ]] || fail "exit code $code instead of $expected: $*"
}
attribute() { awk -f perf/instructions/attribute.awk -v drive=street -v frames="$1" -v parts=libpng "$work/profile"; }
check() { awk -f perf/instructions/record.awk -v mode=check "$work/counts" "$work/record"; }
write() { awk -f perf/instructions/record.awk -v mode=write -v budgets="${1:-}" "$work/counts" "$work/record"; }
counts() {  # OPTICAL_FLOW REST
  printf 'street\t%s\t%s\n' "optical flow" "$1" rest "$2" all $(($1 + $2)) libpng 1000000
}

# The decoder is called twice from one place and twice from another, and is named where it is met first.
cat >"$work/profile" <<'END'
events: Ir
fn=(1) main
1 10
cfn=(2) motorcade::decodeAnyPng(std::basic_string_view<char>)
calls=2 0
1 600
fn=(2)
5 1000
+3 200
fn=(3) motorcade::decodeAnyPngs()
7 30
cfn=(2)
calls=2 0
* 600
totals: 1240
END
ends_with 0 attribute 2
says $'street\tlibpng\t600'
ends_with 1 attribute 3
says "was called 4 times, not 6"
sed -i 's/^totals: .*/totals: 1241/' "$work/profile"
ends_with 1 attribute 2
says "the profile is not whole"

cat >"$work/record" <<'END'
## street

| stage | instructions per frame | units | budget |
| --- | ---: | ---: | ---: |
| optical flow | 2,000,000 | 2.000 | 2.200 |
| rest | 100,000 | 0.100 | |
| all | 2,100,000 | 2.100 | |
| libpng | 1,000,000 | 1.000 | |

## elsewhere

| optical flow | 7 | 0.000 | 0.000 |
END
counts 2090000 300000 >"$work/counts"
ends_with 0 check
is_silent_of "FAILED\|NOTE"
counts 2110000 100000 >"$work/counts"
ends_with 1 check
says "FAILED street: optical flow takes 2,110,000 instructions per frame, 5.5 % more than the 2,000,000"
says "--write and say why in the commit"
counts 1890000 100000 >"$work/counts"
ends_with 0 check
says "NOTE street: optical flow fell by 5.5 %"

# Steps that are written down one by one end at the budget; written down alone they leave it as it is.
counts 2210000 100000 >"$work/counts"
write >"$work/written"
cp "$work/written" "$work/record"
ends_with 1 check
says "optical flow takes 2.210 units, more than its budget of 2.200"
is_silent_of "per frame, "
write yes >"$work/written"
cp "$work/written" "$work/record"
ends_with 0 check
ends_with 0 cat "$work/record"
says "| optical flow | 2,210,000 | 2.210 | 2.387 |"
says "| rest | 100,000 | 0.100 | |"
says "| optical flow | 7 | 0.000 | 0.000 |"

printf 'street\tnew stage\t5\n' >>"$work/counts"
ends_with 1 check
says "street: the record has no row for new stage"
echo "Growth, decline, budgets and incomplete profiles are found"
