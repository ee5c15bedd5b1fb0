// This folder writes HTML pages: the report of a model, its equations and its motion, and the
// page of animated modes. A page is one file.
//
//     document.c    the file: head, sections in their order, data, script
//     recording.c   the samples of the run, thinned if there are many
//     element.c     escaping, headings, data blocks
//     html_*.c      one section each: plain HTML, complete without scripts
//     modes_page.c  the page of `modes --report`
//     layout.c      positions of the vertices of the linear graph
//
// The scripts in web/ add animation and links between sections; web/README.md describes the
// data they read.
//
// What always holds: the same system and options give the same bytes. Text from a model is
// written by ct_html_put, which escapes it. The page loads nothing from outside.
#ifndef CT_HTML_HTML_H
#define CT_HTML_HTML_H

#include "html/recording.h"
#include "report/json.h"

/// The model file, as it was written.
struct ct_source {
    const char *text; // NULL: not available
    size_t n;         // bytes
    const char **line;
    size_t nline;
};

struct ct_html {
    FILE *out;
    struct ct_ctx *ctx;    // of the caller; its diagnostics are shown on the page
    struct ct_arena *a;    // for the duration of the call
    struct ct_system *sys; // a copy
    struct ct_sim *sim;    // after its run
    const struct ct_recording *recording;
    struct ct_terms_recording *terms; // terms.h
    const struct ct_source *source;
    bool stopped; // the run ended with an error; what was recorded before it is shown
    const struct ct_report_options *options;
};

// ---- element.c -----------------------------------------------------------------------------

/// Writes text, escaped for content and for attributes in double quotes; see ct_html_text.
void ct_html_put(FILE *out, const char *text);
/// The same, isolated from the text direction of its surroundings.
void ct_html_put_name(FILE *out, const char *text);
/// Opens <section id=""><h2>...</h2>; the caller writes </section>.
void ct_html_open_section(struct ct_html *h, const char *id, const char *title);
void ct_html_close_section(struct ct_html *h);
/// Writes data-component="" after a blank; nothing without names.
void ct_html_put_components(FILE *out, const char *names);
/// Writes a number with five digits, as in sentences and tables.
void ct_html_put_number(FILE *out, double v);

/// Writes mathematics of a page of CT_LOOK_HTML as one <math>; right NULL: left only.
void ct_html_put_equation(FILE *out, const char *left, const char *right);

/// JSON that is written into a <script type="application/json" id=""> when it is closed.
struct ct_html_data {
    struct ct_html *h;
    const char *id;
    struct ct_json json;
    struct ct_text_stream *stream;
};
/// Opens a stream into memory that lives as long as h->a.
struct ct_text_stream *ct_html_open_text(struct ct_html *h);
FILE *ct_html_text_stream(struct ct_text_stream *s);
/// Closes it and returns its text. Raises the guard if memory is exhausted.
const char *ct_html_close_text(struct ct_text_stream *s);
/// Opens JSON data with an open object.
void ct_html_open_data(struct ct_html *h, struct ct_html_data *d, const char *id);
/// Closes the object and writes the data.
void ct_html_close_data(struct ct_html_data *d);

// ---- document.c: what all pages have -------------------------------------------------------

/// False, with a diagnostic, if the program was built without pages.
bool ct_html_is_built(struct ct_ctx *ctx);
/// Writes the page up to </head>, with the style; writes the script and the end.
void ct_html_put_head(struct ct_html *h);
void ct_html_put_script(struct ct_html *h);

// ---- sections, in the order of the page ----------------------------------------------------

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

/// Writes the data of scripts that belong to no section.
void ct_html_write_run(struct ct_html *h);

#endif
