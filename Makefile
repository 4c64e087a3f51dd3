# Two commands: `make demo` runs the workbench, `make test` checks it.
# Their dependencies are installed once, into .venv and frontend/node_modules.

PYTHON ?= python3
PORT ?= 8000
VENV := .venv
BIN := $(VENV)/bin
DATABASE := sqlite:///var/flexsid.db

# Sources of the page, which is part of the installed package.
PAGE := $(shell find frontend -type f \
	-not -path '*/node_modules/*' -not -path '*/dist/*' -not -name '*.test.*' -not -name '*.gen.ts' 2>/dev/null)

# One BLAS thread: workers and test processes already use all cores.
export OPENBLAS_NUM_THREADS := 1
export UV_NO_PROGRESS := 1
export UV_LINK_MODE := copy
# The tests start hundreds of processes; without compiled modules each compiles its libraries
# again. An empty value also overrides an environment that forbids to write them.
export PYTHONDONTWRITEBYTECODE :=
announce = @printf '\033[1mflexsid: %s\033[0m\n'

.PHONY: help install demo serve docs release test test-long adversary lint types rules page-checks browser database format lock clean
.DEFAULT_GOAL := help

help:
	@echo 'make demo     install, fill an empty workbench with the demonstration campaign, serve it'
	@echo 'make test     install and run every check and test, including one browser test'
	@echo 'make test-long    run rare faults and statistics over large matrices (hours)'
	@echo 'make adversary    fly drawn aircraft (N=20 SEED=1) and print how the estimates compare with their truth'
	@echo 'make serve    serve the workbench without filling it (PORT=8000)'
	@echo 'make docs     build the documentation site into var/site'
	@echo 'make release  build dist/ and run it in empty environments (VERSION=1.0.0 writes it first); publishes nothing'
	@echo 'make install  install the package and its dependencies'
	@echo 'make format   format all sources'
	@echo 'make lint, make types, make rules, make page-checks    parts of make test'
	@echo 'make lock     update the locked packages'
	@echo 'make clean    remove everything that was installed or built, except var/'

# --- Installing ------------------------------------------------------------

install: $(VENV)/.installed

$(BIN)/python:
	$(announce) 'creating $(VENV)'
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo 'flexsid needs Python 3.11 or newer: make PYTHON=/path/to/python3'; exit 1; }
	@$(PYTHON) -m venv $(VENV) || \
		{ echo 'this Python cannot create virtual environments; on Debian install python3-venv'; exit 1; }

# uv is several times faster than pip, but does not read the settings of pip. If uv
# is not available or finds no index, pip is used. The packages of the page are
# fetched meanwhile; if that fails, building the page reports the reason.
$(VENV)/.locked: requirements.lock | $(BIN)/python
	$(announce) 'installing the locked packages'
	@$(BIN)/python hatch_build.py --version >/dev/null 2>&1 & \
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r deploy/uv.txt; \
	$(BIN)/uv pip install --quiet --python $(BIN)/python --require-hashes -r requirements.lock || \
		{ echo 'uv failed; trying pip'; \
		$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock; } || \
		exit 1; \
	wait
	@touch $@

$(VENV)/.installed: $(VENV)/.locked pyproject.toml hatch_build.py $(PAGE)
	$(announce) 'building the page'
	@$(BIN)/python hatch_build.py
	$(announce) 'installing flexsid'
	@$(BIN)/uv pip install --quiet --python $(BIN)/python --no-deps --no-build-isolation --editable . || \
		$(BIN)/python -m pip install --quiet --disable-pip-version-check \
		--no-deps --no-build-isolation --editable .
	@$(BIN)/python -c 'import flexsid.cli.serve, flexsid.jobs.dispatcher_process' # compiles the modules
	@touch $@

