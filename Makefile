# The doors of the house. Each works first thing in a fresh clone: Python 3.11 to 3.14, make and the system libraries that
# docs/install.md names. `make setup PYTHON=python3.12` picks the interpreter; else it is the newest of LOCKED that is found.
.DEFAULT_GOAL := help
.DELETE_ON_ERROR:

# The Pythons that requirements.lock is for; tools/setup.sh reads this line.
LOCKED := 3.11 3.12 3.13 3.14

VENV := .venv/bin/python
READY := .venv/ready

# The matrices here are small: a second BLAS thread costs more than it saves, and makes the last digits depend on the machine.
export OPENBLAS_NUM_THREADS := 1

$(READY): requirements.lock pyproject.toml tools/setup.sh tools/pip.sh tools/doctor.py
	@sh tools/setup.sh .venv
	@touch $@

ifdef PYTHON
export PYTHON
version = $(shell command -v $(1) >/dev/null && $(1) -c 'import sys; print(*sys.version_info[:2])' 2>/dev/null)
ifneq ($(call version,$(PYTHON)),$(call version,$(VENV)))
.PHONY: $(READY) # of another Python: made anew
endif
endif

.PHONY: help setup demo docs test proof check bench blind league lock clean

help: ## what each target does
	@grep -E '^[a-z]+:.*## ' Makefile | sed -E 's/^([a-z]+):[^#]*## /  make \1\t/' | expand -t 16

setup: $(READY) ## the virtual environment .venv from the lock, this project editable in it

demo: $(READY) ## everything massline shows, tables on the screen and pictures under out/
	@$(VENV) -m tools.demo

docs: $(READY) ## the pages, notebooks and docstrings as a site with search under out/site; needs no network
	@$(VENV) -P -m tools.site

# The editable install says in a second that it imports from here; then the whole suite runs once, against the built wheel, because
# that is what a user installs. The wheel is these very files (test_wheel.py), so running everything twice would prove nothing more.
test: $(READY) ## where the editable install imports from, then the suite on the built wheel, by two processes; ARGS="-k cuboid" picks tests
	$(VENV) -P -m pytest --quiet tests/architecture/test_origin.py
	sh tools/suite_on_wheel.sh -m "not proof" $(ARGS)

proof: $(READY) ## what `make test` leaves out because it takes long: whole stories, many drawn cases, large models; on the built wheel as well
	sh tools/suite_on_wheel.sh -m proof $(ARGS)

check: $(READY) ## lint, format, types and the rules of import
	$(VENV) -m ruff check .
	$(VENV) -m ruff format --check .
	$(VENV) -m mypy
	.venv/bin/lint-imports --no-logo

bench: $(READY) ## times as ratios, 10,000 damaged files, planted effects found, identification in 200 laboratories (hours; what is done is kept)
	@set -e; for file in benchmarks/bench_*.py; do $(VENV) -m benchmarks.$$(basename $$file .py); done
	@$(VENV) -m benchmarks.fuzz_readers
	@missed=0; for proof in cross_check_proof identification_bars; do $(VENV) -m benchmarks.$$proof || missed=1; done; exit $$missed

blind: $(READY) ## proof on data whose answer is sealed: draws, diagnoses, scores (hours; what is done is kept); ARGS="--jobs 2" runs two at a time
	@$(VENV) -m benchmarks.blind $(ARGS)
	@$(VENV) -m benchmarks.blind.score

league: $(READY) ## the real tests of docs/league.md, whose data MASSLINE_DATA names (minutes); ARGS="footbridge --json" picks
	@$(VENV) -P -c "import sys; from validation.cli.main import run; sys.exit(run(['league', *sys.argv[1:]]))" $(ARGS)

# Needs uv on the path (any recent one) and the network. Pins that still fit are kept: delete the file first to renew them all.
# No registry's host and no path of this machine ends up in it.
lock: ## requirements.lock from pyproject.toml, one for all Pythons of LOCKED
	@command -v uv >/dev/null || { echo "massline: uv is missing; https://docs.astral.sh/uv says how to install it." >&2; exit 1; }
	@mkdir -p build; set -e; for python in $(LOCKED); do cp -f requirements.lock build/$$python.lock 2>/dev/null || true; \
		uv pip compile pyproject.toml --extra dev --extra all --python-version $$python --generate-hashes --no-annotate --no-header \
			--no-emit-index-url --no-emit-find-links --only-binary :all: --quiet --output-file build/$$python.lock; \
		if [ $$python = 3.11 ]; then cp build/3.11.lock requirements.lock; \
		elif grep -vxFf requirements.lock build/$$python.lock; then echo "massline: Python $$python needs these pins" >&2; exit 1; fi; done

clean: ## everything that was made here
	rm -rf .venv build dist out .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
