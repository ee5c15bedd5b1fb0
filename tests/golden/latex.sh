#!/bin/sh
# The derivation of every example system, all stages, compiles with pdflatex, and no line passes a margin by more
# than a word's end. Skipped where there is no pdflatex; tests/cli/printing.sh looks at the structure.
#   latex.sh COTREE SYSTEMS
set -eu
command -v pdflatex >/dev/null || exit 77
cotree=$1
systems=$2
widest=25 # [pt]; what cannot be broken: a product with a tall delimiter, a long name
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
status=0 n=0
for model in "$systems"/*/model.yaml; do
  name=$(basename "$(dirname "$model")")
  {
    printf '%s\n' '\documentclass{article}\usepackage{amsmath,longtable}\begin{document}'
    "$cotree" equations "$model" --show all --format latex 2>/dev/null
    printf '%s\n' '\end{document}'
  } >"$name.tex"
  n=$((n + 1))
  if ! pdflatex -draftmode -interaction=nonstopmode -halt-on-error "$name.tex" >"$name.out" 2>&1; then
    echo "$name: $(grep -a -m 1 '^!' "$name.out")"
    status=1
  fi
  grep -a '^Overfull' "$name.out" | sed 's/.*(\([0-9.]*\)pt too \([a-z]*\)).*/\1 \2/' |
    awk -v name="$name" -v widest=$widest '
      $1 > widest { print name ": " $1 " pt too " $2; bad = 1 }
      END { exit bad }' || status=1
done
[ "$n" -gt 30 ] || { echo "only $n systems"; status=1; }
exit $status
