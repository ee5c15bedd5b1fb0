# What the program of docs/api.md prints.
"$PROGRAM"
