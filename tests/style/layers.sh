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

  # src/base/arena.c -> base, src/solve/run/event.c -> solve/run, src/system.c -> src, components/beam.c -> components
  function room_of(path, part, n) {
    if (path ~ /^src\// && substr(path, 5) in known) return substr(path, 5)
    n = split(path, part, "/")
    if (part[1] != "src" || n < 3) return part[1]
    return n < 4 ? part[2] : part[2] "/" part[3]
  }

  # "expr/ex.h" -> expr, "solve/run/run.h" -> solve/run, "components.def" -> components.def
  function target_of(header, part, n) {
    n = split(header, part, "/")
    return n < 3 ? part[1] : part[1] "/" part[2]
  }

  # solve/run -> solve/*
  function all_beside(room, part) {
    split(room, part, "/")
    return part[1] "/*"
  }

  function check_project(from, header, to) {
    to = target_of(header)
    if (to == from || (from, to) in allowed || (from, all_beside(to)) in allowed || (from, "*") in allowed) return
    # formulate/formulate.c lies in formulate
    if (index(from, ".") && index(from, to "/") == 1) return
    if ((file, header) in upward) {
      delete upward[file, header]
      return
    }
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
    from = room_of(file)
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
      if (word[1] == "upward") {
        upward[word[2], word[3]] = 1
        continue
      }
      known[word[1]] = 1
      if (word[1] in named || all_beside(word[1]) in named && word[1] !~ /\./) {
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
    for (arrow in upward) {
      split(arrow, word, SUBSEP)
      print layers ": " word[1] " does not include \"" word[2] "\" any more"
      bad = 1
    }
    print nfile + 0 " files"
    exit bad || !nfile
  }'
