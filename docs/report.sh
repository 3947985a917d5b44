#!/usr/bin/env bash
# Draws docs/report.png anew: the head of the report of the run that README.md shows. Needs Chromium.
set -euo pipefail
cd "$(dirname "$0")/.."

chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || {
    echo "docs/report.sh needs Chromium to draw a page: install it (apt install chromium)" >&2
    exit 1
}
run=$(mktemp -d)
trap 'rm -r "$run"' EXIT
# The part is not good by its gauge, or is: either way there is a page.
cargo run --release -- run examples/m20x2.ngc --scenario examples/scenarios/override-in-pass.toml \
    --in-process --out "$run/m20x2" || [ $? -eq 3 ]
"$chromium" --headless --no-sandbox --disable-gpu --hide-scrollbars --window-size=1090,2000 \
    --virtual-time-budget=6000 --screenshot=docs/report.png "file://$run/m20x2/report.html"
