#!/bin/sh
# The checks of this suite see what they are for: each is given something wrong.
#   self.sh TESTS_FOLDER COMPILER [FLAG...]
set -eu

tests=$1
shift
temporary=$(mktemp -d)
trap 'rm -rf "$temporary"' EXIT
cd "$temporary"
bad=0

passes() {
  "$@" >log 2>&1 || {
    echo "should pass: $*"
    cat log
    bad=1
  }
}

fails_with() {
  text=$1
  shift
  if "$@" >log 2>&1; then
    echo "should fail: $*"
    bad=1
  elif ! grep -qF -- "$text" log; then
    echo "should say '$text': $*"
    cat log
    bad=1
  fi
}

# ---- layers
cat >layers.txt <<'END'
low
high low
src  *
cli  cotree
only yaml.h low
END
mkdir -p src/low src/high src/cli
layers() {
  sh "$tests/style/layers.sh" layers.txt .
}
printf '#include "low/a.h"\n#include <yaml.h>\n#include <stdio.h>\n' >src/low/a.c
printf '#include "high/b.h"\n  # include "low/a.h"\n' >src/high/b.c
printf '#include "low/a.h"\n#include "high/b.h"\n' >src/system.c
printf '#include <cotree/cotree.h>\n#include "cli/args.h"\n' >src/cli/main.c
passes layers
echo '#include "high/b.h"' >src/low/up.c
fails_with 'src/low/up.c:1: low may not include "high/b.h"' layers
rm src/low/up.c
echo '#include "low/a.h"' >src/cli/inside.c
fails_with 'cli may not include "low/a.h"' layers
rm src/cli/inside.c
printf '\n#include <yaml.h>\n' >src/high/yaml.c
fails_with 'src/high/yaml.c:2: <yaml.h> belongs in low' layers
rm src/high/yaml.c
echo '#include <yaml.h>' >src/low/second.c
fails_with 'already wrapped by src/low/a.c' layers
rm src/low/second.c
mkdir src/new
touch src/new/file.c
fails_with 'folder new is not in' layers
rm -r src/new
mkdir -p src/tall/top src/tall/bottom
printf 'low\nhigh low\nsrc  *\ncli  cotree\ntall/bottom low\ntall/top tall/bottom\ntall/tall.c tall/*\nonly yaml.h low\nupward src/tall/bottom/c.c tall/top/t.h\n' >rooms.txt
rooms() {
  sh "$tests/style/layers.sh" rooms.txt .
}
echo '#include "tall/bottom/b.h"' >src/tall/top/t.c
echo '#include "tall/top/t.h"' >src/tall/bottom/c.c
printf '#include "tall/top/t.h"\n#include "tall/bottom/b.h"\n' >src/tall/tall.c
passes rooms
echo '#include "tall/top/t.h"' >src/tall/bottom/d.c
fails_with 'src/tall/bottom/d.c:1: tall/bottom may not include "tall/top/t.h"' rooms
rm src/tall/bottom/d.c
echo >src/tall/bottom/c.c
fails_with 'rooms.txt: src/tall/bottom/c.c does not include "tall/top/t.h" any more' rooms
rm -r src/tall
printf 'high low\nlow\nsrc  *\ncli  cotree\n' >turned.txt
turned() {
  sh "$tests/style/layers.sh" turned.txt .
}
fails_with 'turned.txt: low comes after a folder that may include it' turned

# ---- pages
mkdir -p docs src/low include components
printf 'int ct_thing_make(void);\n' >src/low/thing.h
printf '[`ct_thing_make`](../src/low/thing.h) and `ct_thing_make`, `p_0` ](t_k)\n' >docs/theory.md
printf '[a](docs/theory.md) [b](https://example.org/a.md)\n' >README.md
pages() {
  sh "$tests/style/pages.sh" .
}
passes pages
echo '[gone](../src/low/gone.h)' >docs/more.md
fails_with 'docs/more.md: there is no ../src/low/gone.h' pages
rm docs/more.md
echo '`ct_thing_break`' >>docs/theory.md
fails_with 'nothing in src is called ct_thing_break' pages
echo '[`ct_thing_find`](../src/low/thing.h)' >docs/theory.md
fails_with '../src/low/thing.h has no ct_thing_find' pages
rm -r docs README.md include components src/low/thing.h

# ---- class names
mkdir -p src/component components
touch components/spring.c
classes() {
  sh "$tests/style/classes.sh" .
}
echo 'if (strcmp(c->cls->name, name) == 0)' >src/component/registry.c
passes classes
echo 'if (!strcmp(self->cls->name, "torque"))' >src/high/b.c
fails_with 'src/high/b.c:1:' classes
echo 'if (strcmp(what, "spring") == 0)' >src/high/b.c
fails_with 'src/high/b.c:1:' classes
echo '#include "low/a.h"' >src/high/b.c
rm -r src/component components

