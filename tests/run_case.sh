#!/bin/sh
# One case of tests/cli or tests/golden against its expected output.
#
#   run_case.sh cli CASE.sh      standard output, standard error and exit status must equal the files
#                                CASE.stdout, CASE.stderr (none: empty) and CASE.exit (none: 0)
#   run_case.sh golden CASE.sh   it must succeed, and the files it leaves behind must equal those in
#                                CASE.files/, byte for byte
#
# The case runs in a fresh folder, in the C locale, without input; $COTREE is the program, $SYSTEMS
# the folder of example systems, whose path reads SYSTEMS in what is compared. UPDATE=1 rewrites the
# expected files instead.
set -eu

kind=$1
case $2 in
/*) script=$2 ;;
*) script=$PWD/$2 ;;
esac
expected=${script%.sh}

temporary=$(mktemp -d)
trap 'rm -rf "$temporary"' EXIT
mkdir "$temporary/files"

LC_ALL=C
export LC_ALL
status=0
(cd "$temporary/files" && sh "$script") >"$temporary/stdout" 2>"$temporary/stderr" </dev/null ||
  status=$?
echo "$status" >"$temporary/exit"

# The machine's own path must not get into an expected file.
hide_systems() {
  [ -n "${SYSTEMS:-}" ] || return 0
  awk -v path="$SYSTEMS" '
    {
      line = $0
      out = ""
      while ((i = index(line, path)) > 0) {
        out = out substr(line, 1, i - 1) "SYSTEMS"
        line = substr(line, i + length(path))
      }
      print out line
    }' "$1" >"$1.plain"
  mv "$1.plain" "$1"
}

update_cli() {
  for part in stdout stderr; do
    if [ -s "$temporary/$part" ]; then
      cp "$temporary/$part" "$expected.$part"
    else
      rm -f "$expected.$part"
    fi
  done
  if [ "$status" -ne 0 ]; then
    cp "$temporary/exit" "$expected.exit"
  else
    rm -f "$expected.exit"
  fi
}

check_cli() {
  : >"$temporary/empty"
  echo 0 >"$temporary/zero"
  differs=0
  for part in stdout stderr exit; do
    want=$expected.$part
    if [ ! -f "$want" ]; then
      want=$temporary/empty
      [ "$part" != exit ] || want=$temporary/zero
    fi
    diff -u "$want" "$temporary/$part" || differs=1
  done
  return $differs
}

case $kind in
cli)
  hide_systems "$temporary/stdout"
  hide_systems "$temporary/stderr"
  if [ -n "${UPDATE:-}" ]; then update_cli; else check_cli; fi
  ;;
golden)
  if [ "$status" -ne 0 ]; then
    cat "$temporary/stdout" "$temporary/stderr"
    echo "exit status $status"
    exit 1
  fi
  if [ -n "${UPDATE:-}" ]; then
    rm -rf "$expected.files"
    cp -r "$temporary/files" "$expected.files"
  else
    diff -ruN "$expected.files" "$temporary/files"
  fi
  ;;
*)
  echo "run_case.sh: no kind '$kind'" >&2
  exit 2
  ;;
esac
