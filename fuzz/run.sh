#!/usr/bin/env bash
# Every fuzz target for so many seconds each, 60 unless told otherwise: `bash fuzz/run.sh 600`. Needs nightly Rust, a C++
# compiler, and `cargo install cargo-fuzz`. What is found lies in fuzz/artifacts; put it into fuzz/seeds/TARGET as well, where
# the tests find it.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-60}
cargo +nightly fuzz build --sanitizer none
programs=fuzz/target/$(rustc -vV | sed -n 's/host: //p')/release
total=0
for target in $(cargo +nightly fuzz list); do
    mkdir -p "fuzz/corpus/$target" "fuzz/seeds/$target" "fuzz/artifacts/$target"
    echo "== $target"
    # The program itself, not by way of cargo, which would build it again where a source has changed since.
    "$programs/$target" "fuzz/corpus/$target" "fuzz/seeds/$target" -artifact_prefix="fuzz/artifacts/$target/" \
        -max_total_time="$seconds" -max_len=400 -timeout=20 -rss_limit_mb=2048 -print_final_stats=1 \
        >"fuzz/artifacts/$target.log" 2>&1 || true
    grep -E 'stat::|ERROR|panicked|Test unit written|Done' "fuzz/artifacts/$target.log" || true
    count=$(sed -n 's/stat::number_of_executed_units: //p' "fuzz/artifacts/$target.log")
    total=$((total + ${count:-0}))
done
echo "$total executions in all"
ls fuzz/artifacts/*/* 2>/dev/null && exit 1
echo 'nothing found'
