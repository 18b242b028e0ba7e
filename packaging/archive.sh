#!/usr/bin/env bash
# Packs a program with manual pages, completions, licences and notices: archive.sh PROGRAM NAME
# The result is NAME.tar.gz in the current folder.
set -euo pipefail

program=$(realpath "$1")
name=$2
source=$(dirname "$(dirname "$(realpath "$0")")")

mkdir -p "$name/man" "$name/completions"
cp "$program" "$source"/{README.md,CHANGELOG.md,LICENSE-MIT,LICENSE-APACHE,CITATION.cff} "$name"
"$program" licences > "$name/NOTICES.txt"
"$program" manual > "$name/man/spineline.1"
"$program" --help > "$name/commands"
for command in $(sed -n '/^Commands:/,/^$/s/^  \([a-z][a-z-]*\).*/\1/p' "$name/commands" | grep --invert-match '^help$'); do
  "$program" manual "$command" > "$name/man/spineline-$command.1"
done
rm "$name/commands"
for shell in bash zsh fish powershell; do
  "$program" completions "$shell" > "$name/completions/spineline.$shell"
done
tar --create --gzip --file "$name.tar.gz" "$name"
