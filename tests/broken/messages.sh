#!/bin/sh
# Every E1xx code has a paragraph in docs/messages.md that names a file of tests/broken which triggers it.
#   messages.sh SOURCE_ROOT
set -u

cd "$1" || exit 1
bad=0 count=0
for number in $(sed -nE 's/^MESSAGE\([A-Z_0-9]+, (1[0-9][0-9]),.*/\1/p' src/base/messages.def); do
  count=$((count + 1))
  file=$(awk -v head="### E$number" '
    index($0, "#") == 1 { inside = index($0, head) == 1 }
    inside && match($0, /tests\/broken\/[A-Za-z0-9_]+\.yaml/) { print substr($0, RSTART, RLENGTH); exit }
  ' docs/messages.md)
  if [ -z "$file" ]; then
    echo "E$number: no paragraph with an example in docs/messages.md"
    bad=1
  elif ! grep -q "\[E$number\]" "${file%.yaml}.expected"; then
    echo "E$number: $file does not trigger it"
    bad=1
  fi
done
echo "$count codes"
[ "$count" -gt 0 ] && exit $bad
