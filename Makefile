# Everything except test-with runs in .venv, which these targets create and keep up to date.
PYTHON ?= python3
BIN := .venv/bin
# What is imported is compiled then, and kept; to compile all 20,000 files would take a minute more.
QUICKLY := --quiet --disable-pip-version-check --no-compile
# The environment of make test-with, created anew each time.
OTHER ?= .venv-other
RELEASES ?=
PART ?= tests/engine tests/platform
EXTRA ?= tests
# What Python runs the tests with: .ci/tests runs those that failed once more.
PYTEST ?= -m pytest
# The TypeScript of the page that draws matches.
VIEWER := platform/wildscav_stage/viewer
NPM := $(VIEWER)/node_modules/.package-lock.json
BUILT := platform/wildscav_stage/static/viewer/viewer.js
BENCHMARKS := speed.compile speed.environments speed.legacy speed.maps speed.processes speed.rays speed.steps \
	speed.vector_sensors \
	services.executor services.server services.service strength.ratings
.DEFAULT_GOAL := help
# Without its cache of bytecode, each process of ours would compile the sources again, for up to three seconds.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help demo test test-slow test-with test-oldest test-newest test-openenv check format bench docs docs-serve viewer wheel release proto clean

help: ## Show this list.
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## (.*)/  make \1|\2/' | column -t -s '|'

.venv/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "Wildscav needs Python 3.11 or newer; name one with: make PYTHON=python3.12 …"; exit 2; }
	$(PYTHON) -m venv .venv

.venv/.run: pyproject.toml | .venv/bin/python
	@echo 'Installing Wildscav and its dependencies into .venv: 1.5 GB, which takes a minute or two without output.'
	$(BIN)/python -m pip install $(QUICKLY) -e '.[all]'
	@touch $@

.venv/.dev: pyproject.toml | .venv/bin/python
	@echo 'Installing Wildscav and its development tools into .venv, which takes a few minutes without output.'
	$(BIN)/python -m pip install $(QUICKLY) -e '.[dev]'
	@touch $@ .venv/.run

# The packages for the tests of training. They are large, so only the slow tests install them.
.venv/.training: pyproject.toml | .venv/bin/python
	$(BIN)/python -m pip install $(QUICKLY) -e '.[dev,training]'
	@touch $@ .venv/.dev .venv/.run

.venv/.release: pyproject.toml | .venv/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[release]'
	@touch $@ .venv/.dev .venv/.run

# What npm installs. Where it installs Node.js as well, that has an environment of its own.
$(NPM): $(VIEWER)/package.json $(VIEWER)/package-lock.json | .venv/bin/python
	.ci/npm ci --silent --no-audit --no-fund
	@touch $@

# Folders are named as well, which change when a file goes.
$(BUILT): $(NPM) $(VIEWER)/tsconfig.json $(shell find $(VIEWER)/src)
	.ci/npm run --silent build
	@touch $@

viewer: $(BUILT) ## Build the page that draws matches in the browser, with Node.js 20.19, 22.12 or newer, or one in .venv.

demo: .venv/.run $(BUILT) ## Evaluate the three baselines on three of the five tracks (under 5 minutes).
	$(BIN)/wildscav evaluate random homing hunter --suite quick --replays first \
		--track navigation --track gathering --track battle

# Three at a time on two cores: tests of servers and pages wait more than they compute.
test: .venv/.dev $(BUILT) ## Run the tests (about 5 minutes on two cores); with COVERAGE=1, print which lines and branches they reach.
	.ci/npm test --silent
ifdef COVERAGE
	rm -rf out/coverage && mkdir -p out/coverage
	$(BIN)/python -m coverage run $(PYTEST) -n 3 --dist worksteal --durations=40
	$(BIN)/python .ci/coverage
else
	$(BIN)/python $(PYTEST) -n 3 --dist worksteal --durations=40
endif

# Each file is one process's, which makes what its tests share once; those that last longest come first.
test-slow: .venv/.training $(BUILT) ## Run the slow tests, four at a time: they wait more than they compute.
	$(BIN)/python $(PYTEST) -n 4 --dist loadfile --no-loadscope-reorder -m slow --durations=40

