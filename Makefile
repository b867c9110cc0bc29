# Reading the book needs one command (`make book`), testing it needs another (`make test`).
# Both set up what they need in .venv, from environment.lock: exact versions, checked hashes.

PYTHON ?= python3
VENV := .venv
PY := $(VENV)/bin/python
BENCH := .venv-bench
LAB := .venv-lab
UV := $(shell command -v uv 2>/dev/null || echo .venv-uv/bin/uv)

# A chapter's output must not depend on who executes it: no user profile, no other plotting
# backend than the notebook's own, no other library than that of this checkout, no thread count in
# the order of a floating-point sum. Nor does anything need a home that can be written to.
HERE := $(CURDIR)/$(VENV)/home
export IPYTHONDIR := $(HERE)/ipython
export JUPYTER_CONFIG_DIR := $(HERE)/jupyter
export JUPYTER_DATA_DIR := $(HERE)/jupyter
export JUPYTER_RUNTIME_DIR := $(HERE)/jupyter/runtime
export MPLCONFIGDIR := $(HERE)/matplotlib
export HYPOTHESIS_STORAGE_DIRECTORY := $(HERE)/hypothesis
export RUFF_CACHE_DIR := $(HERE)/ruff
export MYPY_CACHE_DIR := $(HERE)/mypy
export UV_CACHE_DIR := $(CURDIR)/.venv-uv/cache
export OMP_NUM_THREADS := 1
export OPENBLAS_NUM_THREADS := 1
export PIP_DISABLE_PIP_VERSION_CHECK := 1
unexport MPLBACKEND JUPYTER_PATH PYTHONHOME PYTHONOPTIMIZE PYTHONPATH PYTHONSAFEPATH
# Without byte code every kernel compiles what it imports: five seconds for each chapter.
unexport PYTHONDONTWRITEBYTECODE

# $(call environment,folder,lock): an environment with what the lock holds, and the library itself;
# made anew if it is not that of this place, this Python and this lock.
define environment
@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	{ echo "error: Python 3.11 or newer is needed, but $(PYTHON) is $$($(PYTHON) -V 2>&1);" \
	"choose another one with: make PYTHON=python3.12" >&2; exit 1; }
@$(PYTHON) -m tools.environment $(1) $(2)
endef

.PHONY: help
help:  ## show this list
	@sed -n 's/^\([a-z0-9-]*\):.*  ## /\1\t/p' $(MAKEFILE_LIST) | expand -t 18

.PHONY: book
book: $(VENV)/.ready  ## build the book: book/_build/html/index.html
	$(PY) -m tools.book

# Nothing is asked of the network: neither news nor newer versions.
.PHONY: lab
lab: $(LAB)/.ready  ## open the chapters in JupyterLab, to change and rerun them
	$(LAB)/bin/jupyter lab --ServerApp.root_dir=book --LabApp.news_url=None \
		--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate

.PHONY: test
test: $(VENV)/.ready  ## check everything: style, book without warnings, tests, examples, chapters
	$(MAKE) --jobs=2 lint book tests

# The tests, the examples in docstrings and the chapters; all that numba compiles is compiled once, for
# every process that follows.
.PHONY: tests
tests: compile
	$(PY) -m pytest -n logical --maxprocesses 4 --dist loadfile --no-loadscope-reorder

.PHONY: compile
compile: $(VENV)/.ready
	$(PY) -m tools.compile

.PHONY: test-matrix
test-matrix:  ## test the library with every Python that is found, and with the oldest packages
	$(PYTHON) -m tools.matrix $(PYTHONS)

# FUZZ_SEED=... tries the same again, FUZZ_FROM=... begins with that function.
.PHONY: fuzz
fuzz: $(VENV)/.ready  ## try 10 000 odd arguments on every public function: an hour
	$(PY) -m tests.fuzz $(if $(FUZZ_SEED),--seed $(FUZZ_SEED)) $(if $(FUZZ_FROM),--from $(FUZZ_FROM))

.PHONY: lint
lint: $(VENV)/.ready  ## check style, formatting and types
	$(VENV)/bin/ruff check
	$(VENV)/bin/ruff format --check
	$(VENV)/bin/mypy

.PHONY: format
format: $(VENV)/.ready  ## repair what can be repaired of style, and write the stubs of the packages
	$(VENV)/bin/ruff check --fix
	$(VENV)/bin/ruff format
	$(PY) -m tools.stubs

