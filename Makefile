# The only list of commands. The environment is made once for each state of the files that describe it.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SETUP := requirements-dev.txt pyproject.toml setup.py $(wildcard backend/treestroke/core/grow/*.c)
STAMP := $(VENV)/ready-$(shell cat $(SETUP) | sha256sum | cut -c1-16)
PYTEST = $(BIN)/python -m pytest -q --ignore=tests/benchmarks -p no:benchmark
EXAMPLE ?= burr_oak_dusk
PORT ?= 8000

.PHONY: run test redis check bench golden chaos setup
.DEFAULT_GOAL := run

# Models an example, then serves until Ctrl+C (or SIGTERM): its last line names the page.
run: $(STAMP)
	@mkdir -p out
	@$(BIN)/treestroke model examples/$(EXAMPLE).jpg --strokes examples/$(EXAMPLE).strokes.json \
	    --out out/$(EXAMPLE).glb --report out/$(EXAMPLE).json --preview out/$(EXAMPLE).png
	@echo "out/$(EXAMPLE).glb: the tree; out/$(EXAMPLE).png: its picture; out/$(EXAMPLE).json: its report"
	@exec $(BIN)/treestroke serve --data out/serve --port $(PORT)

test: $(STAMP) redis
	@$(PYTEST) -m "not golden and not alone" -n 3 --dist loadfile
	@$(PYTEST) -m alone

# Tests of the queue need a Redis to start and kill. CI installs one where there is none; elsewhere the tests say so.
redis:
	@command -v redis-server >/dev/null || [ "$(CI)" != true ] || [ "$$(id -u)" != 0 ] || ! command -v apt-get >/dev/null || { \
	    export DEBIAN_FRONTEND=noninteractive RUNLEVEL=1; \
	    apt-get update -qq && apt-get install -qq --yes --no-install-recommends redis-server >/dev/null; }

check: $(STAMP)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: $(STAMP)
	$(BIN)/python -m pytest -q tests/benchmarks --benchmark-only --benchmark-columns=min,median,max,rounds \
	    --benchmark-sort=fullname
	@$(BIN)/python -m tests.benchmarks.service_times
	@$(BIN)/python -m tests.benchmarks.growth_ratio

golden: $(STAMP)
	$(BIN)/python -m pytest -q -m golden

# Three minutes a broker: workers are killed at random while 200 jobs come in. No job may be lost or made twice.
chaos: $(STAMP)
	$(BIN)/python -m tests.faults.chaos --broker files
	$(BIN)/python -m tests.faults.chaos --broker redis

setup: $(STAMP)

$(STAMP):
	@test -x $(BIN)/pip || $(PYTHON) -m venv $(VENV) || { rm -rf $(VENV); \
	    echo "make: no virtual environment could be made; on Debian and Ubuntu install python3-venv, elsewhere" \
	         "name a Python 3.11 or later: make PYTHON=/path/to/python3" >&2; exit 1; }
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes -r requirements-dev.txt
	$(BIN)/pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	@rm -f $(VENV)/ready-*
	@touch $@