test-with: .venv/.dev ## Run PART of the tests with another Python or other releases: PYTHON=python3.14, RELEASES='numba==0.68.0'.
	rm -rf $(OTHER)
	$(PYTHON) -m venv --without-pip $(OTHER)
	$(BIN)/python -m pip --python $(OTHER)/bin/python install $(QUICKLY) -e '.[$(EXTRA)]' $(RELEASES)
	@$(OTHER)/bin/python -c 'import llvmlite, numba, numpy, sys; print("Python", sys.version.split()[0], *(f"{m.__name__} {m.__version__}" for m in (numpy, numba, llvmlite)))'
	$(OTHER)/bin/python $(PYTEST) -n 2 --dist worksteal $(PART)

# The pins of the engine, for which all of it is compiled anew, and what builds on the insides of releases.
test-oldest: .venv/.dev ## Run some tests with the oldest supported releases of what the engine and the SDK need.
	@$(MAKE) test-with OTHER=.venv-oldest RELEASES="$$(.ci/oldest)" \
		PART="tests/engine/versions tests/engine/compilation/test_linking.py tests/engine/compilation/test_kernel_cache.py \
			tests/engine/compilation/tables/test_array_tables.py tests/platform/wildscav/sdk"

test-newest: .venv/.dev ## Run some tests with the newest Python that all dependencies support.
	@if python=$$(.ci/python 3.14); then $(MAKE) test-with OTHER=.venv-newest PYTHON="$$python" \
		PART="tests/engine/versions tests/engine/envs/test_vector.py tests/platform/wildscav/sdk tests/platform/server \
			tests/platform/wildscav/system"; \
		else echo 'Skipped: the tests with Python 3.14, which is not available.'; fi

# It needs an older mcp than the rest.
test-openenv: .venv/.dev ## Run the tests of the adapter to OpenEnv, in an environment of its own.
	@$(MAKE) test-with OTHER=.venv-openenv EXTRA=openenv RELEASES="hypothesis pytest pytest-timeout pytest-xdist" \
		PART=tests/platform/language/openenv

check: .venv/.dev $(NPM) ## Lint, formatting, types and import contracts.
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	.ci/npm run --silent check

format: .venv/.dev $(NPM) ## Format the code, and fix what can be fixed automatically.
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .
	.ci/npm run --silent format

bench: .venv/.dev ## Run every benchmark; each prints a table.
	@for name in $(BENCHMARKS); do $(BIN)/python -m benchmarks.$$name || exit 1; done

# Silences a notice that Material for MkDocs prints at every build: fixes end in May 2027, and Zensical succeeds it.
docs: export NO_MKDOCS_2_WARNING = 1
docs: .venv/.dev $(BUILT) ## Build the site; warnings are errors.
	$(BIN)/mkdocs build --strict
	@echo 'The site is in out/site: open out/site/index.html, or serve it with: make docs-serve'

docs-serve: export NO_MKDOCS_2_WARNING = 1
docs-serve: .venv/.dev $(BUILT) ## Serve the site at http://127.0.0.1:8000/, and rebuild it when pages change.
	$(BIN)/mkdocs serve

wheel: .venv/.dev $(BUILT) ## Build the wheel in out/wheel with machine code for this Python and these releases.
	$(BIN)/python .ci/wheel out/wheel

release: .venv/.release $(BUILT) ## Make a release in dist: its files, built twice and tried, a list of what they need, and checksums.
	$(BIN)/python .ci/release dist

proto: .venv/.dev ## Generate the Python code of the protocol, and copy it to the agent in JavaScript.
	cp platform/wildscav/proto/match.proto submissions/homing-js/
	$(BIN)/python -m grpc_tools.protoc --proto_path=platform --python_out=platform --pyi_out=platform \
		--grpc_python_out=platform platform/wildscav/proto/*.proto
	$(BIN)/python -m grpc_tools.protoc --proto_path=platform --python_out=platform --pyi_out=platform \
		platform/wildscav_legacy/*.proto

clean: ## Remove the virtual environments and all output.
	rm -rf .venv .venv-* out $(VIEWER)/node_modules platform/wildscav_stage/static/viewer
