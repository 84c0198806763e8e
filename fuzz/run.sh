#!/usr/bin/env bash
# Every fuzz target for so many seconds each, 60 unless told otherwise: `bash fuzz/run.sh 600`. Needs nightly Rust, a C++
# compiler, and `cargo install cargo-fuzz`. What is found lies in fuzz/artifacts; put it into fuzz/seeds/TARGET as well, where
# the tests find it.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-60}
cargo +nightly fuzz build --sanitizer none
for target in $(cargo +nightly fuzz list); do
    mkdir -p "fuzz/corpus/$target" "fuzz/seeds/$target"
    echo "== $target"
    cargo +nightly fuzz run --sanitizer none "$target" "fuzz/corpus/$target" "fuzz/seeds/$target" -- \
        -max_total_time="$seconds" -max_len=400 -timeout=20 -rss_limit_mb=2048 -print_final_stats=1 2>&1 \
        | grep -E 'stat::number_of_executed_units|stat::peak_rss_mb|ERROR|panicked|Test unit written|Done' || true
done
ls fuzz/artifacts/*/* 2>/dev/null && exit 1
echo 'nothing found'
