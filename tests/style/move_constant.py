#!/usr/bin/env python3
"""Move a named constant tenfold up and down and say which tests notice.

    move_constant.py ROOT FILE:NAME [TEST...]
    move_constant.py ROOT --defaults [FOLDER...]

The constant is found as constants.py finds it. Without TEST the tests are those that its comment names. The sources
are copied to build-constants/, where the constant is changed, the programs that the tests need are built and the tests
are run; the work tree stays as it is. Counts are rounded up. Exit status 1 if neither way is noticed.
"""
import filecmp
import json
import os
import shutil
import subprocess
import sys

import constants


class Copy:
    """A copy of the sources with its own build folder."""

    def __init__(self, root):
        self.root = os.path.abspath(root)
        self.tree = os.path.join(self.root, "build-constants", "tree")
        self.build = os.path.join(self.root, "build-constants", "build")
        listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=self.root, check=True,
                                capture_output=True, text=True).stdout.split("\n")
        for path in filter(None, listed):
            self.restore(path)
        if not os.path.exists(os.path.join(self.build, "build.ninja")):
            subprocess.run(["meson", "setup", self.build, self.tree, "-Dbuildtype=debugoptimized", "-Dtests=enabled"],
                           check=True, stdout=subprocess.DEVNULL)
        self.tests = {}  # a name may stand in two suites
        for test in self.introspect("--tests"):
            self.tests.setdefault(test["name"], []).append(test)
        self.known = {}  # whether a test passes with nothing changed
        self.files = {t["id"]: t["filename"] for t in self.introspect("--targets")}

    def introspect(self, what):
        listed = subprocess.run(["meson", "introspect", self.build, what], check=True, capture_output=True, text=True)
        return json.loads(listed.stdout)

    def restore(self, path):
        source, target = os.path.join(self.root, path), os.path.join(self.tree, path)
        if not os.path.isfile(source):
            return
        os.makedirs(os.path.dirname(target), exist_ok=True)
        if not os.path.exists(target) or not filecmp.cmp(source, target, shallow=False):
            shutil.copyfile(source, target)
            shutil.copymode(source, target)

    def change(self, constant, value):
        source, target = (os.path.join(r, constant.path) for r in (self.root, self.tree))
        with open(source) as f:
            text = f.read()
        start, end = constant.span
        with open(target, "w") as f:
            f.write(text[:start] + value + text[end:])

    def targets(self, names):
        depends = {d for name in names for test in self.tests[name] for d in test["depends"]}
        return sorted(os.path.relpath(f, self.build) for d in depends for f in self.files[d])

    def failing(self, names):
        """Names of tests that fail with nothing changed, or None where the build does."""
        new = [n for n in names if n not in self.known]
        failed = self.run(new) if new else []
        if failed is None:
            return None
        self.known.update({n: n not in failed for n in new})
        return [n for n in names if not self.known[n]]

    def run(self, names):
        """Names of the tests that fail, or None where the build does."""
        if subprocess.run(["ninja", "-C", self.build] + self.targets(names), stdout=subprocess.DEVNULL).returncode:
            return None
        log = os.path.join(self.build, "meson-logs", "testlog.json")
        if os.path.exists(log):
            os.remove(log)
        subprocess.run(["meson", "test", "-C", self.build, "--no-rebuild", "--timeout-multiplier", "10"] + names, stdin=subprocess.DEVNULL,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        failed = []
        with open(log) as f:
            for line in f:
                result = json.loads(line)
                if result["result"] not in ("OK", "SKIP", "EXPECTEDFAIL"):
                    failed.append(result["name"].split(" / ")[-1])
        return sorted(failed)


def is_count(constant):
    return constant.form == "enum" or not any(c in constant.value for c in ".eEpP")


def move(copy, constant, names):
    failing = copy.failing(names)
    if failing or failing is None:
        print("without a change: " + ("does not build" if failing is None else "fails: " + ", ".join(failing)))
        return False
    noticed = []
    for way, text in (("* 10", "({}) * 10"), ("/ 10", "(({}) + 9) / 10" if is_count(constant) else "({}) / 10")):
        copy.change(constant, text.format(constant.value))
        failed = copy.run(names)
        noticed.append(failed is None or bool(failed))
        what = "does not build" if failed is None else ", ".join(failed) if failed else "not noticed"
        print(f"{constant.path}:{constant.name} = {constant.value}  {way}: {what}", flush=True)
    copy.restore(constant.path)
    return any(noticed)


def main():
    root, rest = sys.argv[1], sys.argv[2:]
    found = constants.everything(root)[0]
    if rest[0] == "--defaults":
        chosen = [(c, c.tests) for c in found
                  if c.kind == "Default" and constants.within(c.path, rest[1:] or ["src/", "components/"])]
    else:
        path, name = rest[0].rsplit(":", 1)
        chosen = [(c, rest[1:] or c.tests) for c in found if c.path == path and c.name == name]
        if not chosen:
            sys.exit(f"{rest[0]}: no such constant")
    copy = Copy(root)
    bad = 0
    for constant, names in chosen:
        unknown = [n for n in names if n not in copy.tests]
        if unknown or not names:
            print(f"{constant.path}:{constant.name}: no test " + " ".join(unknown or ["is named"]))
            bad += 1
        elif not move(copy, constant, names):
            bad += 1
    print(f"{len(chosen) - bad} of {len(chosen)} noticed")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
