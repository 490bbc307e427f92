# Everything runs in .venv, which the first command that needs it makes. `make` alone lists the commands.

.DEFAULT_GOAL := help
SHELL := /bin/sh

VENV := .venv
BIN := $(VENV)/bin
# The first Python on this machine that is new enough and can make virtual environments.
PYTHON ?= $(shell for p in python3 python3.13 python3.12 python3.11 python; do \
	$$p -c 'import sys, ensurepip, venv; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && { command -v $$p; break; }; done)
PIP := $(BIN)/python -m pip --disable-pip-version-check install --quiet --constraint constraints.txt
RUNTIME := $(VENV)/.installed
DEV := $(VENV)/.installed-dev

# One thread a process: the tests and the jobs are parallel already.
export OMP_NUM_THREADS := 1
export OPENBLAS_NUM_THREADS := 1
export MKL_NUM_THREADS := 1

.PHONY: help demo serve test test-numerical check format openapi papers constraints clean

help:  ## list the commands
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-12s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

demo: $(RUNTIME)  ## walk the whole loop on a simulated plant; leaves an HTML report
	$(BIN)/lpv-oed demo

serve: $(RUNTIME)  ## start the service on 127.0.0.1
	$(BIN)/lpv-oed serve

# Its tests, one an operation, share one name, of which parallel runs would keep one.
FUZZ := tests/acceptance/test_schema_fuzz.py

test: $(DEV)  ## run all tests on two cores
	$(BIN)/python -m pytest -n 2 --dist loadgroup --ignore=$(FUZZ) $(PYTEST_ARGS)
	$(BIN)/python -m pytest $(FUZZ)

test-numerical: $(DEV)  ## run the quick tests of the mathematics alone
	$(BIN)/python -m pytest -n 2 -m "not slow" tests/identification tests/oed $(PYTEST_ARGS)

check: $(DEV)  ## format, lint, types, and the published OpenAPI document
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/python -m app.openapi_export --check

format: $(DEV)  ## put the code into the project's format
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

openapi: $(DEV)  ## write openapi/openapi.json from the code
	$(BIN)/python -m app.openapi_export

papers: $(DEV)  ## write docs/papers.md: the five papers' tables and figures beside ours
	$(BIN)/python -m benchmarks.papers $(PAPERS_ARGS)

constraints: $(DEV)  ## pin the versions that are installed now
	$(BIN)/python scripts/constraints.py > $(VENV)/constraints.txt
	mv $(VENV)/constraints.txt constraints.txt

clean:  ## remove the virtual environment and caches
	rm -rf $(VENV) .mypy_cache .ruff_cache .pytest_cache .hypothesis build dist

$(BIN)/python:
	@test -n "$(PYTHON)" || { \
		echo "Python 3.11 or newer that can make virtual environments is needed:"; \
		echo "apt-get install python3-venv (Debian, Ubuntu), or say PYTHON=/path/to/python3"; exit 1; }
	"$(PYTHON)" -m venv $(VENV)

$(RUNTIME): $(BIN)/python pyproject.toml constraints.txt
	@echo "Installing lpv-oed into $(VENV) (a minute or two, once) ..."
	$(PIP) --editable .
	@touch $@

$(DEV): $(RUNTIME)
	@echo "Installing what the tests and checks need into $(VENV) ..."
	$(PIP) --editable '.[dev,files]'
	@touch $@
