#!/usr/bin/env bash
# Manual pages of the program and of each of its commands, from their help: make_pages.sh MOTORCADE FOLDER
set -euo pipefail
motorcade=$1 pages=$2 room=$(dirname "$0")
export LC_ALL=C.UTF-8
mkdir -p "$pages"

# Makes programs of the pages' names, so that no page names the folder of a build. A list within an option's text gets its stops.
calls=$(mktemp -d)
trap 'rm -rf "$calls"' EXIT
call() {
  printf '#!/bin/sh\n"%s" %s "$@" | sed "s/^ \\{32\\}.*/&;/"\n' "$(realpath "$motorcade")" "$2" >"$calls/$1"
  chmod +x "$calls/$1"
}
version=$("$motorcade" --version | sed -n '1s/^motorcade //p')

# page NAME COMMAND PURPOSE
page() {
  call "$1" "$2"
  help2man --no-info --version-string="$version" --source="Motorcade $version" --name="$3" \
    --include="$room/common.h2m" --output="$pages/$1.1" "$calls/$1"
}

# commands_of WORDS: the commands behind them, one per line
commands_of() {
  # shellcheck disable=SC2086
  "$motorcade" $1 --help | sed -n '/^Subcommands:/,$ s/^  \([a-z]\{1,\}\) .*/\1/p' | grep -vx help || true
}

# pages_of WORDS: pages of the commands behind them, and of their subcommands
pages_of() {
  local command purpose
  for command in $(commands_of "$1"); do
    # shellcheck disable=SC2086
    purpose=$("$motorcade" $1 "$command" --help | sed -n 1p)
    page "motorcade${1:+-${1// /-}}-$command" "${1:+$1 }$command" "${purpose,}"
    pages_of "${1:+$1 }$command"
  done
}

page motorcade "" "follow a car and the vehicles around it from a stereo camera"
pages_of ""
gzip -9nkf "$pages"/*.1  # as they are installed
