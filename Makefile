# The only list of commands. The environment is made once for each state of the files that describe it.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SETUP := requirements-dev.txt pyproject.toml setup.py $(wildcard backend/treestroke/core/*/*.c)
STAMP := $(VENV)/ready-$(shell cat $(SETUP) | sha256sum | cut -c1-16)
NODE := frontend/node_modules
NODE_STAMP := $(NODE)/.ready-$(shell cat frontend/package.json frontend/package-lock.json | sha256sum | cut -c1-16)
PAGE := backend/treestroke/api/page
PAGE_SOURCES := $(shell find frontend examples -type f -not -path '*/node_modules/*' -not -path 'frontend/test/*')
PAGE_STAMP := $(PAGE)/.built-$(shell sha256sum $(PAGE_SOURCES) | sort | sha256sum | cut -c1-16)
SCHEMA := frontend/src/api/schema.d.ts
DEFAULTS := frontend/src/api/defaults.ts
PYTEST = $(BIN)/python -m pytest -q --ignore=tests/benchmarks -p no:benchmark --durations=15
EXAMPLE ?= burr_oak_dusk
PORT ?= 8000

# Whatever the system's habit is: to compile Python anew for each of the service's processes takes seconds.
unexport PYTHONDONTWRITEBYTECODE
export PYTHONPYCACHEPREFIX := $(CURDIR)/$(VENV)/bytecode

.PHONY: run page test redis postgres chromium check types pictures bench golden nightly readers usd chaos soak setup
.DEFAULT_GOAL := run

# Models an example, then serves until Ctrl+C (or SIGTERM): its last line names the page.
run: $(STAMP) page
	@mkdir -p out
	@$(BIN)/treestroke model examples/$(EXAMPLE).jpg --strokes examples/$(EXAMPLE).strokes.json \
	    --out out/$(EXAMPLE).glb --report out/$(EXAMPLE).json --preview out/$(EXAMPLE).png
	@echo "out/$(EXAMPLE).glb: the tree; out/$(EXAMPLE).png: its picture; out/$(EXAMPLE).json: its report"
	@exec $(BIN)/treestroke serve --data out/serve --port $(PORT)

# The page as the service serves it, made of frontend/.
page: $(PAGE_STAMP)

test: $(STAMP) page redis postgres chromium
	@cd frontend && node_modules/.bin/vitest run
	@$(PYTEST) -m "not golden and not nightly and not browser and not readers" -n 4 --dist loadfile --no-loadscope-reorder
	@$(PYTEST) -m browser -n 2 --dist loadfile

# Tests need a Redis and a Postgres to start and kill, and a browser. CI installs what is missing; elsewhere tests say so.
redis:
	@$(call installed,redis-server,redis-server)

