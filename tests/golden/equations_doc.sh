#!/bin/sh
# What docs/equations.md shows is what is printed: each of its blocks stands in one of the golden files.
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
FILENAME != "docs/equations.md" {
  if (FNR == 1) nfile++
  text[nfile] = text[nfile] $0 "\n"
  next
}
/^```/ {
  if (inside && missing(block)) {
    printf "docs/equations.md:%d: this block is not what is printed:\n%s", FNR, block
    bad = 1
  }
  inside = !inside
  block = ""
  next
}
inside { block = block $0 "\n"; n++ }
END { exit bad || !n }
' tests/golden/equations.files/*.txt docs/equations.md
