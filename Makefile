# The station's one-word commands. Each prepares .venv first when it has to; `make run`
# and `make bench` leave out what only the tests need.
#
#   make run    the station; ARGS="--rate 500" are handed on to `station run`
#   make test   all that CI runs      make check   without the slow and browser tests
#   make test-long  runs what takes longest, before a release; docs/testing.md says more
#   make setup  only prepares .venv   make lock    after a change of dependencies
#   make bench  the benchmarks        make clean   removes all that can be made again
#   make performance  measures anew and writes the tables of docs/performance.md
#   make compile  compiles the control cycle now; `make run` does it beside the station
#   make client  writes the reference of the client in docs/client.md, and the notebook

# What `make static` checks, two at a time, and what takes longest first.
CHECKS := mypy imports ruff format client-page notebook import-rules page-modules subjects

.DEFAULT_GOAL := help
.PHONY: help setup run compile compile-if-possible browser test test-long check static client lock bench \
	performance clean $(CHECKS:%=static-%)

ARGS ?=
PYTEST_ARGS ?=
READY := .venv/.ready
READY_DEV := .venv/.ready-dev
SETUP := pyproject.toml requirements.lock requirements-dev.lock tools/setup.sh tools/fetch_pip.py

help:
	@sed -n '/^#/!q; s/^# \{0,1\}//p' Makefile

setup: $(READY_DEV)

$(READY): $(SETUP)
	@sh tools/setup.sh
	@touch $@

$(READY_DEV): $(SETUP)
	@sh tools/setup.sh dev
	@touch $(READY) $@

run: $(READY)
	@exec .venv/bin/station run $(ARGS)

compile: $(READY)
	@STATION_COMPILED=1 .venv/bin/python setup.py --quiet build_ext --inplace

# For the tests, which run interpreted where no compiler is.
compile-if-possible: $(READY_DEV)
	@STATION_COMPILED= .venv/bin/python setup.py --quiet build_ext --inplace >/dev/null

browser:
	@sh tools/browser.sh

static: $(READY_DEV)
	@$(MAKE) --no-print-directory -j2 $(CHECKS:%=static-%)

static-mypy:
	.venv/bin/mypy
static-imports:
	.venv/bin/lint-imports --no-logo
static-ruff:
	.venv/bin/ruff check .
static-format:
	.venv/bin/ruff format --check .
static-client-page:
	.venv/bin/python tools/client_page.py --check
static-notebook:
	.venv/bin/python tools/generate_notebook.py --check
static-import-rules:
	.venv/bin/python tools/import_rules.py --check
static-page-modules:
	.venv/bin/python tools/page_modules.py --check
static-subjects:
	.venv/bin/python tools/check_subjects.py

client: $(READY_DEV)
	.venv/bin/python tools/client_page.py
	.venv/bin/python tools/page_modules.py
	.venv/bin/python tools/import_rules.py
	.venv/bin/python tools/generate_notebook.py

check: static compile-if-possible
	@sh tools/test.sh quick $(PYTEST_ARGS)

test: check browser
	@sh tools/test.sh interpreted $(PYTEST_ARGS)
	@sh tools/test.sh slow $(PYTEST_ARGS)

test-long: compile-if-possible browser
	@sh tools/test.sh interpreted tests/conformance
	@sh tools/test.sh long $(PYTEST_ARGS)

lock: EXPORT := --quiet --no-config --locked --no-emit-project
lock: $(READY_DEV)
	.venv/bin/uv lock --no-config $(ARGS)
	.venv/bin/uv export $(EXPORT) --no-dev --group build --extra all --output-file requirements.lock
	.venv/bin/uv export $(EXPORT) --all-extras --output-file requirements-dev.lock

bench: $(READY)
	@set -e; for script in benchmarks/bench_*.py; do echo "$$script"; .venv/bin/python "$$script"; done

performance: $(READY_DEV) compile
	.venv/bin/python benchmarks/write_tables.py $(ARGS)

clean:
	find station -name '*.so' -delete
	rm -rf station/compiled.*.json .venv .mypy_cache .ruff_cache .pytest_cache .import_linter_cache .hypothesis artifacts build dist
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
