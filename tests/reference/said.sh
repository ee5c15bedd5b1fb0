# shellcheck shell=sh
# said.sh: what is said of the error of a linear beam. Source it.

after_run() { # SUMMARY.json
    awk -F': ' '/"validity"/ { inside = 1 } inside && /"error"/ { gsub(/[",]/, "", $2); print $2; exit }' "$1"
}
before_run() { # MODEL.yaml, with `auto`
    "$COTREE" check "$1" | sed -n "/linear beam's error/ { s/.*linear beam's error: \([^;)]*\).*/\1/p; q; }"
}
