# Each command explains itself; what the program lists, it has.
. "$(dirname "$0")/lib.sh"
say --help
for command in $("$COTREE" --help | sed -n 's/^  \([a-z]*\)  .*/\1/p'); do
  [ "$command" = cotree ] || say "$command" --help
done
"$COTREE" --version | sed 's/[0-9][0-9]*/N/g'
"$COTREE" simulate --version | sed 's/[0-9][0-9]*/N/g'
"$COTREE" -V | sed 's/[0-9][0-9]*/N/g'
say help nosuch
for command in '' help simulate; do
  # shellcheck disable=SC2086
  "$COTREE" help $command >help.txt
  # shellcheck disable=SC2086
  "$COTREE" ${command#help} --help | cmp - help.txt && echo "help $command: the same as --help"
done