postgres:
	@$(call installed,/usr/lib/postgresql/*/bin/postgres,postgresql)

chromium:
	@$(call installed,chromium,chromium fonts-dejavu-core)

installed = command -v $(1) >/dev/null || [ "$(CI)" != true ] || [ "$$(id -u)" != 0 ] || ! command -v apt-get >/dev/null || { \
    export DEBIAN_FRONTEND=noninteractive RUNLEVEL=1; \
    apt-get update -qq && apt-get install -qq --yes --no-install-recommends $(2) >/dev/null; }

check: $(STAMP) $(NODE_STAMP)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	cd frontend && node_modules/.bin/tsc
	cd frontend && node_modules/.bin/biome ci .
	@$(schema) | cmp -s - $(SCHEMA) || { echo "make: $(SCHEMA) is not what the API says; run \`make types\`" >&2; exit 1; }
	@$(defaults) | cmp -s - $(DEFAULTS) || { echo "make: $(DEFAULTS) is not what the API says; run \`make types\`" >&2; exit 1; }

# What the API takes and gives, as types for the page, and its default settings.
types: $(STAMP) $(NODE_STAMP)
	@$(schema) > $(SCHEMA).new && mv $(SCHEMA).new $(SCHEMA)
	@$(defaults) > $(DEFAULTS).new && mv $(DEFAULTS).new $(DEFAULTS)

schema = $(BIN)/python frontend/openapi.py | $(NODE)/.bin/openapi-typescript
defaults = $(BIN)/python frontend/openapi.py defaults

# The pictures in docs/images that show the page, and the README's first one, by the page as it is.
pictures: $(STAMP) page chromium
	$(BIN)/python -m docs.pictures

bench: $(STAMP) page
	$(BIN)/python -m pytest -q tests/benchmarks --benchmark-only --benchmark-columns=min,median,max,rounds \
	    --benchmark-sort=fullname
	@$(BIN)/python -m tests.benchmarks.service_times
	@$(BIN)/python -m tests.benchmarks.stream_times
	@$(BIN)/python -m tests.benchmarks.hosted_times
	@$(BIN)/python -m tests.benchmarks.store_times
	@$(BIN)/python -m tests.benchmarks.page_times
	@$(BIN)/python -m tests.benchmarks.files_table
	@$(BIN)/python -m tests.benchmarks.growth_ratio

# One test at a time, for a quiet machine: what only repeats, and what is promised in seconds.
nightly: $(STAMP) page redis postgres
	@$(PYTEST) --promises -m "not golden and not browser and not readers"

golden: $(STAMP)
	$(BIN)/python -m pytest -q -m golden

# Every format in readers that are not ours: three.js in Chromium, Blender and OpenUSD, each in an environment of its own.
readers: $(STAMP) page chromium .venv-bpy/ready .venv-usd/ready
	@$(PYTEST) -m readers

.venv-bpy/ready: tests/readers/requirements-blender.txt
.venv-usd/ready: requirements-usd.txt
.venv-bpy/ready .venv-usd/ready:
	@$(PYTHON) -m venv $(@D)
	@$(@D)/bin/pip install --quiet --disable-pip-version-check --require-hashes -r $<
	@touch $@

# What USDZ needs, which is large and optional.
usd: $(STAMP)
	@$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes -r requirements-usd.txt

# Jobs come in while everything breaks: workers on one machine for three minutes; then two web processes, three workers,
# Redis, Postgres and S3. No job may be lost or made twice.
chaos: $(STAMP) redis postgres
	$(BIN)/python -m tests.faults.chaos
	$(BIN)/python -m tests.chaos --seed 1
	$(BIN)/python -m tests.chaos --seed 2

# An hour of mixed load on the same, and what its processes take meanwhile.
soak: $(STAMP) redis postgres
	$(BIN)/python -m tests.chaos.soak

setup: $(STAMP)

$(STAMP):
	@test -x $(BIN)/pip || $(PYTHON) -m venv $(VENV) || { rm -rf $(VENV); \
	    echo "make: no virtual environment could be made; on Debian and Ubuntu install python3-venv, elsewhere" \
	         "name a Python 3.11 or later: make PYTHON=/path/to/python3" >&2; exit 1; }
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes -r requirements-dev.txt
	$(BIN)/pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	@rm -f $(VENV)/ready-*
	@touch $@

$(NODE_STAMP):
	@node -e "const [a, b] = process.versions.node.split('.').map(Number); process.exit(a > 20 || (a === 20 && b > 18) ? 0 : 1)" \
	    2>/dev/null && command -v npm >/dev/null || { \
	    echo "make: the page is built with Node.js 20.19 or later and npm; install them (Debian 13 has nodejs and" \
	         "npm). The service alone needs neither: make setup, then .venv/bin/treestroke serve" >&2; exit 1; }
	cd frontend && npm ci --loglevel=error
	@touch $@

# Vite empties the folder first, of older stamps too.
$(PAGE_STAMP): $(NODE_STAMP)
	cd frontend && node_modules/.bin/vite build --logLevel warn
	@touch $@
