# BEATRIX: `make demo` shows it, `make test` tests it; both first set up .venv. `make help` lists all targets.

MAKEFLAGS += --no-print-directory
.DEFAULT_GOAL := help
.PHONY: help demo test test-long coverage check bench figures soak bundle release model firmware generate docs site platforms lock

BIN := .venv/bin
FOUND := $(wildcard beatrix_zenoh sim_node hw_node gui)
# The first Python that starts and is new enough: a name on PATH may be a shim without a Python behind it.
PYTHON := $(shell for name in python3 python3.14 python3.13 python3.12 python3.11; do \
	$$name -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo $$name && break; done)
# Three processes keep two cores busy, because their tests often wait for robots. With more processes, robots get too
# little processor time: nodes lose their router. A CI computer may be slow: it runs two.
PROCESSES := $(if $(CI),2,3)
TESTS = $(BIN)/python tools/crash.py $(BIN)/pytest -n $(PROCESSES) --dist loadscope --no-loadscope-reorder --max-worker-restart 0
SETUP = $(if $(PYTHON),$(PYTHON) tools/setup.py,$(error BEATRIX needs Python 3.11 or newer on PATH. Install one, then try again))

help: ## print this list
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' Makefile | expand -t 12

demo: ## show the robot's twin on this computer (needs only Python 3.11)
	@$(SETUP) demo
	$(BIN)/beatrix demo

# After a crash of a process the run ends and names the test; pytest-xdist could otherwise wait forever. tools/crash.py
# prints the stacks of all threads of the process.
test: ## run the tests that decide about a change, in parallel: some minutes
	@$(SETUP) test
	$(TESTS) -m "not long"

test-long: ## run the tests that are marked `long`: real screens, browsers and boards, all lessons, storms
	@$(SETUP) test
	$(TESTS) -m long

coverage: ## run all tests, and measure branch coverage
	@$(SETUP) test
	$(TESTS) --cov --cov-report=term --cov-fail-under=90

check: ## check style, types, layers, contract, links and firmware, without running BEATRIX
	@$(SETUP) test
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy $(FOUND) schemas tools tests
	for system in win32 darwin; do \
		$(BIN)/mypy --platform $$system --cache-dir .mypy_cache/$$system $(FOUND) || exit 1; done
	$(BIN)/lint-imports --no-cache
	$(BIN)/python schemas/generate.py --check
	$(BIN)/python tools/links.py
	$(MAKE) -C firmware check

bench: ## measure the figures of the design on this computer
	@$(SETUP) test
	$(BIN)/python tools/bench.py

figures: ## measure them, and write docs/reference/figures.md
	@$(SETUP) test
	$(BIN)/python tools/figures.py

soak: ## run everything for HOURS (2), and write what grows or is lost into docs/reference/soak.md
	@$(SETUP) test
	$(BIN)/python tools/soak.py --hours $(or $(HOURS),2) --page docs/reference/soak.md

bundle: ## write one archive for a room without network (BUNDLE="--platform windows-x86_64 --python 3.12 --extras cli,gui")
	@$(SETUP) test
	$(BIN)/python tools/bundle.py $(BUNDLE)

release: ## build wheel, sdist and bill of materials into build/release, and check them
	@$(SETUP) test
	$(BIN)/beatrix install all
	$(BIN)/python tools/release.py

model: ## write the robot as MJCF and URDF for other programs, into build/robot
	@$(SETUP) test
	rm -rf build/robot && mkdir -p build/robot
	$(BIN)/beatrix model build/robot/beatrix.xml
	$(BIN)/beatrix model build/robot/beatrix.urdf

firmware: ## build the firmware for the virtual board and the Mega
	@$(SETUP) test
	$(MAKE) -C firmware

generate: ## write all files that are generated from schemas/*.toml
	@$(SETUP) test
	$(BIN)/python schemas/generate.py

docs: generate ## write reference pages and generated tables, and check links between pages
	$(BIN)/python tools/commands_page.py
	$(BIN)/python tools/neck_page.py
	$(BIN)/python tools/lesson_table.py
	$(BIN)/python tools/robot_drawings.py
	$(BIN)/python tools/links.py

site: ## build the site of docs/ with search and Python reference into build/site, and check its links
	@$(SETUP) site
	rm -rf build/site
	$(BIN)/sphinx-build --quiet --fail-on-warning --jobs 2 -c tools/website . build/site
	$(BIN)/python tools/check_site.py build/site

platforms: ## ask the registry what can be installed on other systems, and write the page about it (needs uv)
	@$(SETUP) test
	$(BIN)/python tools/platforms.py

lock: ## choose new versions of all packages that BEATRIX depends on (needs uv)
	uv pip compile pyproject.toml --all-extras --group pyproject.toml:dev --group pyproject.toml:site --universal --python-version 3.11 \
		--upgrade --no-header --quiet --output-file constraints.txt
