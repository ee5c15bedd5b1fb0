#!/bin/sh
# The manual page cotree(1), from what the program says about itself.
#   manual.sh COTREE VERSION >cotree.1
set -eu

cotree=$1
version=$2

# Text for troff: backslashes, minus signs, and no request at the start of a line.
plain() {
  sed -e 's/\\/\\e/g' -e 's/-/\\-/g' -e "s/^\\([.']\\)/\\\\\\&\\1/"
}

# Lines as they stand.
verbatim() {
  echo .nf
  plain
  echo .fi
}

help_of() {
  "$cotree" "$1" --help
}

commands=$("$cotree" --help | sed -n 's/^  \([a-z]*\)  .*/\1/p' | grep -v '^cotree$')

cat <<END
.TH COTREE 1 "" "cotree $version" "User Commands"
.SH NAME
cotree \\- equations of motion of mechanisms from their linear graphs, and their motion
.SH SYNOPSIS
.B cotree
.I COMMAND MODEL.yaml
.RI [ options ]
.SH DESCRIPTION
Reads a mechanism of rigid and flexible bodies, joints and forces from a YAML file, derives its equations of motion
from its linear graph, prints them, integrates them and analyses the system.
Results go to standard output or to a file, messages and progress to standard error.
Options may stand before or after the model.
.SH COMMANDS
END
for command in $commands; do
  echo ".SS $command"
  help_of "$command" | verbatim
done
cat <<END
.SH EXIT STATUS
.TP
0
done
.TP
1
the model or the run failed; the message says where
.TP
2
the command line is wrong
.SH EXAMPLES
.nf
cotree equations pendulum.yaml
cotree simulate pendulum.yaml \\-o pendulum.csv
.fi
.SH SEE ALSO
.BR dot (1),
which draws the graphs. The format of models, the tutorial and the theory are in the documentation.
END
