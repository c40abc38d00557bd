#!/usr/bin/env bash
# What takes too long for every change: clang-tidy on every source, all tests under the sanitizers, the portable build's results.
set -euo pipefail
cd "$(dirname "$0")/.."

.ci/lint --all
tests/run.sh
tests/run.sh --asan
tests/run.sh --tsan
perf/portable.sh
