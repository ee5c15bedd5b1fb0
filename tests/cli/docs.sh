# The documents say what the program does: docs/cli.md has every command and option of --help, docs/format.md
# every component type and key, and the commands of docs/tutorial.md run.
. "$(dirname "$0")/lib.sh"
docs=$(dirname "$0")/../../docs

commands=$("$COTREE" --help | sed -n 's/^  \([a-z][a-z]*\)  .*/\1/p' | grep -v '^cotree$')
for command in $commands; do
  grep -Eq "^### .*$command" "$docs/cli.md" || echo "cli.md lacks the command $command"
  "$COTREE" "$command" --help | sed -n 's/^  \(-[a-z], \)*\(--[a-z-]*\).*/\2/p'
done | LC_ALL=C sort -u >options
grep -v '^--' options
for option in $(grep '^--' options); do
  grep -q -- "^| .*\`$option[ \`]" "$docs/cli.md" || echo "cli.md lacks the option $option"
done
for option in $(sed -n 's/^| \(`-[a-z][^`]*`, \)*`\(--[a-z-]*\).*/\2/p' "$docs/cli.md"); do
  grep -qx -- "$option" options || [ "$option" = --version ] || echo "the program lacks the option $option"
done

for word in $("$COTREE" components | sed -n 's/^  \([a-z]*\): .*/\1/p; s/^    \([a-z]*\) .*/\1/p' | sort -u); do
  case $word in across | through | coordinates) continue ;; esac
  grep -Eq "\`[^\`]*\b$word\b" "$docs/format.md" || echo "format.md lacks $word"
done

# blocks of the tutorial: YAML goes to files, commands to a script
awk '
  /^```yaml/ { split("pendulum four_bar column profile", names, " "); file = names[++nyaml] ".yaml"; next }
  /^```sh/ { file = "commands"; next }
  /^```/ { if (file == "") file = "printed"; else file = ""; next }
  file != "" && file != "printed" { print > file }
  file == "printed" { print > file }' "$docs/tutorial.md"
mkdir bin
ln -s "$COTREE" bin/cotree
PATH=$PWD/bin:$PATH
sh -e ./commands >out 2>err || { echo "the tutorial fails"; cat err; }
"$COTREE" equations pendulum.yaml --show reduced | diff - printed && echo "what is shown is what is printed"
wc -l <commands
ls ./*.csv ./*.tex ./*.c

# the equations in the README are those of the program
awk '/^```$/ { inside = !inside; next } inside' "$docs/../README.md" >shown
"$COTREE" equations "$SYSTEMS/slider_crank/model.yaml" --show reduced --tree joints | sed -n '/^motion/,/Phi = 0/p; /^  guide.across: /p' |
  diff - shown && echo "so in the README"
