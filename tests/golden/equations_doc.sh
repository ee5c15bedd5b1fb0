#!/bin/sh
# What docs/equations.md and docs/liang2017.md show is what is printed: each of their blocks stands in one of the golden
# files or in the summary of a long chain, and so does each line of program text in a table of docs/liang2017.md, written `line`.
#   equations_doc.sh SOURCE_ROOT
set -eu
cd "$1"
awk '
function missing(block,   k) {
  for (k = 1; k <= nfile; k++)
    if (index(text[k], block))
      return 0
  return 1
}
FILENAME !~ /^docs/ {
  if (FNR == 1) nfile++
  text[nfile] = text[nfile] $0 "\n"
  next
}
/^```/ {
  if (inside && missing(block)) {
    printf "%s:%d: this block is not what is printed:\n%s", FILENAME, FNR, block
    bad = 1
  }
  inside = !inside
  block = ""
  next
}
inside { block = block $0 "\n"; n++; next }
# the last column of a table
FILENAME == "docs/liang2017.md" && /^\| \(/ {
  part = split($0, cell, "|")
  pieces = split(cell[part - 1], line, "`")
  for (i = 2; i <= pieces; i += 2)
    if (missing(line[i])) {
      printf "%s:%d: not printed: %s\n", FILENAME, FNR, line[i]
      bad = 1
    }
  nline += pieces > 1
}
END { exit bad || !n || !nline }
' tests/golden/equations.files/*.txt tests/cli/equations_full.stdout docs/equations.md docs/liang2017.md
