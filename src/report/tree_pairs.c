// See tree_pairs.h. Without a search, only the pair of the equations is listed.
#include "report/tree_pairs.h"

#include "formulate/build.h"
#include "report/json.h"

#include <math.h>
#include <string.h>

static bool is_pair_of(const struct ct_equations *e, const struct ct_tree_candidate *c)
{
    const size_t size = (size_t)e->graph->nedge * sizeof(bool);
    return !memcmp(c->trans, e->T->is_branch, size) && !memcmp(c->rot, e->R->is_branch, size);
}

int ct_tree_pairs_chosen(const struct ct_equations *e, const struct ct_tree_report *r)
{
    for (int i = 0; i < r->ncandidate; i++)
        if (is_pair_of(e, &r->candidate[i]))
            return i;
    return -1;
}

const char *ct_tree_pairs_reason(struct ct_arena *a, const struct ct_equations *e,
                                 const struct ct_tree_report *r)
{
    const int chosen = ct_tree_pairs_chosen(e, r);
    if (chosen < 0)
        return r->how;
    const int other = chosen == 0 ? 1 : 0;
    const double cost = r->candidate[chosen].cost;
    if (other >= r->ncandidate)
        return ct_arena_printf(a, "%s: %.0f operations", r->how, cost);
    const struct ct_tree_candidate *c = &r->candidate[other];
    const double more = c->cost - cost;
    const char *needs = more > 0   ? ct_arena_printf(a, "%.0f more", more)
                      : more < 0   ? ct_arena_printf(a, "%.0f fewer", -more)
                      : other == 0 ? "as many"
                      : c->nu > r->candidate[chosen].nu ? "as many and has more unknowns"
                                                        : "as many and was found later";
    return ct_arena_printf(a, "%s: %.0f operations; number %d needs %s", r->how, cost,
                           other + 1, needs);
}

size_t ct_tree_pairs_names(struct ct_arena *a, const struct ct_equations *e,
                           const bool *is_branch, const char *const **name)
{
    const char **list = CT_NEWN(a, const char *, (size_t)e->graph->nedge + 1);
    size_t n = 0;
    for (int i = 0; i < e->graph->nedge; i++)
        if (is_branch[i] && e->build->topology->edge[i].kind != CT_EDGE_ARM)
            list[n++] = e->edge_name[i];
    *name = list;
    return n;
}

static const char *key(int k)
{
    return k ? "rotation" : "translation";
}

// As in a tree file.
static void print_branches(FILE *out, struct ct_arena *a, const struct ct_equations *e, int k,
                           const bool *is_branch)
{
    const char *const *name;
    const size_t n = ct_tree_pairs_names(a, e, is_branch, &name);
    fprintf(out, "      %s: [", key(k));
    for (size_t i = 0; i < n; i++)
        fprintf(out, "%s%s", i ? ", " : "", name[i]);
    fputs("]\n", out);
}

void ct_tree_pairs_print_text(FILE *out, struct ct_arena *a, const struct ct_equations *e,
                              const struct ct_tree_report *r)
{
    const int chosen = ct_tree_pairs_chosen(e, r);
    fprintf(out, "Pairs of trees\n\n%s\n\n", ct_tree_pairs_reason(a, e, r));
    fputs("  nr  unknowns  rows  operations\n", out);
    if (chosen < 0) {
        fprintf(out, "   *  %8zu  %4zu           -\n", e->nu, e->nrow);
        print_branches(out, a, e, 0, e->T->is_branch);
        print_branches(out, a, e, 1, e->R->is_branch);
    }
    for (int i = 0; i < r->ncandidate; i++) {
        const struct ct_tree_candidate *c = &r->candidate[i];
        fprintf(out, "%3d%s  %8zu  %4zu  %10.0f\n", i + 1, i == chosen ? "*" : " ", c->nu,
                c->nrow, c->cost);
        print_branches(out, a, e, 0, c->trans);
        print_branches(out, a, e, 1, c->rot);
    }
    fputs("\n* chosen", out);
    if (r->ncandidate > 1)
        fprintf(out, "; --tree %d chooses number %d, and so does a tree file with its lines",
                chosen == 1 ? 1 : 2, chosen == 1 ? 1 : 2);
    fputc('\n', out);
}

// cost: NAN if it was not counted.
static void put_pair(struct ct_json *j, struct ct_arena *a, const struct ct_equations *e,
                     const struct ct_tree_candidate *c, bool is_chosen)
{
    const bool *const branch[] = {c->trans, c->rot};
    ct_json_object(j, NULL);
    ct_json_integer(j, "unknowns", (long long)c->nu);
    ct_json_integer(j, "rows", (long long)c->nrow);
    ct_json_number(j, "operations", c->cost);
    ct_json_bool(j, "chosen", is_chosen);
    for (int k = 0; k < 2; k++) {
        const char *const *name;
        const size_t n = ct_tree_pairs_names(a, e, branch[k], &name);
        ct_json_array(j, key(k));
        for (size_t i = 0; i < n; i++)
            ct_json_text(j, NULL, name[i]);
        ct_json_end(j);
    }
    ct_json_end(j);
}

void ct_tree_pairs_print_json(FILE *out, struct ct_arena *a, const struct ct_equations *e,
                              const struct ct_tree_report *r)
{
    const int chosen = ct_tree_pairs_chosen(e, r);
    const struct ct_tree_candidate own
        = {e->T->is_branch, e->R->is_branch, e->nu, e->nrow, NAN};
    struct ct_json j;
    ct_json_init(&j, out);
    ct_json_object(&j, NULL);
    ct_json_text(&j, "why", ct_tree_pairs_reason(a, e, r));
    ct_json_array(&j, "pairs");
    if (chosen < 0)
        put_pair(&j, a, e, &own, true);
    for (int i = 0; i < r->ncandidate; i++)
        put_pair(&j, a, e, &r->candidate[i], i == chosen);
    ct_json_end(&j);
    ct_json_end(&j);
}
