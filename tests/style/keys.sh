#!/bin/sh
# Every source that the code names by key is in the bibliography.
#   keys.sh REFERENCES SOURCE_ROOT
#
# A key is cited as `key mcphee1996` in a comment, or as .source = "hairer1996" in a method's table.
set -eu

references=$1
cd "$2"
bad=0
for key in $(find src components include tests -name '*.[ch]' -exec cat {} + 2>/dev/null |
  sed -nE 's/.*(key |\.source = ")([a-z]+[0-9]{4}[a-z]?).*/\2/p' | LC_ALL=C sort -u); do
  grep -q "^@[a-z]*{$key,\$" "$references" || {
    echo "$key: not in $references"
    bad=1
  }
done
exit $bad
