# The only list of commands. The environment is made once for each state of the files that describe it.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SETUP := requirements-dev.txt pyproject.toml setup.py $(wildcard backend/treestroke/core/grow/*.c)
STAMP := $(VENV)/ready-$(shell cat $(SETUP) | sha256sum | cut -c1-16)
EXAMPLE ?= burr_oak_dusk

.PHONY: run test check bench golden setup
.DEFAULT_GOAL := run

run: $(STAMP)
	@mkdir -p out
	@$(BIN)/treestroke model examples/$(EXAMPLE).jpg --strokes examples/$(EXAMPLE).strokes.json \
	    --out out/$(EXAMPLE).glb --report out/$(EXAMPLE).json --preview out/$(EXAMPLE).png
	@echo "out/$(EXAMPLE).glb: the tree; out/$(EXAMPLE).png: its picture; out/$(EXAMPLE).json: its report"

test: $(STAMP)
	@$(BIN)/python -m pytest -q -m "not golden" --benchmark-skip

check: $(STAMP)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: $(STAMP)
	$(BIN)/python -m pytest -q tests/benchmarks --benchmark-only --benchmark-columns=min,median,max,rounds \
	    --benchmark-sort=fullname
	@$(BIN)/python -m tests.benchmarks.growth_ratio

golden: $(STAMP)
	$(BIN)/python -m pytest -q -m golden

setup: $(STAMP)

$(STAMP):
	@test -x $(BIN)/pip || $(PYTHON) -m venv $(VENV) || { rm -rf $(VENV); \
	    echo "make: no virtual environment could be made; on Debian and Ubuntu install python3-venv, elsewhere" \
	         "name a Python 3.11 or later: make PYTHON=/path/to/python3" >&2; exit 1; }
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes -r requirements-dev.txt
	$(BIN)/pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	@rm -f $(VENV)/ready-*
	@touch $@
