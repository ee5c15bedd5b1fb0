#!/bin/sh
# Every NAME.yaml of this folder against NAME.expected. A first line `# --set NAME=VALUE` is passed on.
#   run.sh DRIVER [--update]
set -u

driver=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
update=${2:-}
cd "$(dirname "$0")" || exit 1
count=0 bad=0
for model in *.yaml; do
  name=${model%.yaml}
  count=$((count + 1))
  set -- $(sed -n '1s/^# \(--set .*\)/\1/p' "$model")
  got=$("$driver" "$@" "$model" 2>&1)
  status=$?
  if [ "$update" = --update ]; then
    printf '%s\n' "$got" >"$name.expected"
  elif [ "$got" != "$(cat "$name.expected" 2>/dev/null)" ]; then
    echo "$model: expected"
    cat "$name.expected"
    echo "$model: got"
    printf '%s\n' "$got"
    bad=1
  fi
  if [ $status -ne 1 ]; then
    echo "$model: exit status $status, wanted 1"
    bad=1
  fi
done
echo "$count models"
[ "$count" -ge 60 ] && exit $bad
