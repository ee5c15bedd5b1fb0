#!/usr/bin/env python3
"""Text of exported C as strings that the program is compiled with.

    templates.py TEMPLATE.c.in OUTPUT.h

A line `//// name` begins a part, which goes up to the next such line; what stands before the first one is about the
file. OUTPUT.h defines `text_NAME`, the lines of the part and NULL, for ct_export_put_lines.
"""
import sys

HEAD = "//// "


def quoted(line):
    return '"' + line.replace("\\", "\\\\").replace('"', '\\"') + '\\n"'


def main(template, output):
    with open(template) as f:
        lines = f.read().split("\n")[:-1]
    is_open = False
    with open(output, "w") as out:
        out.write("// Made by templates.py.\n")
        for line in lines:
            if line.startswith(HEAD):
                out.write("    NULL};\n" if is_open else "")
                out.write("\nstatic const char *const text_%s[] = {\n" % line[len(HEAD):])
                is_open = True
            elif is_open:
                out.write("    %s,\n" % quoted(line))
        out.write("    NULL};\n")


main(*sys.argv[1:])
