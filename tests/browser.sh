#!/usr/bin/env bash
# Looks at the pages in a headless Chromium: each tests/browser/*_test.js, with the program of the release build. Where no
# browser can be had, it prints one line and does nothing.
#   tests/browser.sh [FOLDER]   also writes screenshots there
# MOTORCADE_PROGRAM and CHROMIUM name another program and browser, MOTORCADE_TESTS a pattern of the tests to do, MOTORCADE_PATIENCE_MS how long
# a page may take on a busy machine.
set -euo pipefail
cd "$(dirname "$0")/.."
export MOTORCADE_PROGRAM=${MOTORCADE_PROGRAM:-$PWD/build/release/apps/motorcade}
export CHROMIUM=${CHROMIUM:-/usr/bin/chromium}
export MOTORCADE_SCREENSHOTS=${1:+$(mkdir -p "$1" && realpath "$1")}

skip() { echo "tests/browser.sh: the pages are not looked at: $1"; exit 0; }
[[ -x $MOTORCADE_PROGRAM ]] || { echo "tests/browser.sh: no $MOTORCADE_PROGRAM; build it first: tests/run.sh" >&2; exit 2; }
[[ -x $CHROMIUM ]] || apps/setup.sh chromium >/dev/null 2>&1 || skip "Chromium cannot be installed"
[[ -x $CHROMIUM ]] || skip "there is no $CHROMIUM"
command -v node >/dev/null && command -v npm >/dev/null || apps/setup.sh nodejs npm >/dev/null 2>&1 || skip "Node.js cannot be installed"
node -e "process.exit(parseInt(process.versions.node) < 18 ? 1 : 0)" || skip "playwright-core needs Node.js 18, this is $(node --version)"
if [[ ! -d tests/browser/node_modules/playwright-core ]]; then
  (cd tests/browser && timeout 120 npm ci --no-audit --no-fund --silent >/dev/null 2>&1) || skip "npm cannot install playwright-core"
fi

status=0
for test in tests/browser/*_test.js; do
  timeout 600 node "$test" || status=1
done
exit $status
