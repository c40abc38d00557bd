#!/usr/bin/env bash
# Tests that the documents' code is that of the examples, which are compiled and run: snippets_test.sh DOCUMENT...
# Each fenced block in C, C++ or Python follows a comment with its file, <!-- examples/embed/main.cpp -->, and occurs in it literally.
set -euo pipefail
cd "$(dirname "$0")/../.."

awk '
  function complain(what) { print FILENAME ":" FNR ": " what; failed = 1 }
  function contentOf(name,   line, text) {
    text = ""
    while ((getline line < name) > 0) text = text line "\n"
    close(name)
    return text
  }
  FNR == 1 { if (inside) complain("the block before is not closed"); inside = 0; source = "" }
  inside && /^```/ {
    inside = 0; ++blocks
    content = contentOf(source)
    if (content == "") complain(source " is no file, or empty")
    else if (index(content, block) == 0) complain("the block above is not to be found in " source)
    source = ""
    next
  }
  inside { block = block $0 "\n"; next }
  /^ *```(cpp|c|c\+\+|cxx|python|py)$/ {
    if (source == "") complain("a comment with its file is missing before this block: <!-- examples/... -->")
    else if (/^ /) complain("the block is indented, and so not literally in its file")
    else { inside = 1; block = "" }
    next
  }
  /^<!-- [^ ]+ -->$/ { source = $2; next }
  /[^ ]/ { source = "" }
  END {
    if (inside) complain("the last block is not closed")
    if (!blocks) { print "there is no block to check"; failed = 1 }
    print blocks + 0 " blocks are what their files say"
    exit failed
  }' "$@"
