// Lists of component types and methods.
#include "base/entry.h"
#include "component/class.h"
#include "integrate/problem.h"

#include <cotree/cotree.h>

#include <string.h>

static const char *const family_names[] = {"bodies", "joints", "forces"};

// Column of the descriptions: after the longest key.
static int key_width(const struct ct_key *key, int n)
{
    int width = 12;
    for (int i = 0; i < n; i++)
        if ((int)strlen(key[i].name) > width)
            width = (int)strlen(key[i].name);
    return width;
}

static void print_keys(FILE *out, const struct ct_key *key, int n)
{
    for (int i = 0; i < n; i++) {
        fprintf(out, "    %-*s %s", key_width(key, n), key[i].name, key[i].doc);
        if (key[i].unit && *key[i].unit)
            fprintf(out, " [%s]", key[i].unit);
        if (key[i].flags & CT_KEY_REQUIRED)
            fputs("; must be given", out);
        fputc('\n', out);
    }
}

static void print_class(FILE *out, const struct ct_component_class *c)
{
    const int width = key_width(c->key, c->nkey);
    fprintf(out, "\n  %s: %s\n", c->name, c->summary);
    if (c->ncoord > 0)
        fprintf(out, "    %-*s %d, speeds %d\n", width, "coordinates", c->ncoord, c->nfree);
    fprintf(out, "    %-*s %s\n    %-*s %s\n", width, "across", c->across, width, "through",
            c->through);
    print_keys(out, c->key, c->nkey);
}

static void print_components(const void *all, FILE *out)
{
    (void)all;
    for (int f = 0; f < (int)COUNT(family_names); f++) {
        int nfamily;
        const struct ct_key *keys = ct_family_keys((enum ct_family)f, &nfamily);
        fprintf(out, "%s%s\n", f ? "\n" : "", family_names[f]);
        if (nfamily) {
            fputs("\n  keys of every type\n", out);
            print_keys(out, keys, nfamily);
        }
        for (int i = 0; i < ct_ncomponent_class; i++)
            if ((int)ct_component_classes[i]->family == f)
                print_class(out, ct_component_classes[i]);
    }
}

void ct_components_print(FILE *out)
{
    ct_print_to(out, print_components, "");
}

char *ct_components_text(void)
{
    return ct_print_text(print_components, "");
}

static void print_methods(const void *all, FILE *out)
{
    (void)all;
    fprintf(
        out, "%-24s %s\n", "auto",
        "dop853, or dopri5 for loose tolerances and fixed steps; radau5 where it turns stiff");
    for (int i = 0; i < ct_nmethod; i++)
        fprintf(out, "%-24s %s (order %d, %s)\n", ct_methods[i]->name, ct_methods[i]->summary,
                ct_methods[i]->order, ct_methods[i]->is_implicit ? "implicit" : "explicit");
}

void ct_methods_print(FILE *out)
{
    ct_print_to(out, print_methods, "");
}

char *ct_methods_text(void)
{
    return ct_print_text(print_methods, "");
}
