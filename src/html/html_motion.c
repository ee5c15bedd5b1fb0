// Section `motion`: the mechanism at its start as a line drawing; the script puts the moving one in its place.
#include "html/html.h"

void ct_html_motion(struct ct_html *h)
{
    const struct ct_recording *r = h->recording;
    struct ct_picture p = {.scene = &r->scene, .value = r->first, .title = h->sys->model.name};
    ct_view_choose(&p.view, &r->scene, NULL);
    ct_html_open_section(h, "motion", "Motion");
    fputs("<div id=\"motion-panel\">\n", h->out);
    ct_picture_print(h->out, h->a, &p);
    fputs("</div>\n", h->out);
    ct_html_close_section(h);
}
