# The two commands of the README and those behind them. Everything lives in .venv; nothing else is touched.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# Byte code is kept: the tests start hundreds of processes.
export PYTHONDONTWRITEBYTECODE :=

.PHONY: audit test test-fast test-long test-full coverage rule reports site clean

# The main job: audit the car-3 robot and write its report, with all that is wrong (--pedantic). Findings do not fail the command,
# a failure of urdfcheck does.
# SOURCE_DATE_EPOCH leaves the time out of the report, which is committed as a sample.
audit: $(VENV)/.installed
	@SOURCE_DATE_EPOCH=0 $(BIN)/urdfcheck fixtures/car-3 --pedantic --fail-on never -o html=reports/car-3.html
	@echo "report: reports/car-3.html"

# Formatting, types, rule pages, goldens, the hostile files, a browser, the real robots; of the modules marked long the tests marked smoke.
test: $(VENV)/.tested
	$(BIN)/python -m pytest --numprocesses auto --dist worksteal -m "not long or smoke"

# The inner loop: all but the modules that start many processes or a browser or take seconds each (marked slow), in a minute on two cores.
test-fast: $(VENV)/.tested
	$(BIN)/python -m pytest --numprocesses auto --dist worksteal -m "not slow"

# What make test leaves out: faults of the machine, planted files, every control of the report, repairs of geometry, offers on robots.
test-long: $(VENV)/.tested $(VENV)/.documented
	$(BIN)/python -m pytest --numprocesses auto --dist worksteal -m "long and not smoke"

# Everything, with every real robot and more examples of each property: before a release.
test-full: $(VENV)/.tested $(VENV)/.documented
	URDFCHECK_FULL=1 $(BIN)/python -m pytest --numprocesses auto --dist worksteal

# Branch coverage by room, against the floors in tools/check_coverage.py; about twice the time of make test.
coverage: $(VENV)/.tested $(VENV)/.documented
	COVERAGE_FILE=$(CURDIR)/.coverage $(BIN)/python -m pytest --numprocesses auto --dist worksteal --cov --cov-report=json
	$(BIN)/python tools/check_coverage.py

# One rule alone: make rule CODE=NAM008 tests its page, its style and its types in seconds.
rule: $(VENV)/.tested
	@test -n "$(CODE)" || { echo "usage: make rule CODE=NAM008"; exit 2; }
	@$(BIN)/python -m urdfcheck.dev rule $(CODE)

# The index of the rules, the pages about the model, the command line, the configuration and what was measured, the table of the hostile files and the sample reports; tests say when they are stale.
reports: $(VENV)/.installed
	$(BIN)/python tools/make_rules_index.py
	$(BIN)/python tools/make_model_page.py
	$(BIN)/python tools/make_command_page.py
	$(BIN)/python tools/make_configuration_page.py
	$(BIN)/python tools/make_truth_page.py
	$(BIN)/python tools/make_hostile_table.py
	$(BIN)/python tools/make_reports.py

# The documentation as a site, in site/: python -m http.server -d site shows it.
site: $(VENV)/.documented
	$(BIN)/python tools/make_site.py

$(VENV)/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10))' || { echo "urdfcheck needs Python 3.10 or newer"; exit 2; }
	@$(PYTHON) -m venv $(VENV) || { echo "python3 -m venv does not work here; on Debian and Ubuntu: sudo apt install python3-venv"; exit 2; }

$(VENV)/.installed: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --upgrade "pip>=25.1"
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	@touch $@

$(VENV)/.tested: $(VENV)/.installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --group test
	@touch $@

$(VENV)/.documented: $(VENV)/.installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --group docs
	@touch $@

clean:
	rm -rf $(VENV) site
