# limitsurf: `make demo` and `make test` each work alone on a fresh clone.
# They need git, make and Python >= 3.11 and build .venv once from constraints.txt.

VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
PYTHONS := python3.14 python3.13 python3.12 python3.11 python3 python

.PHONY: demo test test-slow lint format clean help

help:
	@echo "make demo       align a paper T on the 1994 array; writes demo/report.html"
	@echo "make test       run the quick tests"
	@echo "make test-slow  run the slow tests"
	@echo "make lint       ruff and mypy"
	@echo "make format     format the code"
	@echo "make clean      remove .venv and caches"

demo: $(READY)
	$(BIN)/limitsurf align paper_t --array resonator64 --voltage 50 --samples 200 --seed 1 --out demo

test: $(READY)
	$(BIN)/python -m pytest

test-slow: $(READY)
	$(BIN)/python -m pytest -m slow

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

format: $(READY)
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

clean:
	rm -rf $(VENV) .pytest_cache .mypy_cache .ruff_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

$(READY): pyproject.toml constraints.txt
	@found=""; old=""; bare=""; \
	for python in $(PYTHON) $(PYTHONS); do \
	  command -v "$$python" >/dev/null 2>&1 || continue; \
	  if ! "$$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1; then \
	    old="$$old $$python"; continue; \
	  fi; \
	  if ! "$$python" -c 'import ensurepip, venv' >/dev/null 2>&1; then \
	    bare="$$bare $$python"; continue; \
	  fi; \
	  found="$$python"; break; \
	done; \
	if [ -z "$$found" ] && [ -n "$$bare" ]; then \
	  echo "limitsurf:$$bare has no venv module; install it (on Debian: apt install python3-venv)" >&2; exit 1; \
	fi; \
	if [ -z "$$found" ]; then \
	  echo "limitsurf: needs Python 3.11 or newer, found:$${old:- none}; install one, or run make PYTHON=/path/to/python3" >&2; exit 1; \
	fi; \
	echo "Building $(VENV) with $$found (once, about four minutes)"; \
	rm -rf $(VENV) && "$$found" -m venv $(VENV)
	@PIP_CONSTRAINT=constraints.txt PIP_DISABLE_PIP_VERSION_CHECK=1 $(BIN)/python -m pip install --quiet --editable ".[test]"
	@$(BIN)/limitsurf warm-up
	@touch $(READY)