lock: | $(BIN)/python
	$(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --upgrade \
		--no-header --group test --group contract --group docs pyproject.toml --output-file requirements.lock
	echo uv | $(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --upgrade \
		--no-header --no-annotate - --output-file deploy/uv.txt

# --- Running ---------------------------------------------------------------

demo: install
	@mkdir -p var
	@FLEXSID_PORT=$(PORT) exec $(BIN)/flexsid demo --database $(DATABASE)

serve: install
	@mkdir -p var
	@FLEXSID_PORT=$(PORT) exec $(BIN)/flexsid serve --database $(DATABASE)

docs: install
	@NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --quiet --strict
	$(announce) 'the documentation is at var/site/index.html; its search requires a server: python -m http.server -d var/site'

VERSION ?=
release: install
	$(announce) 'building a release, which is run with every Python'
	@$(BIN)/python deploy/release $(VERSION)

# --- Checking --------------------------------------------------------------

CORES = $(shell $(BIN)/python -c 'import os; print(os.cpu_count() or 1)')
# The checks run beside each other; each prints its output when it has ended.
SYNC = $(if $(filter output-sync,$(.FEATURES)),--output-sync=recurse)
# Not the files of most tests first, but the longest (tests/conftest.py). Two processes more than
# cores: tests of servers and of the browser mostly wait.
PYTEST = $(BIN)/python -m pytest --dist loadfile --no-loadscope-reorder \
	--numprocesses $(shell expr $(CORES) + 2)

test: install
	@$(MAKE) --no-print-directory --jobs=$(shell expr $(CORES) + 1) $(SYNC) page-checks types database lint rules
	$(announce) 'running the tests'
	@$(PYTEST)

test-long: install database
	$(announce) 'running the long tests'
	@$(PYTEST) -m long --every-database

N ?= 20
SEED ?= 1
adversary: install
	@$(BIN)/python tests/adversary $(N) $(SEED)

lint: install
	$(announce) 'style and spelling'
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check --quiet .
	@$(BIN)/codespell

types: install
	$(announce) 'types'
	@$(BIN)/pyrefly check --summary=none

rules: install
	$(announce) 'layers'
	@$(BIN)/lint-imports

page-checks: install
	$(announce) 'the page: style, types and tests'
	@PYTHON=$(CURDIR)/$(BIN)/python $(BIN)/python hatch_build.py run --silent generate
	@$(BIN)/python hatch_build.py run lint
	@$(BIN)/python hatch_build.py run format:check
	@$(BIN)/python hatch_build.py run typecheck
	@$(BIN)/python hatch_build.py test

# The browser test uses the Chromium of the system; only root can install it.
browser:
	@command -v chromium >/dev/null || command -v chromium-browser >/dev/null || \
		if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
			echo 'flexsid: installing Chromium for the browser test'; \
			apt-get update -qq && DEBIAN_FRONTEND=noninteractive \
			apt-get install -qq -y --no-install-recommends chromium fonts-dejavu-core >/dev/null; \
		else \
			echo 'flexsid: Chromium is not installed; the browser test will be skipped'; \
		fi
	@# Without a window it takes less time; not every system has it.
	@command -v chromium-headless-shell >/dev/null || [ "$$(id -u)" != 0 ] || \
		DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends \
		chromium-headless-shell >/dev/null 2>&1 || true

# The tests also run on PostgreSQL, whose server comes from the system; after the browser,
# since apt-get runs once at a time.
database: browser
	@ls /usr/lib/postgresql/*/bin/postgres >/dev/null 2>&1 || command -v postgres >/dev/null || \
		if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
			echo 'flexsid: installing PostgreSQL for the tests'; \
			apt-get update -qq && DEBIAN_FRONTEND=noninteractive \
			apt-get install -qq -y --no-install-recommends postgresql >/dev/null; \
		else \
			echo 'flexsid: PostgreSQL is not installed; its tests will be skipped'; \
		fi

format: install
	@$(BIN)/ruff check --fix --quiet . || true
	@$(BIN)/ruff format --quiet .
	@$(BIN)/python hatch_build.py run format

clean:
	rm -rf $(VENV) frontend/node_modules backend/flexsid/frontend_dist dist
	find . -name __pycache__ -not -path './frontend/*' -prune -exec rm -rf {} +
	rm -rf .pytest_cache .ruff_cache .import_linter_cache .hypothesis
