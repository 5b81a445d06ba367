# `make` goes the whole way on the bundled log: environment, derivation, emission, fit.
# Needs python3 (3.11 or later, with venv), make and gcc; all else comes from PyPI into .venv.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SIMULATORS := build/simulators
STRICT := -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Werror

# What the generated files follow from. Sources are listed, never outputs:
# a wildcard over generated/ would see a new model one run late.
DERIVATIONS := $(wildcard derivations/*.py)
TOOLKIT := $(wildcard eccentric/*.py) $(shell find eccentric/core eccentric/model eccentric/effects eccentric/emission -name "*.py")
TEMPLATES := $(wildcard templates/*/*.jinja)

# One stamp per set of extras. They live in the environment, so deleting it forgets them too.
RUN := $(VENV)/.stamp-report
TEST := $(VENV)/.stamp-test
LINT := $(VENV)/.stamp-lint
DOCS := $(VENV)/.stamp-docs
DERIVED := $(VENV)/.stamp-derived

.PHONY: run test test-slow test-exports derive figures docs lint check bench freeze compare mutants weight clean
.NOTPARALLEL:

run: $(DERIVED)
	@$(BIN)/eccentric fit examples/bench/bench.csv.gz --rig examples/bench/bench.json --out build/fit
	@echo
	@$(BIN)/eccentric diagnose examples/bench/bench.csv.gz --rig examples/bench/bench.json --out build/bench
	@$(CC) $(STRICT) -c build/bench/c2_parallel_extended.c -o build/c2_parallel_extended.o
	@echo "build/c2_parallel_extended.o: the extended model, compiled with $(CC) $(STRICT)"

# One process per processor: threads of a linear algebra library would only wait for each other. In the order of
# tests/conftest.py: the files with the fewest tests, which would come last, take the longest.
PYTEST := OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n auto --dist loadfile --no-loadscope-reorder

test: $(TEST)
	@$(PYTEST) -m "not slow"

# What `make test` samples; of some of it `make bench` has more.
test-slow: $(TEST)
	@$(PYTEST) -m slow

# Every export in the package that it is for. Warp and Newton take 700 MB: an environment of their own, over the
# first one, that no other target needs. Its tests are skipped by `make test`, which says so.
test-exports: $(TEST)
	@test -x $(SIMULATORS)/bin/pip || $(PYTHON) -m venv $(SIMULATORS)
	@cd $(VENV) && realpath lib/python*/site-packages > $$(echo $(abspath $(SIMULATORS))/lib/python*/site-packages)/first.pth
	@$(SIMULATORS)/bin/pip install -qq --disable-pip-version-check -c constraints.txt mujoco-warp newton \
	    newton-usd-schemas usd-core
	@OMP_NUM_THREADS=1 $(SIMULATORS)/bin/python -m pytest tests/test_export_*.py tests/test_exports_page.py

derive: $(RUN)
	@$(BIN)/eccentric derive
	@touch $(DERIVED)

figures: $(RUN)
	@$(BIN)/eccentric figures --out build/figures

# The manual as a static site.
docs: $(DOCS)
	@$(BIN)/python -m sphinx -qEW --keep-going -d build/.doctrees docs build/docs
	@echo "build/docs/index.html"

lint: $(LINT)
	@$(BIN)/ruff check
	@$(BIN)/ruff format --check
	@$(BIN)/pyright

check: lint test

# Half an hour: the emitted code beside its peers, and how often the diagnosis is right. Threads of a linear
# algebra library would disturb what is timed, and stand in the way of processes.
bench: $(TEST)
	@OMP_NUM_THREADS=1 $(BIN)/python benchmarks/page.py

# Results in a folder outside the tree, ../frozen/COMMIT-PART or FROZEN=, before and after a change. REV= takes a
# commit instead of the tree as it is, DATA= the folder of the logs that are not bundled, PART=all everything. An
# environment that exists is used as it is: installing it again would point one shared by worktrees at this one.
freeze: | $(TEST)
	@$(BIN)/python benchmarks/freeze.py --part $(or $(PART),core) $(if $(REV),--rev $(REV)) \
	    $(if $(DATA),--data $(DATA)) $(if $(FROZEN),--out $(FROZEN))

compare:
	@$(BIN)/python benchmarks/compare_frozen.py $(BEFORE) $(AFTER) $(if $(RENAMED),--renamed $(RENAMED))

# Small changes to the sources, each of which a test should notice. Goes on where an earlier run was interrupted.
mutants: $(TEST)
	@OMP_NUM_THREADS=1 $(BIN)/python benchmarks/mutants.py --number $(or $(NUMBER),200) --seed $(or $(SEED),1)

# Lines, files, floors, and how many files a diagnosis runs through.
weight: $(RUN)
	@$(BIN)/python benchmarks/weight.py

# The environment stays: delete $(VENV) by hand to start over.
clean:
	rm -rf build dist generated/build *.egg-info generated/*.egg-info .pytest_cache .ruff_cache .hypothesis
	rm -f $(DERIVED)
	find . -name __pycache__ -not -path './$(VENV)/*' -prune -exec rm -rf {} +

$(DERIVED): $(DERIVATIONS) $(TOOLKIT) $(TEMPLATES) | $(RUN)
	@mkdir -p build
	@echo "derive: generated/ from derivations/ (the derivations themselves: build/derivations.txt)"
	@$(BIN)/eccentric derive > build/derivations.txt
	@touch $@

$(VENV)/.stamp-%: pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and \
	    "eccentric needs Python 3.11 or later; name one with: make PYTHON=python3.12")'
	@echo "environment: eccentric[$*] into $(VENV)"
	@test -x $(BIN)/pip || $(PYTHON) -m venv $(VENV)
	@$(BIN)/pip install -qq --disable-pip-version-check -c constraints.txt -e '.[$*]'
	@touch $@
