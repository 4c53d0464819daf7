#!/usr/bin/env bash
# Makes the pictures of all examples (or of those named) from their meshes: examples/pictures.sh [NAME...]
# Needs Python with the packages of pipeline/checks/requirements.txt; PYTHON names the interpreter.
set -euo pipefail
cd "$(dirname "$0")/.."
python="${PYTHON:-python3}"

# Frames to show.
shots() {
    case "$1" in
        pull | pull-rotated | pull-guided) echo "8 16 48" ;;
        drop-*) echo "24 28 45" ;;
        logo) echo "1 48" ;;
        wall-bolt) echo "12 18 48" ;;
        three-holes) echo "20 48" ;;
        two-materials) echo "14 48" ;;
        painted) echo "20 32 48" ;;
        mud) echo "6 14 40" ;;
        glass-impact) echo "8 14 22" ;;
    esac
}

# Options of the picture.
view() {
    case "$1" in
        three-holes) echo "--size 200" ;;
        two-materials) echo "--circle=-0.035,0.018,0.035 --circle=0.07,-0.055,0.035" ;;
        mud) echo "--pitch 35" ;;
    esac
}

if [ "$#" -eq 0 ]; then set -- pull pull-rotated pull-guided drop-jello drop-snow drop-pmma drop-glass logo \
    wall-bolt three-holes glass-impact mud painted two-materials; fi
for name in "$@"; do
    cargo run --release --quiet -- run "examples/$name/scene.toml" --formats glb --quiet
    files=()
    for frame in $(shots "$name"); do
        number="$(printf '%04d' "$frame")"
        file="out/$name/$name.$number.glb"
        floor="out/$name/${name}_collider.$number.glb"
        if [ -f "$floor" ]; then file="$file+$floor"; fi
        files+=("$file")
    done
    # shellcheck disable=SC2046 # several words
    "$python" pipeline/picture.py "${files[@]}" $(view "$name") -o "examples/$name/picture.png"
done
