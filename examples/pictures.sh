#!/usr/bin/env bash
# Makes the pictures of all examples (or of those named): examples/pictures.sh [NAME...]
# A folder TAKES in the environment that holds takes as NAME/NAME.take saves simulating them again.
set -euo pipefail
cd "$(dirname "$0")/.."

# Frames to show.
shots() {
    case "$1" in
        pull | pull-rotated | pull-guided) echo "8,16,48" ;;
        drop-*) echo "24,28,45" ;;
        logo) echo "1,4,48" ;;
        wall-bolt) echo "12,18,48" ;;
        three-holes) echo "20,48" ;;
        two-materials) echo "14,48" ;;
        painted) echo "20,32,48" ;;
        mud) echo "6,14,40" ;;
        glass-impact) echo "4,8,36" ;;
    esac
}

# From where it is seen.
view() {
    case "$1" in
        mud) echo "--yaw -25 --pitch 35" ;;
        *) echo "--yaw -25 --pitch 18" ;;
    esac
}

if [ "$#" -eq 0 ]; then set -- pull pull-rotated pull-guided drop-jello drop-snow drop-pmma drop-glass logo \
    wall-bolt three-holes glass-impact mud painted two-materials; fi
cargo build --release --quiet --workspace --bin fissure
for name in "$@"; do
    takes="${TAKES:-out}"
    if [ -z "${TAKES:-}" ]; then target/release/fissure sim "examples/$name/scene.toml" --quiet; fi
    # shellcheck disable=SC2046 # several words
    target/release/fissure preview "$takes/$name" --frames "$(shots "$name")" $(view "$name") --pictures sheet \
        --output "out/$name/preview" --quiet
    cp "out/$name/preview/${name}_sheet.png" "examples/$name/picture.png"
done
