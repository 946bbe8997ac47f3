# Every target sets up what it needs first: `make pneunet` works in a fresh clone.
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.ONESHELL:
.DEFAULT_GOAL := help

BIN := .venv/bin
READY := .venv/.ready
# with the packages for tests, style and documentation
DEV := .venv/.ready-dev
PEERS := .venv-peers
# those with the longest points first
paper_sweeps := lengths cells heights arms pneunet contact forces
# designs drawn at random: their seed, how many in all, on a finer mesh too, at the same time (all cores unless given),
# the law of the rod, and the sizes of their elements over those that the program chooses
SEED := 7
N := 40
FINER := 8
JOBS :=
LAW := both
LARGER := 1

all_targets := pneunet pneunet-coarse golden semicircular semicircular-single bisected-circle all effects cell budget design material sweep paper-coarse paper accuracy
.PHONY: help setup $(all_targets) kernels test slow hard fuzz kills unseen exports space experiments measured-arms in-time virtual-arms foreign portable nightly wheel recipes lint reading types docs doctor bench-peers bench-run clean

help:  ## list the targets
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## (.*)/make \1\t\2/' | expand -t 26

setup: $(READY)  ## virtual environment, pinned packages and system libraries (implied by all others)

pneunet: $(READY)  ## the gapped pneu-net arm: five parameters and a report in results/pneunet
	@$(BIN)/pneurod run configs/pneunet.yaml --out results/pneunet

pneunet-coarse: $(READY)  ## the same arm on a coarse mesh, in less time
	@$(BIN)/pneurod run configs/pneunet_coarse.yaml --out results/pneunet_coarse

golden: $(DEV)  ## the coarse arm, and its numbers against those kept from an earlier version
	@$(BIN)/pneurod run configs/pneunet_coarse.yaml --accuracy off --jobs 1 --fresh --out results/golden
	$(BIN)/python -m tests.golden results/golden

semicircular: $(READY)  ## the semicircular arm with 11 cavities
	@$(BIN)/pneurod run configs/semicircular.yaml --out results/semicircular

semicircular-single: $(READY)  ## the semicircular arm with one cavity
	@$(BIN)/pneurod run configs/semicircular_single.yaml --out results/semicircular_single

bisected-circle: $(READY)  ## the bisected circle
	@$(BIN)/pneurod run configs/bisected_circle.yaml --out results/bisected_circle

all: pneunet semicircular semicircular-single bisected-circle  ## the four designs of the paper

effects: $(READY)  ## influence and cost of each effect on the coarse arm
	@$(BIN)/pneurod effects configs/pneunet_coarse.yaml --out results/effects

cell: $(READY)  ## the arm's own law of the four coarse arms: table and pictures in results/cell_*
	@for arm in pneunet semicircular semicircular_single bisected_circle; do
		$(BIN)/pneurod cell configs/$${arm}_coarse.yaml --out results/cell_$${arm}
	done

budget: $(READY)  ## what tolerances of a cast arm do to the four coarse arms: table and picture in results/cell_*
	@for arm in pneunet semicircular semicircular_single bisected_circle; do
		[ -f results/cell_$${arm}/law.json ] || $(BIN)/pneurod cell configs/$${arm}_coarse.yaml --out results/cell_$${arm}
		$(BIN)/pneurod budget results/cell_$${arm}
	done

design: $(READY)  ## dimensions for a wish, of two arms that are known: results/wish_pneunet and results/wish_semicircular
	@$(BIN)/pneurod design examples/wish_pneunet.yaml
	$(BIN)/pneurod design examples/wish_semicircular.yaml

sweep: $(READY)  ## nine designs of a short arm, inflated: table and picture in results/walls_and_heights
	@$(BIN)/pneurod sweep examples/sweep.yaml

paper-coarse: $(DEV)  ## figures and claims of the paper reproduced on coarse meshes, in results/paper_coarse
	@$(BIN)/pneurod sweep $(paper_sweeps:%=configs/paper/coarse/%.yaml) --out results/paper_coarse || [ $$? -eq 1 ]
	$(BIN)/python -m benchmarks.paper.random_cells --out results/paper_coarse
	$(BIN)/python -m benchmarks.paper results/paper_coarse

