# What both tests share: a folder with the pendulum, the commands of docs/clusters.md, the rows that must come out.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
docs=$here/../../docs

skip() {
  echo "skipped: $*"
  exit 77
}

# block WORD...: what stands between ```WORD... and ``` in the page
block() {
  awk -v head="\`\`\`$*" '$0 == head { inside = 1; next } /^```$/ { inside = 0 } inside' "$docs/clusters.md"
}

begin() {
  folder=$(mktemp -d)
  cd "$folder"
  mkdir bin
  ln -s "$COTREE" bin/cotree
  PATH=$folder/bin:$PATH
  export PATH
  cat >pendulum.yaml <<'END'
cotree: 1
name: pendulum
parameters: {length: 1, mass: 2}
gravity: [0, -9.81, 0]
bodies:
  bob: {mass: mass, inertia: 0.01, com: [0, -length, 0]}
joints:
  pivot: {type: revolute, from: ground, to: bob, initial: {q: 0.5}}
outputs: [pivot.q]
simulation: {duration: 5, samples: 101}
END
  cotree sweep pendulum.yaml --quiet --vary length=0.5:2:40 --vary mass=1:2:5 --take "fastest=max(abs(pivot.u))" -o whole.csv
}

# The merged file is that of the whole sweep, made of 8 parts.
check() {
  cmp all.csv whole.csv
  [ "$(ls part.*.csv | wc -l)" = 8 ]
  [ "$(wc -l <all.csv)" = 201 ]
  echo "8 parts, 200 runs: the same bytes"
}
