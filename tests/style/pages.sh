#!/bin/sh
# Pages keep up with the source: files that they link to exist, and what docs/theory.md and docs/architecture.md call by
# name is there.
#   pages.sh SOURCE_ROOT
set -eu

cd "$1"
bad=0
complain() {
  echo "$1"
  bad=1
}

for page in *.md docs/*.md; do
  folder=$(dirname "$page")
  # relative links; (t_k) behind a bracket is a formula
  for link in $(grep -oE '\]\([^)#: ]+[)#]' "$page" | cut -c3- | tr -d ')#' | grep '[./]' | sort -u); do
    [ -e "$folder/$link" ] || complain "$page: there is no $link"
  done
done
temporary=$(mktemp -d)
trap 'rm -rf "$temporary"' EXIT
LC_ALL=C
export LC_ALL
grep -rohE '[a-z][a-z0-9_]{7,}' src include components | sort -u >"$temporary/words"
for page in docs/theory.md docs/architecture.md; do
  [ -e "$page" ] || continue
  # `name` of at least eight characters with an underscore
  grep -oE '`[a-z][a-z0-9_]{7,}`' "$page" | tr -d '`' | grep _ | sort -u >"$temporary/names"
  for name in $(comm -23 "$temporary/names" "$temporary/words"); do
    complain "$page: nothing in src is called $name"
  done
  # [`name`](file): the file has it
  for pair in $(grep -oE '\[`[a-z][a-z0-9_]+`\]\([^)#]+\)' "$page" | tr -d '[]`)' | tr '(' ' ' | tr ' ' : | sort -u); do
    grep -qwF -e "${pair%%:*}" "docs/${pair#*:}" || complain "$page: ${pair#*:} has no ${pair%%:*}"
  done
done
exit $bad
