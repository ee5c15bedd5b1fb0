// The derivation, stage by stage; see equations_print.h.
#include "report/equations_print.h"

#include "formulate/formulate.h"
#include "report/derivation.h"

#include <string.h>

static const struct {
    const char *name;
    unsigned bit;
    void (*fill)(struct ct_derivation *d);
} stages_in_order[] = {
    {"terminal", CT_STAGE_TERMINAL, ct_stage_terminal},
    {"graph", CT_STAGE_GRAPH, ct_stage_graph},
    {"tree", CT_STAGE_TREE, ct_stage_tree},
    {"cutset", CT_STAGE_CUTSET, ct_stage_cutset},
    {"circuit", CT_STAGE_CIRCUIT, ct_stage_circuit},
    {"reduced", CT_STAGE_REDUCED, ct_stage_reduced},
};

static const char *const format_name[] = {"text", "latex", "html", "c", "json"};

unsigned ct_stage_find(const char *name, size_t length)
{
    if (length == 3 && !strncmp(name, "all", 3))
        return CT_STAGE_ALL;
    for (size_t i = 0; i < COUNT(stages_in_order); i++)
        if (strlen(stages_in_order[i].name) == length
            && !strncmp(stages_in_order[i].name, name, length))
            return stages_in_order[i].bit;
    return 0;
}

bool ct_equations_format_find(const char *name, enum ct_equations_format *format)
{
    for (size_t i = 0; i < COUNT(format_name); i++)
        if (!strcmp(format_name[i], name)) {
            *format = (enum ct_equations_format)i;
            return true;
        }
    return false;
}

bool ct_equations_print(FILE *out, struct ct_arena *scratch, struct ct_equations *e,
                        const struct ct_model *m, unsigned stages,
                        enum ct_equations_format format, bool is_full)
{
    struct ct_derivation d;
    const enum ct_look look = format == CT_FORMAT_LATEX ? CT_LOOK_LATEX
                            : format == CT_FORMAT_HTML  ? CT_LOOK_HTML
                                                        : CT_LOOK_TEXT;
    ct_derivation_init(&d, scratch, e, m, look);
    d.page.is_full = is_full;
    d.is_recursive = d.is_recursive && format != CT_FORMAT_C; // its function returns M
    if (!d.is_recursive)
        ct_formulate_dynamics(e);
    d.page.is_summary = e->nmotion > CT_MOST_MATRIX_SPEEDS && !is_full;
    const bool is_page = format != CT_FORMAT_C && format != CT_FORMAT_JSON;
    if (d.page.is_summary)
        ct_page_sentence(&d.page,
                         "A summary, as there are more than %d speeds: lists show their first "
                         "and last lines; --full prints all.",
                         CT_MOST_MATRIX_SPEEDS);
    for (size_t i = 0; is_page && i < COUNT(stages_in_order); i++)
        if (stages & stages_in_order[i].bit)
            stages_in_order[i].fill(&d);
    if (d.page.is_summary)
        ct_page_shorten(&d.page);
    switch (format) {
    case CT_FORMAT_TEXT:
        ct_page_print_text(out, &d.page);
        break;
    case CT_FORMAT_LATEX:
        ct_page_print_latex(out, &d.page);
        break;
    case CT_FORMAT_HTML:
        ct_page_print_html(out, &d.page, m->name ? m->name : "equations");
        break;
    case CT_FORMAT_C:
        ct_derivation_print_c(out, &d);
        break;
    case CT_FORMAT_JSON:
        ct_derivation_print_json(out, &d, stages);
        break;
    }
    return !ferror(out);
}
