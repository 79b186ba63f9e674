#!/usr/bin/env bash
# The load tests on an instrumented server: builds the preset asan or tsan and runs load.test.mjs against it. Exit status 0:
# every part passed and nothing was reported. Reports are shown, and left in build/PRESET/reports/.
#   tests/load/sanitized.sh asan|tsan [options of load.test.mjs; default: --quick]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

preset="${1:?asan or tsan}"
shift
[ "$#" -gt 0 ] || set -- --quick

cmake --preset "$preset"
cmake --build --preset "$preset" --target chamferd chamferprep

reports="$PWD/build/$preset/reports"
rm -rf "$reports"
mkdir -p "$reports"
export ASAN_OPTIONS="log_path=$reports/report:detect_leaks=1"
export UBSAN_OPTIONS="log_path=$reports/report:print_stacktrace=1"
export TSAN_OPTIONS="log_path=$reports/report:suppressions=$PWD/tests/load/tsan.supp:history_size=4"
status=0
node tests/load/load.test.mjs --chamferd "build/$preset/server/chamferd" --chamferprep "build/$preset/preprocess/chamferprep" \
  --data data --instrumented "$@" || status=1
for report in "$reports"/*; do
  [ -e "$report" ] || continue
  head -n 200 "$report"
  status=1
done
exit "$status"
