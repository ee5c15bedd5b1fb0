#!/bin/sh
# The gallery of all systems: FOLDER/README.md and FOLDER/gallery/NAME.svg, from gallery.txt beside this file.
#   gallery.sh COTREE FOLDER
set -eu

cotree=$1
folder=$2
here=$(dirname "$0")
mkdir -p "$folder/gallery"

# A field of a line, without the blanks around it.
field() {
  printf '%s\n' "$line" | cut -d'|' -f"$1" | sed 's/^ *//; s/ *$//'
}

{
  cat <<'END'
<!-- made by ./dev gallery from gallery.txt -->
# Systems

Each folder holds a model (`model.yaml`) and its physics: what is modelled, what must hold, where
reference values come from.

    cotree simulate systems/pendulum/model.yaml -o pendulum.csv
    cotree equations systems/pendulum/model.yaml
    cotree draw systems/pendulum/model.yaml -o pendulum.svg

The pictures are made by `cotree draw`, thin lines being paths of points over the run; `./dev gallery` makes them anew.

| | system | bodies | freedoms | shows |
| --- | --- | --- | --- | --- |
END
  grep -v '^#' "$here/gallery.txt" | while read -r line; do
    name=$(field 1)
    picture=
    if [ -f "$here/$name/model.yaml" ]; then
      # shellcheck disable=SC2046 # options are words
      "$cotree" draw "$here/$name/model.yaml" --quiet $(field 5) -o "$folder/gallery/$name.svg" 2>/dev/null
      picture="<a href=\"gallery/$name.svg\"><img src=\"gallery/$name.svg\" width=\"240\" alt=\"$name\"></a>"
    fi
    echo "| $picture | [$name]($name) | $(field 2) | $(field 3) | $(field 4) |"
  done
  cat <<'END'

`tests/reference` compares most of them with high-accuracy solutions and checks the energy balance
of all.
END
} >"$folder/README.md"