# NAME=ekf executes book/ekf.ipynb only, some ten seconds; several names take quotes.
.PHONY: chapter
chapter: $(VENV)/.ready  ## execute the chapter NAME=... in place (all without it), with text and hash
	$(PY) -m tools.notebooks $(NAME:%=book/%.ipynb)
	$(PY) -m tools.record --hashes

# NAME=valarmathi judges that document only.
.PHONY: judge
judge: $(VENV)/.ready  ## judge all claims (or those of NAME=...), and write what the book shows of it
	$(PY) -m tools.judge $(NAME)

# NAME=valarmathi judges the claims of that document only, and executes no chapter.
.PHONY: record
record: $(VENV)/.ready  ## compare every byte of the chapters, judge all claims with five seeds
	$(PY) -m tools.record $(NAME)

.PHONY: kernels
kernels: $(VENV)/.ready  ## derive the formulas, print the numerical kernels and C99 for firmware
	$(PY) -m tools.kernels

# NAME=noise_sweep runs that one, WORKERS=4 in so many processes; what it computes and costs:
# python -m studies NAME --help.
.PHONY: study
study: $(VENV)/.ready  ## run the study NAME=... and write results/NAME.* (list them without NAME)
	$(PY) -m studies $(NAME) $(if $(WORKERS),--workers $(WORKERS))

# What the book shows is in benchmarks/measured; ROUNDS=3 is quick and rough, 7 are made without it.
MEASURED := $(basename $(notdir $(wildcard benchmarks/measured/*.json)))

.PHONY: bench
bench: $(BENCH)/.ready  ## run benchmarks/NAME.py; without NAME all that the book shows, ten minutes
	for name in $(or $(NAME),$(MEASURED)); do $(BENCH)/bin/python benchmarks/$$name.py || exit; done

.PHONY: lock
lock: $(if $(filter .venv-uv/%,$(UV)),.venv-uv/.ready)  ## renew all lock files
	@mkdir -p .venv-uv
	$(UV) pip compile $(LOCK_OPTIONS) requirements.in -o .venv-uv/environment.lock
	$(UV) pip compile $(LOCK_OPTIONS) -c .venv-uv/environment.lock benchmarks/requirements.in \
		-o .venv-uv/requirements.lock
	$(UV) pip compile $(LOCK_OPTIONS) -c .venv-uv/environment.lock .binder/requirements.in \
		-o .venv-uv/requirements.txt
	grep -E '^($(TESTED_WITH))==' .venv-uv/environment.lock | tr -d '\\' > .venv-uv/tests.in
	$(UV) pip compile $(LOCK_OPTIONS) --resolution lowest-direct --all-extras pyproject.toml \
		.venv-uv/tests.in -o .venv-uv/minimum.lock
	cd .venv-uv && mv -f environment.lock .. && mv -f requirements.lock ../benchmarks/ && \
		mv -f requirements.txt ../.binder/ && mv -f minimum.lock ../tests/

.PHONY: clean
clean:  ## remove everything that the other targets made
	rm -rf $(VENV) $(BENCH) $(LAB) .venv-uv .venv-matrix book/_build *.egg-info .hypothesis .ruff_cache .mypy_cache
	find dopplerlib book data results studies tests tools benchmarks \
		\( -name __pycache__ -o -name '*.part' -o -name '.partial-*' \) -prune -exec rm -rf {} +

# One lock for every platform and every Python from 3.11 on, without the address of an index.
LOCK_OPTIONS := --quiet --upgrade --universal --fork-strategy fewest --python-version 3.11 \
	--generate-hashes --no-annotate --no-header --no-emit-index-url \
	$(addprefix --no-emit-package ,playwright greenlet pyee) # what axe-playwright-python drives

# The packages of the tests themselves are no question of the oldest ones.
TESTED_WITH := hypothesis|ipykernel|nbformat|nbval|pytest|pytest-xdist|pyyaml|setuptools

# Looked at every time: what they were made of is not told by the time of a file.
.PHONY: FORCE
$(VENV)/.ready: FORCE
	$(call environment,$(VENV),environment.lock)

$(BENCH)/.ready: FORCE
	$(call environment,$(BENCH),benchmarks/requirements.lock)

$(LAB)/.ready: FORCE
	$(call environment,$(LAB),.binder/requirements.txt)

.venv-uv/.ready:
	$(PYTHON) -m venv --clear .venv-uv
	.venv-uv/bin/python -m pip install -q uv
	@touch $@
