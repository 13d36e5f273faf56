#!/bin/sh
# Run the tests: `test.sh quick` those that need no more than this process, `test.sh slow`
# those with a browser or whole processes, and `test.sh long` the rest, which no run of all
# tests has the time for; more arguments go to pytest. The extensions are compiled first.
# `test.sh interpreted` runs once more, interpreted, what reaches them; `quick` and `slow`
# run compiled. Without a C compiler, which is said, they run interpreted instead.
set -eu
cd "$(dirname "$0")/.."

python=.venv/bin/python
which=$1
shift

say() { echo "test: $*" >&2; }

# None of the marked tests may be among those asked for.
run() {
    marks=$1 workers=$2
    shift 2
    "$python" -m pytest -n "$workers" -m "$marks" "$@" || [ $? -eq 5 ]
}

# Some tests run against the clock, and a busy machine is no defect of what they test:
# what fails the first time has to pass alone.
patiently() {
    run "$@" && return
    marks=$1
    shift 2
    say "once more, one after the other: what failed"
    "$python" -m pytest -m "$marks" --last-failed --last-failed-no-failures none "$@"
}

# Each worker and each station imports some thousand modules: Python keeps what it has
# compiled of them, even where the environment says otherwise.
unset STATION_COMPILED PYTHONDONTWRITEBYTECODE
"$python" setup.py --quiet build_ext --inplace >/dev/null
if "$python" -c 'import sys, station.compiled as c; sys.exit(not c.status().is_compiled)'; then
    export STATION_COMPILED=1
else
    say "nothing is compiled here: the tests run interpreted alone"
fi

case $which in
quick)
    [ $# -gt 0 ] || set -- tests --ignore tests/browser --ignore tests/system
    run "not slow and not alone and not long" auto "$@"
    # Tests that run alone wait most of the time: two leave each other the processor.
    run "alone and not slow and not long" 2 --dist loadfile --marked alone "$@"
    ;;
interpreted)
    [ -n "${STATION_COMPILED:-}" ] || exit 0
    [ $# -gt 0 ] || set -- tests/core tests/hw tests/controllers tests/memory
    export STATION_COMPILED=0
    run "not slow and not alone and not long" auto --reaching-compiled "$@"
    ;;
slow)
    # A file is run by one worker: its stations and pages are started once. One worker
    # more than processors takes longer. tests/conftest.py has the order.
    [ $# -gt 0 ] || set -- tests
    patiently "slow and not long" auto --dist loadfile --no-loadscope-reorder --marked slow "$@"
    ;;
long)
    [ $# -gt 0 ] || set -- tests
    patiently long auto --dist loadfile --no-loadscope-reorder --marked long "$@"
    ;;
*) say "quick, interpreted, slow or long, not $which" && exit 2 ;;
esac
