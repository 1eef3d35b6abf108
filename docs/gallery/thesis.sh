#!/usr/bin/env bash
# Makes the pictures of docs/gallery/thesis: every figure of chapter 5 of the thesis that is a rendered picture.
#
#   docs/gallery/thesis.sh [tables]
#
# With `tables` the experiments are measured, too (ten minutes on two cores), which says something on a machine without
# other work only; tables and curves go to docs/gallery/thesis/measured, named after the processor. SUNSHINE names a
# program that is built already.
set -euo pipefail
cd "$(dirname "$0")/../.."
if [ -z "${SUNSHINE:-}" ]; then
  cargo build --release --locked -p sunshine
fi
sunshine=${SUNSHINE:-target/release/sunshine}
folder=docs/gallery/thesis

"$sunshine" bench thesis --pictures --device cpu -o "$folder"

if [ "${1:-}" = tables ]; then
  processor=$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | sed -n 1p)
  # The name of the machine in titles is that of its processor.
  HOSTNAME=${processor:-processor} "$sunshine" bench thesis --device cpu -o "$folder/measured"
  rm "$folder"/measured/*.png
fi
