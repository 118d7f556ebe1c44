# make run    the dashboard on http://127.0.0.1:8080 (ARGS="--port 9000 --seed 3" passes flags on)
# make test   every test, browser tests included
# make check  formatting, lint, types
# make knowledge  everything the robot knows beforehand: hours; begun again, it goes on, and what is up to date is kept
# PYTHON=/path/to/python3.11 picks the interpreter that makes the environment

PYTHON ?= python3.11
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.setup-done
ARGS ?=
WANTED := -c constraints.txt -e '.[dev]'
INSTALL := $(BIN)/python -m pip install --quiet $(WANTED)
# uv does the same in a fraction of the time; where it isn't to be had, or doesn't find what pip is set up to find, pip does it.
INSTALL_FAST := $(BIN)/python -m pip install --quiet -c constraints.txt uv && \
  UV_FIND_LINKS="$$PIP_FIND_LINKS" $(BIN)/uv pip install --quiet --compile-bytecode --python $(BIN)/python $(WANTED)

.DEFAULT_GOAL := run
.PHONY: setup run test check knowledge screenshots clean

setup: $(STAMP)

$(STAMP): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' 2>/dev/null || { \
	  echo "This project needs Python 3.11 and '$(PYTHON)' is not one: install it (Debian, Ubuntu: apt install python3.11 python3.11-venv;"; \
	  echo "macOS: brew install python@3.11; anywhere: uv python install 3.11), or say where it is: make PYTHON=/path/to/python3.11"; \
	  exit 1; }
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(INSTALL_FAST) || $(INSTALL)
	$(BIN)/python -m backend warm
	@touch $@

run: setup
	$(BIN)/python run_server.py $(ARGS)

test: setup
	.ci/chromium
	$(BIN)/python -m pytest -n 2 --dist loadgroup $(ARGS)

check: setup
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/pyright

knowledge: setup
	$(BIN)/python -m backend build grasps
	$(BIN)/python -m backend build reachability
	$(BIN)/python -m backend build motion-aware
	$(BIN)/python -m backend build predictor
	$(BIN)/python -m backend report knowledge --figures docs

screenshots: setup
	.ci/chromium
	$(BIN)/python -m tests.app.screenshots
	$(BIN)/python -m backend trial mico_sinusoidal --seed 1 --trace build/trial.npz
	$(BIN)/python -m backend render build/trial.npz --out docs/trial.gif --width 480 --speed 2

clean:
	rm -rf $(VENV) build *.egg-info .pytest_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
