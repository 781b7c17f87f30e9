# Needs Python 3.11, 3.12 or 3.13 and make; everything else goes into .venv, from the lock, with hashes.

SUPPORTED := import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))
PYTHON ?= $(shell for p in python3 python3.12 python3.11 python3.13; do \
	$$p -c '$(SUPPORTED)' 2>/dev/null && { echo $$p; break; }; done)
BIN := .venv/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet install
LOCK := uv pip compile --universal --python-version 3.11 --generate-hashes \
	--no-emit-index-url --no-emit-find-links --no-header --no-annotate --quiet

.PHONY: client site release demo test serve lint bench bench-work-precision bench-dashboard bench-skipping bench-tolerances bench-reading load chaos soak rehearse fuzz attack stress plausible validate docs lock clean

demo: .venv/.runtime  ## the paper's cable, over HTTP, to figures in ./demo
	$(BIN)/hockle demo

serve: .venv/.runtime  ## API, worker and broker, until Ctrl-C
	$(BIN)/hockle serve

# where a test ends its process, the run ends: files are dealt out, and the others would wait for its rest forever
test: .venv/.dev .venv/.docs  ## the whole test suite, three files at a time: many tests wait
	$(BIN)/python -m pytest -n 3 --dist loadfile --no-loadscope-reorder --max-worker-restart 0 --durations 15

lint: .venv/.dev .venv/.docs  ## style, types, and who may import whom
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-logo

bench: .venv/.runtime  ## cost per Newton iteration and per scene
	$(BIN)/python -m benchmarks

load: .venv/.runtime  ## what the service bears: pollers, submissions, events, a queue of 10,000 jobs
	$(BIN)/python -m benchmarks.load

bench-reading: .venv/.runtime  ## reading of results and ensembles, beside their aims
	$(BIN)/python -m benchmarks.reading

chaos: .venv/.dev  ## faults on purpose, on SQLite and PostgreSQL: what became of every job (an hour or two)
	$(BIN)/python -m chaos

soak: .venv/.dev  ## an hour of mixed load with faults on one service: does anything grow, leak or get stuck
	$(BIN)/python -m chaos.soak

rehearse: .venv/.deploy  ## the image built, docker-compose.yml with two workers without an engine, the chart (root; an hour)
	$(BIN)/python -m pytest tests/deploy
	$(BIN)/python -m deploy.rehearse

attack: .venv/.dev  ## what strangers would try, on loopback: slow connections, odd requests, odd texts, stopped processes (over an hour)
	$(BIN)/python -m chaos.attack

fuzz: .venv/.dev  ## schemathesis with all checks for long, and 10,000 malformed cases
	FUZZ=long $(BIN)/python -m pytest -s tests/service/api/test_fuzz.py

stress: .venv/.dev  ## the solver at its limits: sweeps, maps and 10,000 random cases (an hour or more)
	$(BIN)/python -m stress

plausible: .venv/.dev  ## scenes as people would send them, in the default mode: is each answered, is its error true (an hour)
	$(BIN)/python -m stress.plausible
	$(BIN)/python -m stress.plausible.judge

bench-work-precision: .venv/.bench  ## CPU time against error, beside PyElastica and MuJoCo's cable
	$(BIN)/python -m benchmarks.work_precision

bench-dashboard: .venv/.dev  ## what the dashboard's pages take in a headless Chromium, and their pictures (minutes)
	$(BIN)/python -m benchmarks.dashboard

bench-skipping: .venv/.runtime  ## what contact, fluid and loads cost a scene that lacks them (a quarter of an hour)
	$(BIN)/python -m benchmarks.skipping

bench-tolerances: .venv/.runtime  ## CPU time of the default mode against its true error, on the paper's scene (two minutes)
	$(BIN)/python -m benchmarks.tolerances

validate: .venv/.runtime  ## published scenes, and what they must show
	$(BIN)/python -m validation

docs: .venv/.runtime  ## the documents' tables, from the code and the kept results
	$(BIN)/python -m docs

site: .venv/.docs  ## the documentation as a site, which the API then serves at /docs
	$(BIN)/python -m mkdocs build --strict --quiet

release: .venv/.deploy site  ## wheels, their checksums and an SBOM, in ./dist
	rm -rf dist
	$(BIN)/python -m pip wheel --quiet --no-deps --no-build-isolation --wheel-dir dist . ./client
	$(BIN)/cyclonedx-py requirements requirements.txt --pyproject pyproject.toml --output-file dist/hockle.cdx.json
	cd dist && sha256sum -- * > SHA256SUMS

client: .venv/.runtime  ## the parts of the client that follow from others
	cd client && ../$(BIN)/python -m generate

lock:  ## after a change of a requirements*.in (needs uv)
	$(LOCK) requirements.in requirements-build.in -o requirements.txt
	$(LOCK) --constraint requirements.txt requirements-s3.in -o requirements-s3.txt
	$(LOCK) requirements-dev.in -o requirements-dev.txt
	$(LOCK) --constraint requirements.txt requirements-bench.in -o requirements-bench.txt
	$(LOCK) --constraint requirements.txt --constraint requirements-dev.txt requirements-deploy.in -o requirements-deploy.txt
	$(LOCK) --constraint requirements.txt --constraint requirements-dev.txt requirements-docs.in -o requirements-docs.txt

clean:  ## the environment and all that was made
	rm -rf .venv var demo build dist service/site *.egg-info .mypy_cache .ruff_cache .pytest_cache .hypothesis

.venv/bin/python:
	@test -n "$(PYTHON)" || { echo "hockle needs Python 3.11, 3.12 or 3.13: name one with make PYTHON=..." >&2; exit 1; }
	@echo "making .venv with $(PYTHON)"
	$(PYTHON) -m venv .venv

.venv/.runtime: requirements.txt pyproject.toml | .venv/bin/python
	@echo "installing what hockle needs to run"
	$(PIP) --require-hashes -r requirements.txt
	$(PIP) --no-deps --no-build-isolation -e .
	@touch $@

.venv/.dev: requirements-dev.txt .venv/.runtime
	@echo "installing what the tests and checks need"
	$(PIP) --require-hashes -r requirements-dev.txt
	@touch $@

.venv/.bench: requirements-bench.txt .venv/.runtime
	@echo "installing the peers of the benchmark"
	$(PIP) --require-hashes -r requirements-bench.txt
	@touch $@

.venv/.deploy: requirements-deploy.txt .venv/.dev
	@echo "installing what checks the chart"
	$(PIP) --require-hashes -r requirements-deploy.txt
	@touch $@

.venv/.docs: requirements-docs.txt .venv/.runtime
	@echo "installing what makes the site of the documentation"
	$(PIP) --require-hashes -r requirements-docs.txt
	@touch $@
