#!/bin/sh
# Run the tests: `test.sh quick` those that need no more than this process, and `test.sh
# slow` the rest; more arguments go to pytest. The extensions are compiled first. What
# reaches them then runs twice, compiled and interpreted; everything else runs compiled.
# Without a C compiler, which is said, everything runs interpreted, once.
set -eu
cd "$(dirname "$0")/.."

python=.venv/bin/python
which=$1
shift

say() { echo "test: $*" >&2; }

# Some tests run against the clock, and a busy machine is no defect of what they test:
# what fails the first time has to pass alone.
patiently() {
    marks=$1 workers=$2
    shift 2
    "$python" -m pytest -n "$workers" -m "$marks" "$@" && return
    [ $? -eq 5 ] && return  # there is none of these tests among those asked for
    say "once more, one after the other: what failed"
    "$python" -m pytest -m "$marks" --last-failed --last-failed-no-failures none "$@"
}

# To read all tests takes every worker ten seconds: for a mark that few have, only the
# files are read that have it. tests/conftest.py marks folders as a whole.
files_with() {
    mark=$1
    shift
    echo "$@"
    grep -rl --include='test_*.py' "mark\.$mark" tests
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
    # Tests that run alone wait most of the time: two leave each other the processor.
    if [ $# -gt 0 ]; then
        patiently "not slow and not alone" auto "$@"
        patiently "alone and not slow" 2 --dist loadfile "$@"
    else
        patiently "not slow and not alone" auto tests --ignore tests/browser --ignore tests/system
        # shellcheck disable=SC2046 - one word for each file
        patiently "alone and not slow" 2 --dist loadfile $(files_with alone tests/ui)
    fi
    if [ -n "${STATION_COMPILED:-}" ]; then
        say "once more, interpreted: what reaches compiled modules"
        [ $# -gt 0 ] || set -- tests/core tests/hw tests/controllers tests/memory tests/conformance
        export STATION_COMPILED=0
        patiently "not slow and not alone" auto --reaching-compiled "$@"
    fi
    ;;
slow)
    # A file is run by one worker: its stations and pages are started once. One worker
    # more than processors takes longer. tests/conftest.py has the order.
    # shellcheck disable=SC2046
    [ $# -gt 0 ] || set -- $(files_with slow tests/browser tests/system)
    patiently slow auto --dist loadfile --no-loadscope-reorder "$@"
    ;;
*) say "quick or slow, not $which" && exit 2 ;;
esac
