#!/bin/sh
# Run the tests: `test.sh quick` those that may run in parallel, and `test.sh slow` the
# rest; more arguments go to pytest. The kernel is compiled first. What calls it then
# runs twice, compiled and interpreted; everything else runs with the compiled kernel.
# Without a C compiler, which is said, everything runs interpreted, once.
set -eu
cd "$(dirname "$0")/.."

python=.venv/bin/python
which=$1
shift

say() { echo "test: $*" >&2; }

unset STATION_COMPILED
"$python" -m station.kernel.build --optional >/dev/null
if "$python" -c 'import sys, station.kernel; sys.exit(not station.kernel.STATUS.is_compiled)'; then
    export STATION_COMPILED=1
else
    say "the kernel is not compiled here: the tests run interpreted alone"
fi

case $which in
quick)
    "$python" -m pytest -n auto -m "not slow and not alone" "$@"
    "$python" -m pytest -m "alone and not slow" "$@"
    if [ -n "${STATION_COMPILED:-}" ]; then
        say "once more, interpreted: what calls the kernel"
        [ $# -gt 0 ] || set -- tests/core tests/hw tests/controllers tests/kernel tests/conformance
        STATION_COMPILED=0 "$python" -m pytest -n auto -m "not slow and not alone" "$@"
    fi
    ;;
slow)
    # Some of these measure times, and a busy neighbour is no defect of what they test:
    # what fails beside others has to pass alone.
    "$python" -m pytest -n auto -m slow "$@" && exit 0
    say "once more, one after the other: what failed"
    "$python" -m pytest -m slow --last-failed --last-failed-no-failures none "$@"
    ;;
*) say "quick or slow, not $which" && exit 2 ;;
esac
