# Two commands are all the set-up there is: `make demo` and `make test`. Each makes its own environment first.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

.PHONY: demo test warm test-wheel lint docs urdf clean

demo: $(VENV)/.installed
	$(BIN)/nao-kin demo

test: $(VENV)/.installed-dev
	$(MAKE) --no-print-directory -j2 lint warm
	$(BIN)/python -m pytest -n auto

# Beside the linters, and once instead of in every worker of the tests.
warm: $(VENV)/.installed-dev
	$(BIN)/nao-kin warmup

# The same tests on what a user installs: the wheel, in an environment of its own, away from src.
test-wheel: $(VENV)/.installed-dev
	rm -rf dist .venv-wheel
	$(BIN)/python -m build --quiet --outdir dist .
	$(PYTHON) -m venv .venv-wheel
	.venv-wheel/bin/python -m pip install --quiet --disable-pip-version-check "$$(ls dist/*.whl)[dev]"
	.venv-wheel/bin/python -m pytest -n auto

lint: $(VENV)/.installed-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-logo

# Warnings, and references that lead nowhere, are errors.
docs: $(VENV)/.installed-dev
	$(BIN)/python -m sphinx -W --keep-going -n -q -E -b html docs docs/_build/html

# The files in urdf/ come from the tables in tools/urdf_tables/.
urdf: $(VENV)/.installed-dev
	$(BIN)/python tools/make_urdf.py

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV)

$(VENV)/.installed: $(VENV)/bin/python pyproject.toml
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	touch $@

$(VENV)/.installed-dev: $(VENV)/.installed pyproject.toml
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	touch $@

clean:
	rm -rf $(VENV) .venv-wheel dist demo docs/_build docs/reference
