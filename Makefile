# The commands of this project; `make help` lists them. The building itself is CMake's: this file
# sets the machine up, once, and calls it. Variables, given as `make test PYTHON=python3.11`:
#   PYTHON              the Python >= 3.11 that makes .venv
#   MESHLAB_SOURCE_DIR  a checkout of MeshLab 2025.07 with its submodules; else Debian's source
#                       package is fetched into build/
#   WARNINGS_AS_ERRORS  ON: a compiler warning fails the build; OFF; not given: as the tree was built
#   TEST_OPTIONS        of pytest in `make test`, such as --without-posix: as on Windows
#   MESHES              the folder of the meshes that `make screenshots` shows
#   PICTURES            of `make screenshots`: only these, such as "denoise colors", none of MeshLab
#   INSTALL             ON: `make web` installs Emscripten, from Debian
#   BENCH_MESH          the mesh of the C++ benchmarks
#   BENCH_OPTIONS       of `make bench-basis`, `bench-contract`, `bench-defaults`, `bench-denoise`, `bench-memory`, `bench-signatures`, `bench-texture`, `bench-tiles`; --help lists them
#   PROMISES_OPTIONS    of `make promises`, such as '--only artefacts speed'; --help lists them
#   FUZZ_OPTIONS        of `make fuzz`; tests/fuzz/fuzz_core.cpp lists them
#   FUZZ_EXAMPLES       of `make fuzz-python`: how many, about 20 a second
#   SANITIZE            ON: `make fuzz` with AddressSanitizer and UndefinedBehaviorSanitizer
PYTHON ?= python3
MESHLAB_SOURCE_DIR ?=
WARNINGS_AS_ERRORS ?=
MESHES ?= ../shared/data
PICTURES ?=
BENCH_MESH ?= $(MESHES)/dragon_40k.ply
BENCH_OPTIONS ?=
PROMISES_OPTIONS ?=
TEST_OPTIONS ?=
INSTALL ?= OFF
FUZZ_OPTIONS ?= --cases 1000000
FUZZ_EXAMPLES ?= 5000
SANITIZE ?= OFF

# Containers often set it: every process would then compile anew all that it imports.
unexport PYTHONDONTWRITEBYTECODE

BENCHMARKS := OFF
BIN := .venv/bin
CMAKE_OPTIONS = $(if $(WARNINGS_AS_ERRORS),-DSPECTRAL_WARNINGS_AS_ERRORS=$(WARNINGS_AS_ERRORS)) \
  -Dmuparser_DIR=$(MUPARSER)/lib/cmake/muparser -DPython3_EXECUTABLE=$(CURDIR)/$(BIN)/python \
  $(if $(MESHLAB_SOURCE_DIR),-DMESHLAB_SOURCE_DIR=$(abspath $(MESHLAB_SOURCE_DIR)))
# One tree of objects for the package, its wheel, the tests and the benchmarks.
MODULE_OPTIONS := --quiet --disable-pip-version-check --no-index --no-build-isolation --no-deps \
  --config-settings=build-dir="$(CURDIR)/build"
PACKAGE_OPTIONS := $(MODULE_OPTIONS) --config-settings=cmake.define.SPECTRAL_BUILD_TESTS=ON

# Stamp files live in the folder they describe, so that deleting .venv or build/ is enough to
# have it set up again.
PACKAGES := build/.packages
VENV := .venv/.requirements
# That of pymeshlab's wheel; and what a plugin finds in its host, MeshLab or pymeshlab.
MANYLINUX := manylinux_2_35_$(shell uname -m)
HOST_LIBRARIES := libmeshlab-common.so libQt5Core.so.5 libQt5Gui.so.5 libQt5Widgets.so.5 libQt5Xml.so.5 libQt5OpenGL.so.5
PACKAGE := .venv/.package
# The package without MeshLab's plugin: what the demonstration needs.
MODULE := .venv/.module
WITHOUT_PLUGIN := -DSPECTRAL_BUILD_PLUGIN=OFF -DSPECTRAL_BUILD_PYTHON=OFF -DSPECTRAL_BUILD_TESTS=OFF
# Part of the package's libraries: pymeshlab has a shared one of the same name, which is not the system's.
MUPARSER := $(CURDIR)/build/muparser
COMPETITORS := .venv/.competitors