# ---- kinds of constants
if command -v python3 >/dev/null; then
  mkdir -p src/kinds tests
  touch tests/trade.sh
  constants() {
    PYTHONDONTWRITEBYTECODE=1 python3 "$tests/style/constants.py" . src/kinds
  }
  constant() {
    printf '%s\n' "$@" >src/kinds/k.c
  }
  constant '// Derived: a sum of four terms.' 'static const double a = 4 * DBL_EPSILON, b = 1e-3;'
  passes constants
  constant 'static const double a = 4; // [m]'
  fails_with 'src/kinds/k.c:1: a = 4: no kind' constants
  constant '    const double a = 2 * x, b = 1, c = f(3);' '#define GUARD' 'enum { ONE, TWO, NKIND };'
  passes constants
  constant '#define MOST 12'
  fails_with 'MOST = 12: no kind' constants
  constant '// Limit: a message beyond' 'enum {' '    MOST = 12,' '    LEAST = 3, // Derived: of it' '};'
  passes constants
  constant 'enum { A = 12 }; // Default: trades. Test: trade.'
  passes constants
  constant 'enum { A = 12 }; // Default: trades. Test: nothing.'
  fails_with "no test is called 'nothing'" constants
  constant 'enum { A = 12 }; // Default: trades'
  fails_with 'names a test' constants
  most=$(sed -n 's/^MOST_CHOSEN = //p' "$tests/style/constants.py")
  seq 0 "$most" | sed 's|.*|enum { A& = 12 }; // Chosen: by trial|' >src/kinds/k.c
  fails_with 'constants are Chosen' constants
  constant 'int f(double x)' '{' '    return x < 1e-6; // 1e-7' '}'
  fails_with 'src/kinds/k.c:3: 1e-6: a number without' constants
  constant 'int f(double x)' '{' '    // Definition: of a micrometre' '    return x < 1e-6;' '}'
  passes constants
  rm -r src/kinds
fi

# ---- search terms
mkdir -p src/integrate
fails_with "'dense output' leads to nothing" sh "$tests/style/terms.sh" .
echo '// Dense output' >src/high/c.c
fails_with "'dense output' leads to high, not to integrate" sh "$tests/style/terms.sh" .
rm -r src/integrate src/high/c.c

# ---- keys
keys() {
  sh "$tests/style/keys.sh" "$PWD/references.bib" .
}
echo '@article{seshu1961,' >references.bib
echo '// Source: Seshu and Reed, key seshu1961' >src/low/cited.c
passes keys
echo '.source = "kane1985",' >src/low/table.c
fails_with 'kane1985: not in' keys
echo '// Source: key mcphee1996' >src/low/table.c
fails_with 'mcphee1996: not in' keys
rm src/low/table.c src/low/cited.c

# ---- headers
headers() {
  sh "$tests/style/headers.sh" . include c "$@"
}
mkdir include
fails_with '0 headers' headers "$@"
echo 'int f(int x);' >include/good.h
passes headers "$@"
echo 'size_t g(void);' >include/bad.h
fails_with 'include/bad.h does not compile alone' headers "$@"

# ---- global variables
globals() {
  sh "$tests/style/globals.sh" nm object.o
}
object_of() {
  echo "$1" >object.c
  shift
  "$@" -fPIC -c object.c -o object.o
}
object_of 'static const char *const name[] = {"a"}; const char *f(int i) { return name[i]; }' "$@"
passes globals
object_of 'int f(void) { static int n; return n++; }' "$@"
fails_with 'n.' globals
object_of 'int n = 1; int f(void) { return n++; }' "$@"
fails_with ' n' globals
object_of 'static _Thread_local int n; int f(void) { return n++; }' "$@"
fails_with ' n' globals

# ---- cases
mkdir cases
case_of() {
  UPDATE='' sh "$tests/run_case.sh" "$@"
}
update_case() {
  UPDATE=1 sh "$tests/run_case.sh" "$@"
}
# shellcheck disable=SC2016 # $SYSTEMS is for the case
echo 'echo said; echo complained >&2; echo $SYSTEMS/x; exit 3' >cases/talk.sh
SYSTEMS=/some/where
export SYSTEMS
fails_with '+said' case_of cli cases/talk.sh
fails_with '+complained' case_of cli cases/talk.sh
fails_with '+3' case_of cli cases/talk.sh
passes update_case cli cases/talk.sh
passes case_of cli cases/talk.sh
passes grep -qx SYSTEMS/x cases/talk.stdout
passes grep -qx 3 cases/talk.exit
echo 'exit 0' >cases/talk.sh
fails_with '-said' case_of cli cases/talk.sh
passes update_case cli cases/talk.sh
fails_with 'No such file' ls cases/talk.stdout cases/talk.stderr cases/talk.exit

echo 'mkdir out; echo 1 >out/a; echo 2 >b' >cases/leave.sh
fails_with '+2' case_of golden cases/leave.sh
passes update_case golden cases/leave.sh
passes case_of golden cases/leave.sh
echo 3 >cases/leave.files/out/more
fails_with '-3' case_of golden cases/leave.sh
echo 'echo broken; exit 4' >cases/leave.sh
fails_with 'exit status 4' case_of golden cases/leave.sh

exit $bad
