# Everyday commands; `just --list` shows them.

# Build the example into out/.
build:
    cargo run --release -- build examples/thesis10.lss -o out --stages

# All tests.
test:
    cargo test

# What must hold before a change lands.
ci:
    bash .ci/run

# Measure; docs/benchmarks.md holds the figures.
bench:
    cargo bench
