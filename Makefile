# `make` lists what there is. Everything here is a plain cargo command as well, after `make setup`.

# Where `make install` puts things: $(DESTDIR)$(PREFIX)/bin and lib. Most shells pass on the ~ of
# PREFIX=~/.local as it is.
PREFIX ?= $(HOME)/.local
override PREFIX := $(patsubst ~/%,$(HOME)/%,$(PREFIX))
CARGO ?= cargo

ENVERS = $${CARGO_TARGET_DIR:-target}/release/envers
TUTORIAL = $(sort $(wildcard assets/scenes/tutorial/*.toml))
SCENES = $(sort $(wildcard assets/scenes/*.toml))
GALLERY = $(sort $(wildcard assets/scenes/gallery/*.toml))

# The other build that must always work: no Embree, no libclang.
PURE_RUST = --no-default-features --features cli

.PHONY: help setup demo gallery test check soak deny install uninstall clean

help: ## list the targets
	@sed -n 's/^\([a-z]*\):.*## \(.*\)/  make \1\t\2/p' $(firstword $(MAKEFILE_LIST)) | expand -t 18

setup: ## find or fetch Embree and libclang (the others call it where they need it)
	@scripts/setup

# Prints each file with its seconds, and what validate says of each scene in either precision, at
# one sample per pixel: the pure-Rust intersector takes its time.
demo: setup ## build, and render and validate the demo scenes into out/
	$(CARGO) build --release --locked
	@mkdir -p out
	@set -e; for scene in $(TUTORIAL); do \
	    $(ENVERS) render $$scene -o out/$$(basename $$scene .toml).png; \
	done
	@set -e; for scene in $(SCENES); do \
	    out=out/$$(basename $$scene .toml); \
	    $(ENVERS) render $$scene -o $$out.png -o $$out.exr; \
	done
	@status=0; for scene in $(TUTORIAL) $(SCENES); do \
	    for precision in fast certified; do \
	        verdict=$$($(ENVERS) validate $$scene --spp 1 --precision $$precision) || status=1; \
	        echo "$$scene: $${verdict%%?worst ray*}"; \
	    done; \
	done; exit $$status

gallery: setup ## build, and render the scenes of docs/gallery.md into out/gallery/
	$(CARGO) build --release --locked
	@mkdir -p out/gallery
	@set -e; for scene in $(GALLERY); do \
	    $(ENVERS) render $$scene -o out/gallery/$$(basename $$scene .toml).png; \
	done

# The fuzz targets are compiled without libFuzzer, which nothing is linked with.
FUZZ_CLIPPY = CUSTOM_LIBFUZZER_PATH=none/libnone.a $(CARGO) clippy --locked \
    --manifest-path fuzz/Cargo.toml --target-dir "$${CARGO_TARGET_DIR:-target}"

# One target directory serves both feature sets: most dependencies are compiled once for the two.
test: setup ## everything that CI checks: format, lints, tests, documentation, with and without Embree
	$(CARGO) fmt --all --check
	$(CARGO) clippy --locked --workspace --all-targets -- -D warnings
	$(CARGO) clippy --locked --all-targets $(PURE_RUST) -- -D warnings
	$(CARGO) clippy --locked --lib --no-default-features -- -D warnings
	$(FUZZ_CLIPPY) -- -D warnings
	$(CARGO) test --locked
	$(CARGO) test --locked $(PURE_RUST)
	RUSTDOCFLAGS='-D warnings' $(CARGO) doc --locked --no-deps
	RUSTDOCFLAGS='-D warnings' $(CARGO) doc --locked --no-deps $(PURE_RUST)

check: ## the inner loop: format, lints and unit tests, default features, no set-up
	$(CARGO) fmt --all --check
	$(CARGO) clippy --workspace --all-targets -- -D warnings
	$(CARGO) test --lib --bins

soak: setup ## what takes longer: sweeps, random cases, fuzzing, a corpus (SOAK=0.1 is a tenth)
	@scripts/soak

# Advisories need a network: `cargo deny check advisories` fetches their database.
deny: ## hold licences, duplicates and sources of the dependencies to deny.toml
	@command -v cargo-deny >/dev/null || \
	    { echo 'make deny: first `cargo install cargo-deny --locked`' >&2; exit 1; }
	$(CARGO) deny --locked check licenses bans sources

# Where manual pages and the scripts that complete the command line go.
SHARE = $(DESTDIR)$(PREFIX)/share
COMPLETIONS = $(SHARE)/bash-completion/completions/envers $(SHARE)/zsh/site-functions/_envers \
    $(SHARE)/fish/vendor_completions.d/envers.fish

# Embree goes along only if set-up fetched it: a system's own is found where it stands.
install: setup ## build and install under PREFIX (default: ~/.local), with Embree if it was fetched
	$(CARGO) install --path . --locked --no-track --force --root '$(DESTDIR)$(PREFIX)'
	@rm -rf '$(DESTDIR)$(PREFIX)/lib/envers'
	@if [ -z "$$EMBREE_DIR" ] && [ -f .deps/embree/stamp ]; then \
	    mkdir -p '$(DESTDIR)$(PREFIX)/lib/envers' && \
	    cp .deps/embree/lib*.so.* LICENSE-APACHE THIRD_PARTY.md \
	        '$(DESTDIR)$(PREFIX)/lib/envers/' && \
	    echo 'Embree is in $(DESTDIR)$(PREFIX)/lib/envers'; \
	fi
	@'$(DESTDIR)$(PREFIX)/bin/envers' man '$(SHARE)/man/man1'
	@set -e; set -- bash zsh fish; for script in $(foreach script,$(COMPLETIONS),'$(script)'); do \
	    mkdir -p "$${script%/*}"; \
	    '$(DESTDIR)$(PREFIX)/bin/envers' completions $$1 >"$$script"; shift; \
	done
	@echo 'Manual pages and completions are in $(SHARE)'

uninstall: ## remove what `make install` put under PREFIX
	rm -f '$(DESTDIR)$(PREFIX)/bin/envers' '$(SHARE)'/man/man1/envers.1 '$(SHARE)'/man/man1/envers-*.1
	rm -f $(foreach script,$(COMPLETIONS),'$(script)')
	rm -rf '$(DESTDIR)$(PREFIX)/lib/envers'

clean: ## remove what was built and rendered (what was fetched stays in .deps)
	$(CARGO) clean
	rm -rf out
