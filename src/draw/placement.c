// See placement.h. A label tries directions around each of its anchor points, the nearest
// first. This greedy choice is known to be nearly optimal where labels are not crowded.
#include "draw/placement.h"
#include "base/pi.h"

#include <math.h>

// Layout: of the picture
enum { NDIRECTION = 16, NDISTANCE = 3 };

struct box {
    struct ct_spot low, high;
};

// The box of the text at a distance from the anchor point, in a direction.
static struct box box_at(const struct ct_label *l, struct ct_spot at, double angle, double away,
                         double width)
{
    const double height = l->font, dx = cos(angle), dy = -sin(angle);
    const struct ct_spot edge = {at.x + away * dx, at.y + away * dy};
    const struct ct_spot centre = {edge.x + dx * width / 2, edge.y + dy * height / 2};
    return (struct box){{centre.x - width / 2, centre.y - height / 2},
                        {centre.x + width / 2, centre.y + height / 2}};
}

static bool find_box(const struct ct_canvas *c, const struct ct_label *l, struct box *found)
{
    const double width = ct_canvas_text_width(l->text, l->font);
    // the upper right first, then the other directions
    static const int order[NDIRECTION] = {2, 6, 14, 10, 4, 12, 0, 8, 1, 3, 5, 7, 9, 11, 13, 15};
    for (int k = 0; k < NDISTANCE; k++)
        for (size_t i = 0; i < l->n; i++)
            for (int d = 0; d < NDIRECTION; d++) {
                const double angle = 2 * CT_PI * order[d] / NDIRECTION;
                const double away = l->away + 5.0 * k;
                *found = box_at(l, l->position[i], angle, away, width);
                if (ct_canvas_count_taken(c, found->low, found->high) == 0)
                    return true;
            }
    return false;
}

void ct_labels_write(struct ct_canvas *c, const struct ct_label *label, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        struct box b;
        if (!find_box(c, &label[i], &b))
            continue;
        const double baseline = b.high.y - 0.22 * label[i].font;
        const struct ct_spot at = {(b.low.x + b.high.x) / 2, baseline};
        ct_canvas_text(c, at, "middle", label[i].attributes, label[i].text);
        ct_canvas_take_box(c, b.low, b.high);
    }
}
