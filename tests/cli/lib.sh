# What cases share; source it with: . "$(dirname "$0")/lib.sh"

# The command, what it says on both streams, and its exit status.
say() {
  echo "\$ cotree $*"
  "$COTREE" "$@" 2>&1 || echo "exit $?"
}

# Largest difference of the numbers of two CSV files with the same header, in any order of columns, against
# the largest number of the column.
difference() {
  awk -F, '
    FNR == 1 { nfile++ }
    nfile == 1 && FNR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
    nfile == 2 && FNR == 1 { for (i = 1; i <= NF; i++) if ($i in column) of[i] = column[$i]; else exit bad = 1; n = NF; next }
    nfile == 1 { for (i = 1; i <= NF; i++) { value[FNR, i] = $i; if (size($i) > largest[i]) largest[i] = size($i) } rows = FNR }
    nfile == 2 {
      for (i = 1; i <= n; i++) {
        d = size($i - value[FNR, of[i]])
        if (largest[of[i]] > 0) d /= largest[of[i]]
        if (d > worst) worst = d
      }
      if (FNR > rows) bad = 1
    }
    function size(x) { return x < 0 ? -x : x }
    END { if (bad || FNR != rows) print "different shapes"; else printf "%.17g\n", worst + 0 }' "$1" "$2"
}

# A row of a sweep, its values separated by commas, against the last row of run.csv, a run of its own at a tolerance of
# 1e-8: says every value that differs.  same_row RUN VALUES
same_row() {
  echo "$2" >want
  tail -1 run.csv | cut -d, -f2- | paste -d, want - | awk -F, -v run="$1" '{
    n = NF / 2
    for (i = 1; i <= n; i++) {
      d = $i - $(n + i); d = d < 0 ? -d : d
      size = $i < 0 ? -$i : $i
      if (!(d <= 1e-7 * (size > 1 ? size : 1))) print "run " run ": value " i ": " $i ", alone " $(n + i)
    }
    if (NF % 2) print "run " run ": another number of values"
  } END { if (NR != 1) print "run " run ": no values" }'
}
