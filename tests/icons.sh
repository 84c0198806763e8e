#!/usr/bin/env bash
# Every icon of two packages as a caster, compared with `exact`: `bash tests/icons.sh`. Needs npm.
set -euo pipefail
cd "$(dirname "$0")/.."
mkdir -p target/icons
for package in @mdi/svg@7.4.47 bootstrap-icons@1.13.2; do
    folder=target/icons/$(tr -c 'a-z0-9\n' '-' <<<"$package")
    if [ ! -d "$folder" ]; then
        archive=$(cd target/icons && npm pack --silent "$package")
        mkdir "$folder.part"
        tar xzf "target/icons/$archive" -C "$folder.part"
        mv "$folder.part" "$folder"
    fi
    # The first folder with SVG files: `svg` in one, `icons` in the other.
    icons=$(find "$PWD/$folder" -name '*.svg' -printf '%h\n' | sort | uniq -c | sort -rn | awk 'NR == 1 { print $2 }')
    echo "== $package"
    PENUMBRAL_ICONS=$icons cargo test --release --all-features --test icons -- --ignored --nocapture
done
