// The report: a model, its equations and its motion as one HTML file.
//
//     document.c    the file: head, sections in their order, data, script
//     recording.c   the run, sample by sample, thinned where it is long
//     element.c     escaping, headings, data blocks
//     html_*.c   one section each: plain HTML, complete without scripts
//     modes_page.c  the page of `modes --report`
//     layout.c      where the vertices of the linear graph stand
//
// The scripts in web/ make it move and link it; web/README.md has the data they read.
//
// What always holds: the same system and options give the same bytes; text that comes from a model goes through
// ct_html_put, so that it is text whatever it contains; the file asks for nothing from outside.
#ifndef CT_HTML_HTML_H
#define CT_HTML_HTML_H

#include "html/recording.h"
#include "report/json.h"

/// The model file, as it was written.
struct ct_source {
    const char *text; // NULL: not at hand
    size_t n;         // bytes
    const char **line;
    size_t nline;
};

struct ct_html {
    FILE *out;
    struct ct_ctx *ctx;    // of the caller: its diagnostics are shown
    struct ct_arena *a;    // for the time of the call
    struct ct_system *sys; // a copy
    struct ct_sim *sim;    // that has run
    const struct ct_recording *recording;
    struct ct_terms_recording *terms; // terms.h
    const struct ct_source *source;
    bool stopped; // the run ended with an error; what was recorded before it is shown
    const struct ct_report_options *options;
};

// ---- element.c --------------------------------------------------------------------------------

/// Text, also in attributes in double quotes, see ct_html_text.
void ct_html_put(FILE *out, const char *text);
/// The same, isolated from the direction of what stands beside it.
void ct_html_put_name(FILE *out, const char *text);
/// <section id=""><h2>...</h2>; ends with </section>.
void ct_html_open_section(struct ct_html *h, const char *id, const char *title);
void ct_html_close_section(struct ct_html *h);
/// data-component="": a blank before it; nothing without names.
void ct_html_put_components(FILE *out, const char *names);
/// Five digits, as numbers in sentences and tables.
void ct_html_put_number(FILE *out, double v);

/// Mathematics of a page of CT_LOOK_HTML as one <math>; right NULL: left alone.
void ct_html_put_equation(FILE *out, const char *left, const char *right);

/// JSON that comes into a <script type="application/json" id=""> when it ends.
struct ct_html_data {
    struct ct_html *h;
    const char *id;
    struct ct_json json;
    struct ct_text_stream *stream;
};
/// A stream into memory, which goes with h->a.
struct ct_text_stream *ct_html_open_text(struct ct_html *h);
FILE *ct_html_text_stream(struct ct_text_stream *s);
/// What was written. Raises the guard without memory.
const char *ct_html_close_text(struct ct_text_stream *s);
/// An object is open.
void ct_html_open_data(struct ct_html *h, struct ct_html_data *d, const char *id);
/// Closes the object.
void ct_html_close_data(struct ct_html_data *d);

// ---- document.c: what all pages have -----------------------------------------------------------

/// False with a diagnostic where the program was built without pages.
bool ct_html_is_built(struct ct_ctx *ctx);
/// Up to </head>, with the style; the script and the end.
void ct_html_put_head(struct ct_html *h);
void ct_html_put_script(struct ct_html *h);

// ---- sections, in the order of the page ---------------------------------------------------------

void ct_html_summary(struct ct_html *h);
void ct_html_motion(struct ct_html *h);
void ct_html_model(struct ct_html *h);
void ct_html_graph(struct ct_html *h);
void ct_html_trees(struct ct_html *h);
void ct_html_derivation(struct ct_html *h);
void ct_html_equations(struct ct_html *h);
void ct_html_loops(struct ct_html *h);
void ct_html_plots(struct ct_html *h);
void ct_html_accuracy(struct ct_html *h);
void ct_html_left_out(struct ct_html *h);
void ct_html_manifest(struct ct_html *h);

/// The data of the scripts that belong to no section.
void ct_html_write_run(struct ct_html *h);

#endif