paper: $(DEV)  ## the same on the meshes of the shipped configurations, in results/paper
	@$(BIN)/pneurod sweep $(paper_sweeps:%=configs/paper/fine/%.yaml) --out results/paper || [ $$? -eq 1 ]
	$(BIN)/python -m benchmarks.paper.random_cells --out results/paper
	$(BIN)/python -m benchmarks.paper results/paper

material: $(DEV)  ## the law to take from the tensile tests of the example (or FILES=...); how well known laws come back
	@$(BIN)/pneurod material $(or $(FILES),configs/elastosil_m4601_yeoh.csv) --out results/material
	$(BIN)/python -m tests.specimens

accuracy: $(READY)  ## convergence studies of the four coarse arms, in results/*_accuracy
	@for arm in semicircular semicircular_single bisected_circle; do
		$(BIN)/pneurod accuracy configs/$${arm}_coarse.yaml --out results/$${arm}_accuracy
	done
	# beyond 20 kPa the finest mixed meshes reach the limit of the St. Venant-Kirchhoff law at the clamp of this arm
	$(BIN)/pneurod accuracy configs/pneunet_coarse.yaml --set "pressures=[17 kPa, 20 kPa]" --out results/pneunet_accuracy
	# with Hencky's law they reach 45 kPa
	$(BIN)/pneurod accuracy configs/pneunet_coarse.yaml --set material.law=hencky --set "pressures=[5 kPa, 17 kPa, 31 kPa, 45 kPa]" --out results/pneunet_hencky_accuracy

kernels: $(DEV)  ## compile what the solvers need, once for all processes of the tests
	@$(BIN)/python -m tests.kernels

# one process per core; with more threads of the linear algebra they wait for each other, and take three times as long
test: export OMP_NUM_THREADS := 1
# tests are compiled once, and not by each process again
test: export PYTHONDONTWRITEBYTECODE :=
test: $(DEV) kernels  ## all tests but the slow ones
	@# a test that hangs fails after a quarter of an hour, with the lines it stands at; the longest takes a minute
	$(BIN)/python -m pytest -n auto --maxprocesses 4 --dist worksteal --timeout 900 --durations 15

slow: $(DEV)  ## the tests that take longer, and whole runs that repeat what faster tests do
	@$(BIN)/python -m pytest -m slow

hard: $(DEV)  ## hard cases: each is solved and checked, or its limit is named; the table of studies/hard_cases.md
	@$(BIN)/python -m tests.hard_cases.run_all

fuzz: $(DEV)  ## two thousand valid and invalid configurations: each is meshed or refused in one sentence
	@$(BIN)/python -m pytest -m slow tests/pipeline/config/test_fuzzed.py --hypothesis-show-statistics

kills: $(DEV)  ## fifty runs killed at random times and continued, compared with uninterrupted runs
	@$(BIN)/python benchmarks/kills.py

unseen: $(DEV)  ## N=40 designs drawn at random with SEED=7, run (JOBS at a time), checked and sorted by their outcome; a table
	@$(BIN)/python -m benchmarks.unseen --seed $(SEED) --count $(N) --finer $(FINER) $(addprefix --jobs ,$(JOBS)) --law $(LAW) --larger $(LARGER)

exports: $(DEV)  ## eight arms in MuJoCo, PyElastica and other programs against finite elements; the table of studies/rods.md
	@$(BIN)/python -m benchmarks.exports

space: $(DEV)  ## arms bent out of their plane, and one with three chambers: rods against finite elements of whole arms; tables
	@$(BIN)/python -m benchmarks.space
	@$(BIN)/python -m benchmarks.three_chambers

foreign: $(DEV)  ## bodies as other programs write them, meshed and bent; a table
	@$(BIN)/python -m benchmarks.foreign

experiments: $(DEV)  ## measured bodies: error before and after a calibration; the table of docs/experiments.md
	@$(BIN)/python -m benchmarks.experiments
	@$(BIN)/python -m benchmarks.experiments.segment
	@$(BIN)/python -m benchmarks.experiments.wound_chambers

measured-arms: $(DEV)  ## measured pneumatic arms: one is calibrated, two are predicted; docs/measured_arms.md
	@$(BIN)/python -m benchmarks.measured_arms

in-time: $(DEV)  ## a released bar, a held segment, and finite elements in time beside rods; the table of studies/in_time.md
	@$(BIN)/python -m benchmarks.in_time

