# Every target sets up what it needs, once, in .venvs/: python3, git and make are enough.
# Another interpreter: make test PYTHON=python3.13. Another Blender: make test-blender BPY=4.5. A Blender with its
# window: make test-blender-window BLENDER=blender.
PYTHON ?= python3
BPY ?=
BLENDER ?=
ONLY ?=
PIP_OPTIONS ?=
SECONDS_EACH ?= 400

TAG := $(shell $(PYTHON) -c 'import sys; print("%d.%d" % sys.version_info[:2])')
PLOT := .venvs/plot-$(TAG)
TEST := .venvs/test-$(TAG)
DEV := .venvs/dev-$(TAG)
TRAIN := .venvs/train-$(TAG)
ADDON := .venvs/addon-$(TAG)
BPY_VENV := .venvs/blender-$(TAG)$(if $(BPY),-$(BPY))

PHOTO := tests/data/plate.jpg
DEMO := demo_out
WINDOW := build/blender_window
DRIVE = $(PYTHON) -m tests.blender_window --blender '$(BLENDER)' --zip $(WINDOW)/zip --files $(WINDOW) --pictures $(WINDOW)/pictures
DATA ?=
RUN ?= runs/model
MODEL ?=

comma := ,

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help demo addon test fuzz faults test-training test-blender test-blender-window blender-pictures check format model docs bench clean

help:  ## list the targets
	@sed -n 's/^\([a-z-]*\):[^#]*## \(.*\)/  make \1\t\2/p' $(MAKEFILE_LIST) | expand -t 28

demo: $(PLOT)/ready  ## one photograph to LUTs, OCIO config, linear plate and sheet, in demo_out/
	@$(PLOT)/bin/crfnet estimate $(PHOTO) --out $(DEMO) --overwrite
	@$(PLOT)/bin/python tests/demo.py $(DEMO)

addon: $(ADDON)/ready  ## the Blender extension, one zip per platform and one for Linux distributions, in dist/ (downloads 160 MB, once)
	$(ADDON)/bin/python blender_addon/build.py

test: $(TEST)/ready  ## the tests; those that need Blender or torch are shown as skipped
	$(TEST)/bin/python -m pytest -n 2

fuzz: $(TEST)/ready  ## damaged files for an hour (SECONDS_EACH=400 of every test), before a release
	CRFNET_FUZZ_SECONDS=$(SECONDS_EACH) $(TEST)/bin/python -m pytest tests/fuzz

faults: $(TEST)/ready  ## every write, fsync, close, rename and removal fails once: EIO, ENOSPC, short, SIGKILL (half an hour)
	$(TEST)/bin/python -m tests.faults

test-training: $(TRAIN)/ready  ## the tests of training/ (installs torch)
	$(TRAIN)/bin/python -m pytest -n 2 tests/training

test-blender: $(BPY_VENV)/ready  ## the tests inside Blender (installs bpy; Python 3.11 or 3.13)
	$(BPY_VENV)/bin/python -m pytest tests/blender

test-blender-window: $(if $(BLENDER),$(WINDOW)/ready)  ## the same with its window: BLENDER=blender (xvfb, xdotool); ONLY=test_button
	@$(DRIVE) $(ONLY)

blender-pictures: $(if $(BLENDER),$(WINDOW)/ready)  ## the pictures of the panel in blender_addon/pictures anew: BLENDER=blender
	@$(DRIVE) --readme blender_addon/pictures test_pictures.TestPictures.test_dark_at_scale_1

check: $(DEV)/ready  ## format, lint, types and layers
	$(DEV)/bin/ruff format --check .
	$(DEV)/bin/ruff check .
	@mkdir -p build/names && ln -sfn ../../ocio build/names/crfnet  # the folder ocio under the name that it is installed as
	MYPYPATH=build/names $(DEV)/bin/mypy
	PYTHONPATH=build/names $(DEV)/bin/lint-imports

format: $(DEV)/ready  ## let ruff format and mend what it can
	$(DEV)/bin/ruff format .
	$(DEV)/bin/ruff check --fix .

model: $(TRAIN)/ready  ## train, export and evaluate the network anew (hours): make model DATA=FOLDER MODEL=FOLDER
	@test -d "$(DATA)/dorf" || { echo "make model DATA=FOLDER: a folder with dorf, camera_curves and linear"; exit 2; }
	@test -n "$(MODEL)" -a ! -e "$(MODEL)" || { echo "make model DATA=FOLDER MODEL=crfnet_core/models/photograph-statistics-2.5: a folder that does not exist yet"; exit 2; }
	$(TRAIN)/bin/python -m training.data.emor_basis --data $(DATA)
	$(TRAIN)/bin/python -m training.network.shards --data $(DATA) --out $(RUN)/photos
	$(TRAIN)/bin/python -m training.network.shards --data $(DATA) --out $(RUN)/photos --split validation --photographs 1000
	$(TRAIN)/bin/python -m training.network.train --shards $(RUN)/photos --run $(RUN)
	$(TRAIN)/bin/python -m training.export.model_folder --run $(RUN) --out $(MODEL) --golden $(RUN)/golden_predictions.npz
	$(TRAIN)/bin/python -m training.evaluation --data $(DATA) --model $(MODEL) --out $(RUN)/evaluation
	$(TRAIN)/bin/python -m training.export.model_card --model $(MODEL) --report $(RUN)/evaluation/report.json

docs: $(PLOT)/ready  ## the sample and the picture in docs/ anew
	$(PLOT)/bin/python docs/make_sample.py
	$(PLOT)/bin/python docs/make_picture.py

bench: $(PLOT)/ready  ## time and memory of the command, and of oiiotool on the same photograph
	$(PLOT)/bin/python -m tests.speed

clean:  ## remove everything that make made
	rm -rf .venvs $(DEMO) build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis
	find crfnet_core ocio training tests blender_addon -name __pycache__ -type d -prune -exec rm -rf {} +

# $(call install,extras[,requirement]): a virtual environment, complete or absent.
define install
	rm -rf $(@D)
	$(PYTHON) -m venv $(@D)
	$(@D)/bin/python -m pip install --quiet --disable-pip-version-check $(PIP_OPTIONS) --editable '.[$(1)]' $(2)
	touch $@
endef

# The zip, the plates and what the command says of them; where they are up to date, the test needs no environment.
$(WINDOW)/ready: $(shell find blender_addon crfnet_core ocio tests/blender_window/make_files.py -name '*.pyc' -o -name '*.png' -o -name '* *' -o -type f -print)
	$(MAKE) $(ADDON)/ready $(PLOT)/ready
	rm -rf $(WINDOW)
	$(ADDON)/bin/python blender_addon/build.py --platform linux-x64-any-python --out $(WINDOW)/zip
	$(PLOT)/bin/python -m tests.blender_window.make_files $(WINDOW)
	touch $@

# Bare: the builder needs pip alone.
$(ADDON)/ready:
	rm -rf $(@D)
	$(PYTHON) -m venv $(@D)
	touch $@

$(PLOT)/ready: pyproject.toml
	$(call install,plot)
$(TEST)/ready: pyproject.toml
	$(call install,test)
$(DEV)/ready: pyproject.toml
	$(call install,dev)
$(TRAIN)/ready: pyproject.toml
	$(call install,train$(comma)test)
$(BPY_VENV)/ready: pyproject.toml
	$(call install,blender$(comma)test,$(if $(BPY),'bpy==$(BPY).*'))
