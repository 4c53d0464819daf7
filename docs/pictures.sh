#!/usr/bin/env bash
# Makes all pictures of README.md, the examples and docs/gallery.md: docs/pictures.sh. See both scripts for what they take from the
# environment.
set -euo pipefail
cd "$(dirname "$0")/.."
examples/pictures.sh
docs/gallery.sh