CPP_FILES = find plugin tests -name '*.h' -o -name '*.cpp'
PYTHON_FILES = python tests screenshots
# With the folders themselves, whose time changes when a file in them goes.
PACKAGE_SOURCES := CMakeLists.txt $(shell find plugin python -not -path '*/__pycache__*' \
  -not -path 'python/docs*' -not -path 'plugin/web*')

# Two targets at once would fetch MeshLab's headers twice; ninja uses every core anyway.
.NOTPARALLEL:
.DELETE_ON_ERROR:
.PHONY: help demo test quick wheel sdist web web-test docs gui-test screenshots setup build bench-basis bench-batch bench-contract bench-defaults bench-denoise bench-ldlt bench-memory bench-signatures bench-texture bench-tiles promises fuzz fuzz-python lint options format clean

help:  ## list these commands
	@sed -n 's/^\([a-z-]*\):.*## /  make \1\t/p' $(firstword $(MAKEFILE_LIST)) | expand -t 20

demo: $(if $(wildcard $(PACKAGE)),$(PACKAGE),$(MODULE))  ## filter the Stanford bunny: report, mesh and picture in build/demo
	@mkdir -p build/demo
	$(BIN)/python screenshots/scripts/demo.py build/demo

test: build $(PACKAGE)  ## run every test, C++ and Python
	ctest --test-dir build --output-on-failure --no-tests=error --parallel $$(nproc)
	$(BIN)/python -m pytest -c python/pyproject.toml --rootdir . --numprocesses $$(nproc) --dist loadfile \
	  $(TEST_OPTIONS) tests/python

quick: build  ## run the tests of what has changed since main, and the contract's: a minute
	$(BIN)/python tests/quick.py

