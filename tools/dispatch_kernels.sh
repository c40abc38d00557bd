#!/usr/bin/env bash
# Makes one object of two versions of the same sources, for any x86-64 and for x86-64-v3:
#   tools/dispatch_kernels.sh OUT ANY.o... -- V3.o...
# Each function F that the sources define for others becomes a jump through a pointer, at first to `F.any`. When the program starts,
# `motorcade_choose_kernels` (core/instruction_set.cpp) turns the pointers to `F.v3` where the processor has AVX2. What a version's objects hold
# of inline functions stays within it: those of the second must never serve the rest of the program.
set -euo pipefail
LD=${LD:-ld} OBJCOPY=${OBJCOPY:-objcopy} NM=${NM:-nm} READELF=${READELF:-readelf} CXX=${CXX:-g++}

out=$1 && shift
any=()
while [[ $1 != -- ]]; do any+=("$1") && shift; done
shift
work=$(mktemp -d "$out.XXXXXX")
trap 'rm -rf "$work"' EXIT

# Groups of inline functions would be merged with those of the rest by name, whatever they are compiled for.
"$LD" -r -o "$work/any_merged.o" "${any[@]}"
"$LD" -r --force-group-allocation -o "$work/v3_merged.o" "$@"

# Initializers would run before anything is chosen.
if "$READELF" -SW "$work/v3_merged.o" | grep -q '\.init_array'; then
  echo "tools/dispatch_kernels.sh: kernels must not have objects that are initialized at start" >&2
  exit 1
fi
"$NM" -g --defined-only "$work/any_merged.o" | awk '$2 == "T" { print $3 }' | sort >"$work/functions"
"$NM" -g --defined-only "$work/v3_merged.o" | awk '$2 ~ /^[BDGRS]$/ { print $3 }' >"$work/variables"
if [[ -s $work/variables ]]; then
  echo "tools/dispatch_kernels.sh: kernels must not define variables for others: $(tr '\n' ' ' <"$work/variables")" >&2
  exit 1
fi

for version in any v3; do
  awk -v version=$version '{ print $1, $1 "." version }' "$work/functions" >"$work/$version.names"
  "$OBJCOPY" --redefine-syms="$work/$version.names" "$work/${version}_merged.o" "$work/$version.o"
done
awk '{ print $1 ".v3" }' "$work/functions" >"$work/kept"
"$OBJCOPY" --keep-global-symbols="$work/kept" "$work/v3.o"

awk '
  { name[NR] = $1 }
  END {
    print "\t.text"
    for (i = 1; i <= NR; ++i) {
      print "\t.globl " name[i] "\n\t.hidden " name[i] "\n\t.type " name[i] ", @function\n\t.p2align 4"
      print name[i] ":\n\tendbr64\n\tjmp *chosen+" 8 * (i - 1) "(%rip)\n\t.size " name[i] ", .-" name[i]
      print "\t.hidden " name[i] ".any\n\t.hidden " name[i] ".v3"
    }
    print "\t.section .data.rel.local,\"aw\"\n\t.p2align 3\nchosen:"
    for (i = 1; i <= NR; ++i) print "\t.quad " name[i] ".any"
    print "\t.section .data.rel.ro.local,\"aw\"\n\t.p2align 3\nv3:"
    for (i = 1; i <= NR; ++i) print "\t.quad " name[i] ".v3"
    # Among the first initializers.
    print "\t.section .init_array.00101,\"aw\",@init_array\n\t.p2align 3\n\t.quad choose"
    print "\t.text\n\t.type choose, @function\nchoose:\n\tendbr64"
    print "\tleaq chosen(%rip), %rdi\n\tleaq v3(%rip), %rsi\n\tmovl $" NR ", %edx\n\tjmp motorcade_choose_kernels"
    print "\t.hidden motorcade_choose_kernels\n\t.size choose, .-choose"
    print "\t.section .note.GNU-stack,\"\",@progbits"
  }' "$work/functions" >"$work/jumps.s"
"$CXX" -c -o "$work/jumps.o" "$work/jumps.s"
"$LD" -r -o "$work/out.o" "$work/jumps.o" "$work/any.o" "$work/v3.o"
mv "$work/out.o" "$out"
