#!/usr/bin/env bash
# Makes the pictures of docs/gallery.md (or those of the examples named): docs/gallery.sh [NAME...]. PYTHON is one with Blender as a module (pip install bpy==5.0.1).
# A folder TAKES in the environment that holds takes as NAME/NAME.take saves simulating them again.
set -euo pipefail
cd "$(dirname "$0")/.."
python="${PYTHON:-python3}"

# Name, look and frame.
shots=("logo glass 48" "glass-impact glass 30" "mud clay 40" "wall-bolt stone 40")

is_wanted() { [ -z "$wanted" ] || [[ " $wanted " == *" $1 "* ]]; }

wanted="$*"
cargo build --release --quiet --workspace --bin fissure
for shot in "${shots[@]}"; do
    read -r name look frame <<< "$shot"
    is_wanted "$name" || continue
    if [ -n "${TAKES:-}" ]; then
        target/release/fissure post "$TAKES/$name" --output "out/$name" --formats glb --parts cracked,collider --quiet
    else
        target/release/fissure run "examples/$name/scene.toml" --formats glb --parts cracked,collider --quiet
    fi
    "$python" pipeline/blender/render_run.py "out/$name" --look "$look" --frames "$frame" --size 640 --samples 24 --jpeg \
        --output docs/gallery
done

is_wanted logo || exit 0
# Blur along the motion: letters that fall for longer, with the shutter open for a whole frame.
target/release/fissure run examples/logo/scene.toml --set 'collider.floor.shape.half_plane.point=[0.0, -3.0]' \
    --set frames.rate=100 --set 'frames.range="1-12"' --set 'body.word.velocity=[0, -8]' --set solver.damping=0 \
    --set name=logo-falls --formats glb --overwrite --output out/logo-falls --quiet
"$python" pipeline/blender/render_run.py out/logo-falls --look clay --frames 10 --shutter 1 --size 640 --samples 64 --jpeg \
    --output docs/gallery
