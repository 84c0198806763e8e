#!/usr/bin/env bash
# The hashes of tests/sameness.rs here, at every SIMD level of this machine against each other, and on other processors: 64-bit
# Arm, 32-bit x86 and big-endian z/Architecture by emulation: `bash tests/sameness.sh`. Needs rustup, and of Debian's packages
# qemu-user, gcc-aarch64-linux-gnu, gcc-i686-linux-gnu and gcc-s390x-linux-gnu. What is missing is said and left out.
set -euo pipefail
cd "$(dirname "$0")/.."
features=(--features raster,scene)

echo '== this machine'
cargo test "${features[@]}" --test sameness -- --nocapture
cargo test "${features[@]}" --lib every_simd_level -- --nocapture

# With little optimisation, which changes no bit either: without any, emulation takes an hour.
export CARGO_PROFILE_DEV_OPT_LEVEL=1
try() { # a target, the name of its Debian compiler and libraries, and of its emulator
    local name upper
    name=$2
    upper=$(tr 'a-z-' 'A-Z_' <<<"$1")
    if ! rustup target add "$1" 2>/dev/null; then
        echo "== $1: left out, it has no standard library here"
    elif ! command -v "$name-gcc" >/dev/null || ! command -v "$3" >/dev/null; then
        echo "== $1: left out, there is no $name-gcc or no $3"
    else
        echo "== $1"
        env "CARGO_TARGET_${upper}_LINKER=$name-gcc" "CARGO_TARGET_${upper}_RUNNER=$3 -L /usr/$name" \
            cargo test "${features[@]}" --target "$1" --test sameness -- --nocapture
    fi
}
try aarch64-unknown-linux-gnu aarch64-linux-gnu qemu-aarch64
try i686-unknown-linux-gnu i686-linux-gnu qemu-i386
try s390x-unknown-linux-gnu s390x-linux-gnu qemu-s390x
