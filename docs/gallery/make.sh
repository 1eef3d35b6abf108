#!/usr/bin/env bash
# Renders every project of a corpus and the repository's sample scenes to docs/gallery and writes the contact sheet
# docs/gallery/README.md with what `sunshine info` reports about each.
#
#   docs/gallery/make.sh CORPUS_DIRECTORY [extra options of sunshine render]
#
# Pictures that are there already are kept; delete one to have it made again. SUNSHINE names a program that is built
# already, SAMPLES the samples per pixel.
set -euo pipefail
cd "$(dirname "$0")/../.."
corpus=${1:?usage: docs/gallery/make.sh CORPUS_DIRECTORY [options of sunshine render]}
shift
samples=${SAMPLES:-256}
if [ -z "${SUNSHINE:-}" ]; then
  cargo build --release --locked -p sunshine
fi
sunshine=${SUNSHINE:-target/release/sunshine}
gallery=docs/gallery
page=$gallery/README.md

cell() { # the picture of a project, made if it is missing, and its row of the table
  local project=$1 name
  name=$(basename "$project")
  name=${name%.gsz}
  name=${name// /-}
  if [ ! -e "$gallery/$name.png" ]; then
    "$sunshine" render "$project" -o "$gallery/$name.png" --size 400x300 --samples "$samples" --quiet "${@:2}"
  fi
  printf '| ![%s](%s.png) | **%s**<br>' "$name" "$name" "$name"
  "$sunshine" info "$project" | sed -e '/^extent/,/^  direction/d' -e '/^$/d' -e 's/|/\\|/g' | sed -e 's/$/<br>/' | tr -d '\n'
  printf ' |\n'
}

{
  printf '# Gallery\n\nMade by `docs/gallery/make.sh`: every project of the corpus as it was saved, and the sample scenes of this\n'
  printf 'repository, path traced with %s samples a pixel; beside each what `sunshine info` says about it.\n' "$samples"
  printf 'A picture is black where the saved view shows nothing that is lit: the lamp of ShaderTest burns inside a closed black\n'
  printf 'body, and the saved camera of Mangrove looks past its only tile.\n\nThe figures of the thesis are [here](thesis/README.md).\n'
  for part in "The corpus:$corpus" "Sample scenes:scenes"; do
    printf '\n## %s\n\n| picture | contents |\n| --- | --- |\n' "${part%%:*}"
    for project in "${part#*:}"/*; do
      case $project in *.md) continue ;; esac
      cell "$project" "$@"
    done
  done
} > "$page.new"
mv "$page.new" "$page"

SUNSHINE=$sunshine docs/gallery/thesis.sh
