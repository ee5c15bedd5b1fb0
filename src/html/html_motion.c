// Section `motion`: the initial configuration as a line drawing; the script replaces it by the
// animation.
#include "html/html.h"

#include "draw/picture.h"

// Limit: the motion takes half a megabyte of the page at most, at about a byte for each number.
enum { MOST_NUMBERS = 500000, MOST_ROWS = 2001, LEAST_ROWS = 201 };

static size_t most_rows(const struct ct_animation *m)
{
    const size_t n = MOST_NUMBERS / (m->ncolumn + 1);
    return n < LEAST_ROWS ? LEAST_ROWS : n > MOST_ROWS ? MOST_ROWS : n;
}

// Redundant constraints leave multipliers, and so reactions, undetermined.
static bool has_open_reactions(const struct ct_html *h)
{
    bool is_open = false;
    for (size_t i = 0; i < h->sim->system->equations.nrow; i++)
        is_open |= h->sim->open.row[i];
    return is_open;
}

void ct_html_motion(struct ct_html *h)
{
    const struct ct_recording *r = h->recording;
    const struct ct_scene *scene = &r->animation.scene;
    struct ct_picture p = {.scene = scene, .value = r->first, .title = h->sys->model.name};
    struct ct_html_data d;
    ct_view_choose(&p.view, scene, NULL);
    ct_html_open_section(h, "motion", "Motion");
    fputs("<div id=\"motion-panel\">\n", h->out);
    ct_picture_print(h->out, h->a, &p);
    fputs("<p class=\"note start\">The start, t = 0 s.</p>\n</div>\n", h->out);
    ct_html_open_data(h, &d, "data-motion");
    ct_animation_write(h->a, &d.json, &r->animation, most_rows(&r->animation));
    ct_json_bool(&d.json, "open_reactions", has_open_reactions(h));
    ct_html_close_data(&d);
    ct_html_close_section(h);
}
