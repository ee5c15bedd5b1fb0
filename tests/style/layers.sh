#!/bin/sh
# Every #include against the arrows of tests/layers.txt.
#   layers.sh LAYERS SOURCE_ROOT
set -eu

layers=$1
cd "$2"
folders=
for folder in src components include; do
  [ ! -d "$folder" ] || folders="$folders $folder"
done

# shellcheck disable=SC2086 # a list of folders
find $folders -name '*.[ch]' | LC_ALL=C sort | awk -v layers="$layers" '
  function complain(text) {
    print file ":" number ": " text
    bad = 1
  }

  # src/base/arena.c -> base, src/system.c -> src, components/beam.c -> components
  function folder_of(path, part, n) {
    n = split(path, part, "/")
    return part[1] == "src" && n > 2 ? part[2] : part[1]
  }

  # "expr/ex.h" -> expr, "components.def" -> components.def
  function target_of(header, part) {
    split(header, part, "/")
    return part[1]
  }

  function check_project(from, header, to) {
    to = target_of(header)
    if (to != from && !((from, to) in allowed) && !((from, "*") in allowed))
      complain(from " may not include \"" header "\"")
  }

  function check_system(from, header) {
    if (!(header in wrapper)) return
    if (from != wrapper[header]) complain("<" header "> belongs in " wrapper[header])
    else if (header in wrapped_in && wrapped_in[header] != file)
      complain("<" header "> is already wrapped by " wrapped_in[header])
    wrapped_in[header] = file
  }

  function check_file(from, line, header) {
    from = folder_of(file)
    if (!(from in known)) {
      number = 1
      complain("folder " from " is not in " layers)
      return
    }
    for (number = 1; (getline line < file) > 0; number++) {
      if (line !~ /^[ \t]*#[ \t]*include[ \t]*["<]/) continue
      header = line
      sub(/^[^"<]*["<]/, "", header)
      sub(/[">].*/, "", header)
      if (line ~ /include[ \t]*"/) check_project(from, header)
      # the public headers are included as <cotree/...> too
      else if (header ~ /^cotree\//) check_project(from, header)
      else check_system(from, header)
    }
    close(file)
  }

  BEGIN {
    while ((getline line < layers) > 0) {
      n = split(line, word, " ")
      if (n == 0 || word[1] ~ /^#/) continue
      if (word[1] == "only") {
        wrapper[word[2]] = word[3]
        continue
      }
      known[word[1]] = 1
      if (word[1] in named) {
        print layers ": " word[1] " comes after a folder that may include it"
        bad = 1
      }
      for (i = 2; i <= n; i++) allowed[word[1], word[i]] = named[word[i]] = 1
    }
    close(layers)
  }

  {
    file = $0
    check_file()
    nfile++
  }

  END {
    print nfile + 0 " files"
    exit bad || !nfile
  }'