wheel: $(PACKAGE)  ## build the wheel that PyPI takes: build/wheel/*.whl
	rm -rf build/wheel/linux build/wheel/*.whl
	$(BIN)/meshlab-spectral --man > build/meshlab-spectral.1
	CMAKE_ARGS="$(CMAKE_OPTIONS) -DSPECTRAL_MANUAL=$(CURDIR)/build/meshlab-spectral.1" $(BIN)/pip wheel $(PACKAGE_OPTIONS) --wheel-dir build/wheel/linux ./python
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/auditwheel repair --plat $(MANYLINUX) --wheel-dir build/wheel \
	  $(patsubst %,--exclude %,$(HOST_LIBRARIES)) build/wheel/linux/*.whl

sdist: $(VENV)  ## build the source package: build/sdist/*.tar.gz
	rm -rf build/sdist && mkdir -p build/sdist/tree
	cp -r CMakeLists.txt LICENSE plugin python/README.md python/pyproject.toml python/src build/sdist/tree
	sed -i 's|"\.\."|"."|; s|"\.\./CMakeLists\.txt"|"CMakeLists.txt"|' build/sdist/tree/pyproject.toml
	cd build/sdist/tree && $(CURDIR)/$(BIN)/python -c \
	  'from scikit_build_core.build import build_sdist; print(build_sdist(".."))'

web:  ## build spectral-mesh for browsers and Node: build/web/*.tgz (needs Emscripten; INSTALL=ON installs it)
	$(if $(filter ON,$(INSTALL)),plugin/cmake/install_debian_packages.sh plugin/web/debian_packages.txt)
	plugin/web/build.sh build/web
	node plugin/web/npm/package.mjs build/web/module build/web/spectral-mesh
	rm -f build/web/*.tgz
	! command -v npm >/dev/null || npm pack --silent --pack-destination build/web ./build/web/spectral-mesh
	rm -rf build/web/site && mkdir -p build/web/site && cp -r plugin/web/page build/web/site/browser
	cp -r build/web/spectral-mesh build/web/site/browser/

web-test: web $(PACKAGE)  ## test spectral-mesh in Node, and its page in Chromium and Firefox of Debian
	plugin/cmake/install_debian_packages.sh tests/web/debian_packages.txt
	mkdir -p build/web/tests && cp tests/web/package*.json build/web/tests
	npm ci --silent --ignore-scripts --prefix build/web/tests
	$(BIN)/python -m pytest -c python/pyproject.toml --rootdir . tests/python/web

docs: $(PACKAGE)  ## write the reference of filters and Python API: build/docs/index.html
	rm -rf build/docs
	$(BIN)/python -m sphinx --fail-on-warning --keep-going --quiet python/docs build/docs

gui-test: $(PACKAGE)  ## test in the real MeshLab 2025.07, made once (Linux, root or sudo)
	tests/gui/run.sh

screenshots: $(PACKAGE)  ## redraw the pictures in screenshots/ and their numbers
	PYTHONPATH=tests/benchmarks $(BIN)/python screenshots/scripts/draw.py $(MESHES) screenshots $(PICTURES)
	$(if $(PICTURES),,tests/gui/run.sh tests/gui/screenshots.py)

setup: $(PACKAGES) $(VENV)  ## install what is missing: Debian packages, .venv

build: $(PACKAGE)  ## compile the package and the C++ tests, in build/
	cmake -S . -B build -DSPECTRAL_BUILD_BENCHMARKS=$(BENCHMARKS) $(CMAKE_OPTIONS)
	cmake --build build

bench-defaults: $(PACKAGE)  ## the run with every parameter at its default, on real meshes
	$(BIN)/python tests/benchmarks/bench_defaults.py $(BENCH_OPTIONS)

bench-denoise: $(PACKAGE)  ## denoising against MeshLab's, VTK's and bilateral normals, by ground truth
	$(BIN)/python tests/benchmarks/bench_denoise.py $(BENCH_OPTIONS)

bench-contract: $(PACKAGE)  ## every filter at three settings on real meshes: outcomes, texts
	$(BIN)/python tests/benchmarks/bench_contract.py $(BENCH_OPTIONS)

bench-memory: $(PACKAGE)  ## memory of many runs, and of a large mesh with and without a limit
	$(BIN)/python tests/benchmarks/bench_memory.py $(BENCH_OPTIONS)

bench-tiles: $(PACKAGE)  ## meshes of millions of vertices, filtered in tiles: memory and time
	$(BIN)/python tests/benchmarks/bench_tiles.py $(BENCH_OPTIONS)

bench-basis: BENCHMARKS := ON
bench-basis: build $(PACKAGE) $(COMPETITORS)  ## compare the truncated basis with other programs
	$(BIN)/python tests/benchmarks/bench_basis.py --mesh $(BENCH_MESH) $(BENCH_OPTIONS)

bench-signatures: $(PACKAGE) $(COMPETITORS)  ## compare Shape-DNA and signatures with LaPy and pyFM
	$(BIN)/python tests/benchmarks/bench_signatures.py $(BENCH_OPTIONS)

bench-texture: $(PACKAGE) $(COMPETITORS)  ## compare surface texture with surfalize
	$(BIN)/python tests/benchmarks/bench_texture.py $(BENCH_OPTIONS)

bench-ldlt: BENCHMARKS := ON
bench-ldlt: $(COMPETITORS) build  ## compare the factorization with Eigen's and CHOLMOD's
	build/tests/benchmarks/bench_ldlt $(BENCH_MESH)

bench-batch: $(PACKAGE)  ## measure a batch of 1,000 meshes against one process
	$(BIN)/python tests/benchmarks/bench_batch.py

promises: $(PACKAGE)  ## ask every number that READMEs and benchmarks promise; ten minutes
	PYTHONPATH=tests/benchmarks:tests/python $(BIN)/python -m promises $(PROMISES_OPTIONS)

SANITIZED := $(filter ON,$(SANITIZE))
fuzz: $(if $(SANITIZED),setup,build)  ## try the core with random meshes and options; about half an hour
ifdef SANITIZED
	cmake -S . -B build/sanitized -G Ninja -DSPECTRAL_BUILD_PLUGIN=OFF -DSPECTRAL_SANITIZE=ON
	cmake --build build/sanitized --target fuzz_core
endif
	build/$(if $(SANITIZED),sanitized/)tests/fuzz/fuzz_core $(FUZZ_OPTIONS)

fuzz-python: $(PACKAGE)  ## try filters and commands with random meshes, parameters, arguments
	MESHLAB_SPECTRAL_FUZZ=$(FUZZ_EXAMPLES) $(BIN)/python -m pytest -c python/pyproject.toml \
	  --rootdir . tests/python/fuzz

lint: setup  ## check style and types, change nothing
	$(CPP_FILES) | xargs $(BIN)/clang-format --dry-run -Werror
	$(BIN)/ruff check --config python/pyproject.toml $(PYTHON_FILES)
	$(BIN)/ruff format --check --config python/pyproject.toml $(PYTHON_FILES)
	cd python/src && "$(CURDIR)/$(BIN)/lint-imports" ../pyproject.toml --no-cache
	printf '%s\n' linux win32 darwin | xargs -P "$$(nproc)" -I {} $(BIN)/mypy --strict --platform {} \
	  --cache-dir .mypy_cache/{} --config-file python/pyproject.toml python/src \
	  tests/python/filters/test_types.py

options: $(PACKAGE)  ## write the tables of options of the Python package as the core has them
	$(BIN)/python python/write_options.py
	$(MAKE) $(PACKAGE)

format: setup  ## rewrite the sources in the project's style
	$(CPP_FILES) | xargs $(BIN)/clang-format -i
	$(BIN)/ruff check --fix --config python/pyproject.toml $(PYTHON_FILES)
	$(BIN)/ruff format --config python/pyproject.toml $(PYTHON_FILES)

clean:  ## delete what was built, and .venv
	rm -rf build .venv

$(PACKAGES): plugin/cmake/debian_packages.txt plugin/cmake/install_debian_packages.sh
	plugin/cmake/install_debian_packages.sh $<
	@mkdir -p $(@D) && touch $@

# Wheels only: no package gets to run a set-up script, and none needs a compiler. Python compiles
# what is imported, a small part. --no-deps: the list is whole.
$(VENV): python/requirements.txt | $(PACKAGES)
	$(PYTHON) -m venv .venv
	$(BIN)/pip install --no-deps --no-compile --quiet --disable-pip-version-check --only-binary :all: --require-hashes -r $<
	@touch $@

# What the basis, the signatures and texture are compared with. scikit-sparse alone has no wheel.
$(COMPETITORS): tests/benchmarks/requirements.txt tests/benchmarks/scikit_sparse.txt \
  tests/benchmarks/debian_packages.txt $(VENV)
	plugin/cmake/install_debian_packages.sh tests/benchmarks/debian_packages.txt
	$(BIN)/pip install --quiet --disable-pip-version-check --only-binary :all: --require-hashes -r $<
	$(BIN)/pip install --quiet --disable-pip-version-check --no-build-isolation --no-deps \
	  --require-hashes -r tests/benchmarks/scikit_sparse.txt
	@touch $@

# The core needs nothing of Python's: it is compiled while pip, on one core, fetches and unpacks. What
# fails in it fails again, and is told, when the package is built.
$(MODULE): python/requirements.txt $(PACKAGE_SOURCES) | $(PACKAGES)
	@echo 'Fetching Python packages and building the core: three minutes at first'
	plugin/cmake/static_muparser.sh $(MUPARSER) >/dev/null
	@$(MAKE) --no-print-directory $(VENV) & venv=$$!; \
	  cmake -S . -B build -G Ninja --no-warn-unused-cli $(WITHOUT_PLUGIN) $(CMAKE_OPTIONS) >/dev/null && \
	  cmake --build build --target spectral_core >/dev/null; wait $$venv
	CMAKE_ARGS="$(CMAKE_OPTIONS)" $(BIN)/pip install $(MODULE_OPTIONS) --force-reinstall \
	  --config-settings=cmake.define.SPECTRAL_BUILD_PLUGIN=OFF --config-settings=build.targets=_core ./python
	@touch $@

# Built by scikit-build-core in a folder that is kept, so that a changed file costs its own compilation
# only. --force-reinstall: the version is the same.
$(PACKAGE): $(VENV) $(PACKAGE_SOURCES)
	@echo 'Building the plugin and installing the package: about a minute at first'
	plugin/cmake/static_muparser.sh $(MUPARSER) >/dev/null
	CMAKE_ARGS="$(CMAKE_OPTIONS)" $(BIN)/pip install $(PACKAGE_OPTIONS) --force-reinstall ./python
	@touch $@
