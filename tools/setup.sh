#!/bin/sh
# Prepare .venv: the packages of requirements.lock, each checked against its hash, and
# the station itself as an editable install. `setup.sh dev` takes requirements-dev.lock,
# which has the packages of the tests, too. Safe to repeat; quick when nothing changed.
#
# Needs Python 3.11 to 3.14 and the network; nothing else. uv is used when it is there or
# can be installed into .venv, pip otherwise. PYTHON=... chooses the interpreter.
set -eu
cd "$(dirname "$0")/.."

SUPPORTED='import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 14))'
venv_python=.venv/bin/python

say() { echo "setup: $*" >&2; }

# Print the interpreter to build .venv with; fail when there is none that fits.
# A name on PATH may be a launcher that fails, so each candidate is asked to run.
find_python() {
    for candidate in ${PYTHON:-python3 python3.14 python3.13 python3.12 python3.11}; do
        if "$candidate" -c "$SUPPORTED" 2>/dev/null; then
            "$candidate" -c 'import sys; print(getattr(sys, "_base_executable", sys.executable))'
            return
        fi
    done
    return 1
}

create_venv() {
    rm -rf .venv
    if python=$(find_python); then
        say "creating .venv with $("$python" --version)"
        "$python" -m venv --without-pip .venv
    elif [ -z "${PYTHON:-}" ] && uv --version >/dev/null 2>&1; then
        say "no Python 3.11 to 3.14 on PATH: uv provides one"
        uv venv --quiet --no-project --python '>=3.11,<3.15' .venv
    else
        say "no Python 3.11, 3.12, 3.13 or 3.14 among: ${PYTHON:-python3 and python3.11 to python3.14 on PATH}."
        say "Install one (Debian, Ubuntu: apt-get install python3), or name one: make setup PYTHON=/path/to/python3"
        exit 1
    fi
}

# Make pip available in .venv, also where the distribution ships Python without it.
ensure_pip() {
    "$venv_python" -m pip --version >/dev/null 2>&1 ||
        "$venv_python" -m ensurepip >/dev/null 2>&1 ||
        "$venv_python" tools/fetch_pip.py
}

# Print a Python that has pip: the one .venv was made with, because a pip of its own takes
# longer to install than all the packages; that of .venv where there is no other.
find_pip() {
    base=$("$venv_python" -c 'import sys; print(sys._base_executable)')
    if "$base" -m pip --version >/dev/null 2>&1; then
        echo "$base"
    else
        ensure_pip >&2 && echo "$venv_python"
    fi
}

# Print the uv to work with: the machine's, that of the development tools, or the locked
# one, which is put aside and deleted afterwards: the station does without its 39 MB.
find_uv() {
    if uv --version >/dev/null 2>&1; then
        echo uv
        return
    fi
    if [ "$lock" = requirements-dev.lock ] && .venv/bin/uv --version >/dev/null 2>&1; then
        echo .venv/bin/uv
        return
    fi
    pip_python=$(find_pip) || return 1
    awk '/^[^ #]/ { keep = /^uv==/ } keep' requirements-dev.lock >.venv/uv-requirement.txt
    PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_ROOT_USER_ACTION=ignore \
        "$pip_python" -m pip install --quiet --require-hashes --only-binary :all: \
        --no-deps --no-compile --target "$aside" -r .venv/uv-requirement.txt >&2 || return 1
    echo "$aside/bin/uv"
}

install_with_uv() {
    "$1" pip sync --quiet --python "$venv_python" --require-hashes "$lock" &&
        "$1" pip install --quiet --python "$venv_python" --no-deps --no-build-isolation \
            --config-settings editable_mode=compat --editable .
}

install_with_pip() {
    ensure_pip
    "$venv_python" -m pip install --quiet --require-hashes -r "$lock"
    "$venv_python" -m pip install --quiet --no-deps --no-build-isolation \
            --config-settings editable_mode=compat --editable .
}

"$venv_python" -c "$SUPPORTED" 2>/dev/null || create_venv
aside=.venv/uv-for-setup
trap 'rm -rf "$aside"' EXIT
lock=requirements.lock
# What the tests need stays where it once was asked for.
if [ "${1:-}" = dev ] || [ -e .venv/.ready-dev ]; then
    lock=requirements-dev.lock
fi
say "installing the packages of $lock"
if ! { uv=$(find_uv) && install_with_uv "$uv"; }; then
    say "uv did not do it: going on with pip, which takes a few minutes"
    install_with_pip
fi
say "done: .venv/bin/station"
