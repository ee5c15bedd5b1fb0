# The pictures and the page that are in systems are those that `./dev gallery` makes. Round-off may differ from machine to machine:
# numbers may differ by the last tenth of a pixel or two, all else may not.
. "$(dirname "$0")/lib.sh"
sh "$SYSTEMS/gallery.sh" "$COTREE" .
cmp README.md "$SYSTEMS/README.md" || echo 'run: ./dev gallery'
ls gallery >made
ls "$SYSTEMS/gallery" | diff made - || echo 'run: ./dev gallery'
for picture in gallery/*.svg; do
  awk -v name="$picture" '
    FNR == 1 { nfile++ }
    nfile == 1 { line[FNR] = $0; n = FNR; next }
    {
      a = line[FNR]
      b = $0
      while (a != b && match(a, /-?[0-9]+/)) {
        i = RSTART; p = substr(a, i, RLENGTH); before = substr(a, 1, i - 1); a = substr(a, i + RLENGTH)
        if (!match(b, /-?[0-9]+/) || substr(b, 1, RSTART - 1) != before) break
        q = substr(b, RSTART, RLENGTH); b = substr(b, RSTART + RLENGTH)
        d = p - q
        if (d > 2 || d < -2) break
      }
      if (a != b) { print name ":" FNR ": differs; run: ./dev gallery"; bad = 1; exit }
    }
    END { if (!bad && n != FNR) print name ": another number of lines; run: ./dev gallery" }
  ' "$SYSTEMS/$picture" "$picture"
done
ls gallery | wc -l | tr -d ' '
# the size of all of them together, which must stay below 2 MB
du -sk gallery | awk '{ print ($1 < 2000 ? "small" : "too large: " $1 " kB") }'
