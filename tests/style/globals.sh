#!/bin/sh
# No variable outlives a call: objects in sections that are written to. Constant tables with addresses in them are in
# .data.rel.ro, which is not. Only guard.c keeps two for each thread: the guard, and what its tests ask for; and the program
# keeps what signals are about (cli/interrupt.c), as they come to the process and not to a call.
#   globals.sh NM FILE...        libraries and programs
set -eu

nm=$1
shift
for file; do
  "$nm" -f sysv "$file" 2>/dev/null
done | awk -F'|' '
  # Symbols from libcotree_internal.a[src_base_guard.c.o]:
  /^Symbols from / { object = $0; nobject++ }
  NF < 7 || $4 !~ /OBJECT|TLS/ { next }
  { nsymbol++ }
  $7 ~ /\.data\.rel\.ro/ || $7 !~ /^ *(\.t?bss|\.t?data|\*COM\*)/ { next }
  {
    name = $1
    sub(/ *$/, "", name)
    # of the C library, its start code and OpenMP: locks of named critical sections
    if (name ~ /@/ || name ~ /^__/ || name ~ /^completed\./) next
    if (object ~ /base_guard\.c/ && (name == "innermost" || name == "fail_after")) next
    if (object ~ /cotree:$/ && name ~ /^(signal_seen|explanation|waited_for|outside|cancelled|lock)$/) next
    print object " " name
    bad = 1
  }
  END {
    print nsymbol + 0 " objects"
    exit bad || !nsymbol
  }'
