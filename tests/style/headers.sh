#!/bin/sh
# Each header of a folder compiles alone.
#   headers.sh SOURCE_ROOT FOLDER LANGUAGE COMPILER [FLAG...]
set -eu

cd "$1"
folder=$2
language=$3
shift 3

count=0 bad=0
for header in $(find "$folder" -name '*.h' | LC_ALL=C sort); do
  count=$((count + 1))
  printf '#include "%s"\nextern int not_empty;\n' "${header#"$folder"/}" |
    "$@" -x "$language" -I"$folder" -fsyntax-only -Wall -Wextra -Wpedantic -Werror - || {
    echo "$header does not compile alone"
    bad=1
  }
done
echo "$count headers"
[ "$count" -gt 0 ] && [ "$bad" -eq 0 ]