virtual-arms: $(DEV)  ## twenty arms built otherwise than drawn, predicted after a calibration; a table, and a plot in results/virtual_arms
	@$(BIN)/python -m benchmarks.virtual_arms

# instructions that every processor has, sums in another order, and kernels that are compiled for it; these round
# differently when they are compiled and when they are loaded, so that the arm is run with both
portable: export NUMBA_CPU_NAME := generic
portable: export MKL_CBWR := COMPATIBLE
portable: export OPENBLAS_CORETYPE := Nehalem
portable: export NUMBA_CACHE_DIR := $(CURDIR)/build/portable_kernels
portable: export OMP_NUM_THREADS := 1
portable: $(DEV)  ## all tests but the slow ones, and the numbers of the coarse arm, as another processor rounds
	@status=0
	rm -rf $$NUMBA_CACHE_DIR
	for kernels in compiled loaded; do
		$(BIN)/pneurod run configs/pneunet_coarse.yaml --accuracy off --jobs 1 --fresh --out results/portable_$$kernels
		$(BIN)/python -m tests.golden results/portable_$$kernels || status=1
	done
	$(BIN)/python -m tests.kernels
	$(BIN)/python -m pytest -n auto --maxprocesses 4 --dist worksteal --timeout 900 || status=1
	exit $$status

nightly: $(DEV)  ## for a scheduler: make portable, hard cases, slow tests, and 40 designs with the date as the seed
	@status=0
	$(MAKE) --no-print-directory portable || status=1
	$(BIN)/python -m tests.hard_cases.run_all || status=1
	$(BIN)/python -m pytest -m slow || status=1
	$(BIN)/python -m benchmarks.unseen --seed $$(date +%Y%m%d) --count 40 --finer 40 --law both || status=1
	exit $$status

wheel: $(DEV)  ## the wheel, built, installed into a fresh environment outside the checkout and run there
	@$(BIN)/python -m pytest -m "slow or not slow" tests/test_packaging.py

recipes: $(DEV)  ## the programs in examples/ again, with text and pictures for their pages: NAME="gripper swing" for some
	@MPLBACKEND=agg $(BIN)/python docs/hooks/recipes.py $(NAME)

lint: $(DEV)  ## style: ruff
	@$(BIN)/ruff check .
	$(BIN)/ruff format --check .

reading: $(DEV)  ## what a file asks its reader to know: names and files that it imports, circles of folders, ceilings
	@$(BIN)/python -m tests.reading

types: $(DEV)  ## types: mypy
	@$(BIN)/mypy
	$(BIN)/mypy examples
	$(BIN)/mypy --explicit-package-bases benchmarks

docs: $(DEV)  ## the documentation as a site in build/site; broken links and warnings are refused
	@NO_MKDOCS_2_WARNING=1 PYTHONPATH=. $(BIN)/mkdocs build --strict --quiet
	echo "open build/site/index.html"

doctor: $(READY)  ## what is installed, what is missing, and the command that installs it
	@$(BIN)/pneurod doctor

bench-peers: $(DEV) $(PEERS)/.ready  ## pneurod compared with NGSolve and FElupe: tables (six minutes on a machine without other load)
	@$(BIN)/python -m benchmarks.peers --python $(PEERS)/bin/python

bench-run: $(DEV)  ## make pneunet from this checkout and from OTHER=../other in turn: times, memory, whether results agree
	@$(BIN)/python benchmarks/run.py $(or $(OTHER),$(error give another checkout: make bench-run OTHER=../other))

clean:  ## remove results and caches; the virtual environments stay
	@rm -rf results build .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -path './.venv*' -prune -o -name __pycache__ -type d -print0 | xargs -0 rm -rf

$(READY): pyproject.toml requirements.lock pipeline/system_packages.txt setup.sh
	@bash setup.sh
	touch $@

$(DEV): pyproject.toml requirements.lock pipeline/system_packages.txt setup.sh
	@bash setup.sh dev
	touch $(READY) $@

$(PEERS)/.ready: benchmarks/peers/requirements.txt | $(DEV)
	@$(BIN)/python -m venv --clear $(PEERS)
	$(PEERS)/bin/python -m pip install --quiet --disable-pip-version-check --requirement $<
	touch $@
