// Links and joints of a robot from XML, checked; see urdf.h.
#include "import/urdf.h"

#include "base/names.h"
#include "expr/parse.h"
#include "expr/unit.h"
#include "io/text.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const size_t max_bytes = (size_t)64 << 20; // Limit: with a message

struct reader {
    struct ct_ctx *ctx;
    struct ct_arena *a;
    struct ct_urdf *u;
    const struct ct_xml *robot;
    const char *path, *model;
    struct ct_names link, joint, id; // names -> indices; names already used
};

// ---- attributes ----------------------------------------------------------------------------

static bool wrong(struct reader *r, const struct ct_xml *e, const char *what)
{
    return ct_error(r->ctx, e->mark, CT_E_URDF, "<%s>: %s", e->name, what);
}

// Warns of an element that is ignored; owner: "link 'arm'".
static void ignore(struct reader *r, const struct ct_xml *e, const char *owner)
{
    ct_warning(r->ctx, e->mark, CT_E_URDF_IGNORED, "<%s>%s%s is ignored", e->name,
               *owner ? " of " : "", owner);
}

static const char *wanted(struct reader *r, const struct ct_xml *e, const char *attribute)
{
    const char *value = ct_xml_get(e, attribute);
    if (!value)
        wrong(r, e, ct_arena_printf(r->a, "the attribute '%s' is missing", attribute));
    return value;
}

// Reads n numbers separated by blanks. False, with a diagnostic, for anything else.
static bool read_numbers(struct reader *r, const struct ct_xml *e, const char *attribute,
                         double *value, size_t n)
{
    const char *text = ct_xml_get(e, attribute), *at = text;
    for (size_t i = 0; i < n; i++) {
        at += strspn(at, " \t\r\n");
        const double sign = *at == '-' ? -1 : 1;
        at += *at == '-' || *at == '+';
        const size_t length = ct_number_parse(at, &value[i]);
        value[i] *= sign;
        at += length;
        if (!length || !isfinite(value[i]) || (*at && !strchr(" \t\r\n", *at)))
            return wrong(r, e,
                         ct_arena_printf(r->a, "%s=\"%.60s\" should be %zu finite number%s",
                                         attribute, text, n, n == 1 ? "" : "s"));
    }
    return !at[strspn(at, " \t\r\n")]
        || wrong(r, e,
                 ct_arena_printf(r->a, "%s=\"%.60s\" has more than %zu number%s", attribute,
                                 text, n, n == 1 ? "" : "s"));
}

static bool read_optional(struct reader *r, const struct ct_xml *e, const char *attribute,
                          double *value, size_t n)
{
    return !ct_xml_get(e, attribute) || read_numbers(r, e, attribute, value, n);
}

static bool read_number(struct reader *r, const struct ct_xml *e, const char *attribute,
                        double *value)
{
    return wanted(r, e, attribute) && read_numbers(r, e, attribute, value, 1);
}

// Reads the <origin> of e; identity if there is none.
static bool read_origin(struct reader *r, const struct ct_xml *e, struct ct_urdf_pose *p)
{
    const struct ct_xml *origin = ct_xml_child(e, "origin");
    *p = (struct ct_urdf_pose){{0}, {0}};
    return !origin
        || (read_optional(r, origin, "xyz", p->xyz, 3)
            & read_optional(r, origin, "rpy", p->rpy, 3));
}

// Warns of the children of e that are not in the list (names separated by blanks).
static void ignore_others(struct reader *r, const struct ct_xml *e, const char *known,
                          const char *owner)
{
    for (const struct ct_xml *c = e->child; c; c = c->next) {
        const size_t n = strlen(c->name);
        const char *at = known;
        while ((at = strstr(at, c->name))
               && !((at == known || at[-1] == ' ') && (at[n] == ' ' || !at[n])))
            at += n;
        if (!at)
            ignore(r, c, owner);
    }
}

// ---- names ---------------------------------------------------------------------------------

static bool is_free(const struct reader *r, const char *id)
{
    static const char *const taken[] = {"ground", "system", "energy", "constraint"};
    for (size_t i = 0; i < COUNT(taken); i++)
        if (strcmp(taken[i], id) == 0)
            return false;
    return !ct_is_reserved(id) && ct_names_get(&r->id, id) < 0;
}

// Returns a valid name of the model format for a name in the file, which may be any text;
// `sort` makes it unique.
static const char *take_id(struct reader *r, const char *name, const char *sort)
{
    char *id = ct_arena_printf(r->a, "%s%s", *name >= '0' && *name <= '9' ? "_" : "",
                               *name ? name : "_");
    for (char *c = id; *c; c++)
        if (!(*c == '_' || (*c >= '0' && *c <= '9') || (*c >= 'a' && *c <= 'z')
              || (*c >= 'A' && *c <= 'Z')))
            *c = '_';
    const char *free_id = id;
    if (!is_free(r, free_id))
        free_id = ct_arena_printf(r->a, "%s_%s", id, sort);
    for (int i = 2; !is_free(r, free_id); i++)
        free_id = ct_arena_printf(r->a, "%s_%s%d", id, sort, i);
    ct_names_put(r->a, &r->id, free_id, 0);
    return free_id;
}

// ---- links ---------------------------------------------------------------------------------

static bool read_inertial(struct reader *r, const struct ct_xml *e, struct ct_urdf_link *l,
                          const char *owner)
{
    static const char *const names[] = {"ixx", "iyy", "izz", "ixy", "ixz", "iyz"};
    const struct ct_xml *mass = ct_xml_child(e, "mass"), *inertia = ct_xml_child(e, "inertia");
    struct ct_urdf_pose p;
    double own[6] = {0}, R[9];
    ignore_others(r, e, "origin mass inertia", owner);
    bool ok = read_origin(r, e, &p);
    if (!mass)
        ok = wrong(r, e, "it has no <mass>");
    else
        ok &= read_number(r, mass, "value", &l->mass);
    if (ok && l->mass < 0)
        ok = wrong(r, mass, "the mass is negative");
    for (int i = 0; i < 6 && inertia; i++)
        ok &= i < 3 ? read_number(r, inertia, names[i], &own[i])
                    : read_optional(r, inertia, names[i], &own[i], 1);
    ct_urdf_rotation(R, p.rpy);
    ct_urdf_turn_inertia(l->inertia, own, R);
    memcpy(l->com, p.xyz, sizeof l->com);
    return ok;
}

// "#rrggbb" of <material>: its own color or that of the material of its name.
static const char *read_color(struct reader *r, const struct ct_xml *material,
                              const char *owner)
{
    const char *name = ct_xml_get(material, "name");
    const struct ct_xml *color = ct_xml_child(material, "color");
    double rgba[4];
    unsigned part[3];
    for (const struct ct_xml *c = r->robot->child; c && !color; c = c->next)
        if (strcmp(c->name, "material") == 0 && name && ct_xml_get(c, "name")
            && strcmp(ct_xml_get(c, "name"), name) == 0)
            color = ct_xml_child(c, "color");
    ignore_others(r, material, "color", owner);
    if (!color || !wanted(r, color, "rgba") || !read_numbers(r, color, "rgba", rgba, 4))
        return NULL;
    for (int i = 0; i < 3; i++)
        part[i] = (unsigned)lround(255 * fmin(fmax(rgba[i], 0), 1));
    return ct_arena_printf(r->a, "#%02x%02x%02x", part[0], part[1], part[2]);
}

static bool is_readable(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (file)
        fclose(file);
    return file != NULL;
}

static const char *folder_of(struct reader *r, const char *path)
{
    const char *slash = path ? strrchr(path, '/') : NULL;
    return slash ? ct_arena_strndup(r->a, path, (size_t)(slash + 1 - path)) : "";
}

// Path of a mesh relative to the robot's file. package://NAME/PATH is searched in the folders
// above that are called NAME or contain PATH.
static const char *find_mesh(struct reader *r, const char *name)
{
    const char *folder = folder_of(r, r->path);
    if (strncmp(name, "file://", 7) == 0)
        return name + 7;
    if (strncmp(name, "package://", 10) != 0)
        return name[0] == '/' ? name : ct_arena_printf(r->a, "%s%s", folder, name);
    const char *in_package = strchr(name + 10, '/');
    for (int up = 0; up < 8 && in_package; up++) {
        const char *whole = ct_arena_printf(r->a, "%s%s", folder, name + 10),
                   *inside = ct_arena_printf(r->a, "%s%s", folder, in_package + 1);
        if (is_readable(whole))
            return whole;
        if (is_readable(inside))
            return inside;
        folder = ct_arena_printf(r->a, "%s../", folder);
    }
    return NULL;
}

// Path of a mesh in the model file: relative if both are in one folder, otherwise absolute.
static const char *seen_from_model(struct reader *r, const char *path)
{
    const char *folder = folder_of(r, r->path);
    if (r->model && strcmp(folder, folder_of(r, r->model)) == 0
        && strncmp(path, folder, strlen(folder)) == 0)
        return path + strlen(folder);
    char here[4096];
    return *path == '/' || !getcwd(here, sizeof here)
             ? path
             : ct_arena_printf(r->a, "%s/%s", here, path);
}

static bool ends_with(const char *text, const char *end)
{
    const size_t n = strlen(text), k = strlen(end);
    for (size_t i = 0; i < k; i++)
        if (n < k || (text[n - k + i] | 32) != (end[i] | 32))
            return false;
    return true;
}

// False, after a diagnostic, if the mesh cannot be used.
static bool read_mesh(struct reader *r, const struct ct_xml *e, struct ct_urdf_solid *s)
{
    const char *name = wanted(r, e, "filename"), *why = NULL, *path = NULL;
    double scale[3] = {1, 1, 1};
    if (!name || !read_optional(r, e, "scale", scale, 3))
        return false;
    if (!ends_with(name, ".stl"))
        why = "only STL files are drawn";
    else if (scale[0] != scale[1] || scale[0] != scale[2] || !(scale[0] > 0))
        why = "its scale is not one number for all axes, greater than 0";
    else if (!(path = find_mesh(r, name)) || !is_readable(path))
        why = "there is no such file";
    if (why) {
        ct_warning(r->ctx, e->mark, CT_E_URDF_IGNORED, "the mesh '%s' is ignored: %s", name,
                   why);
        return false;
    }
    s->file = seen_from_model(r, path);
    s->size[0] = scale[0];
    return true;
}

static bool read_geometry(struct reader *r, const struct ct_xml *e, struct ct_urdf_solid *s)
{
    const struct ct_xml *g = e->child;
    if (!g || g->next)
        return wrong(r, e, "it wants one of <box>, <cylinder>, <sphere>, <mesh>");
    if (strcmp(g->name, "box") == 0) {
        s->kind = CT_URDF_BOX;
        return wanted(r, g, "size") && read_numbers(r, g, "size", s->size, 3);
    }
    if (strcmp(g->name, "cylinder") == 0) {
        s->kind = CT_URDF_CYLINDER;
        return read_number(r, g, "radius", &s->size[0])
             & read_number(r, g, "length", &s->size[1]);
    }
    if (strcmp(g->name, "sphere") == 0) {
        s->kind = CT_URDF_SPHERE;
        return read_number(r, g, "radius", &s->size[0]);
    }
    if (strcmp(g->name, "mesh") == 0) {
        s->kind = CT_URDF_MESH;
        return read_mesh(r, g, s);
    }
    ignore(r, g, "the geometry");
    return false;
}

static void read_visual(struct reader *r, const struct ct_xml *e, struct ct_urdf_link *l,
                        const char *owner)
{
    struct ct_urdf_solid s = {.kind = CT_URDF_BOX};
    const struct ct_xml *geometry = ct_xml_child(e, "geometry"),
                        *material = ct_xml_child(e, "material");
    ignore_others(r, e, "origin geometry material", owner);
    if (material)
        s.color = read_color(r, material, owner);
    if (!geometry)
        wrong(r, e, "it has no <geometry>");
    else if (read_origin(r, e, &s.pose) & read_geometry(r, geometry, &s))
        CT_PUSH(r->a, l->solid, l->nsolid, l->solid_cap, s);
}

static void read_link(struct reader *r, const struct ct_xml *e)
{
    const char *name = wanted(r, e, "name");
    if (!name)
        return;
    if (ct_names_get(&r->link, name) >= 0) {
        wrong(r, e, ct_arena_printf(r->a, "the link '%s' is there twice", name));
        return;
    }
    const char *owner = ct_arena_printf(r->a, "link '%s'", name);
    struct ct_urdf_link l
        = {.name = name, .id = take_id(r, name, "link"), .mark = e->mark, .joint = -1};
    int ninertial = 0;
    for (const struct ct_xml *c = e->child; c; c = c->next)
        if (strcmp(c->name, "inertial") == 0 && ninertial++ == 0)
            read_inertial(r, c, &l, owner);
        else if (strcmp(c->name, "visual") == 0)
            read_visual(r, c, &l, owner);
        else
            ignore(r, c, owner);
    ct_names_put(r->a, &r->link, name, (int)r->u->nlink);
    CT_PUSH(r->a, r->u->link, r->u->nlink, r->u->link_cap, l);
}

// ---- joints --------------------------------------------------------------------------------

static bool read_type(struct reader *r, const struct ct_xml *e, enum ct_urdf_type *type)
{
    static const char *const names[]
        = {"revolute", "continuous", "prismatic", "fixed", "floating", "planar"};
    const char *text = wanted(r, e, "type");
    for (int i = 0; text && i < (int)COUNT(names); i++)
        if (strcmp(names[i], text) == 0) {
            *type = (enum ct_urdf_type)i;
            return true;
        }
    return text
        && wrong(r, e,
                 ct_arena_printf(r->a,
                                 "the type '%s' is none of revolute, continuous, prismatic, "
                                 "fixed, floating, planar",
                                 text));
}

// Index of the link that <parent> or <child> names; -1 after an error.
static int read_end(struct reader *r, const struct ct_xml *e, const char *which)
{
    const struct ct_xml *end = ct_xml_child(e, which);
    if (!end) {
        wrong(r, e, ct_arena_printf(r->a, "it has no <%s>", which));
        return -1;
    }
    const char *name = wanted(r, end, "link");
    const int i = name ? ct_names_get(&r->link, name) : -1;
    if (name && i < 0)
        wrong(r, end, ct_arena_printf(r->a, "there is no link '%s'", name));
    return i;
}

static const char *limits_of(struct reader *r, const struct ct_xml *limit)
{
    static const char *const names[] = {"lower", "upper", "effort", "velocity"};
    const char *text = "";
    for (size_t i = 0; i < COUNT(names); i++) {
        double value;
        if (ct_xml_get(limit, names[i]) && read_numbers(r, limit, names[i], &value, 1))
            text = ct_arena_printf(r->a, "%s%s%s %.12g", text, *text ? ", " : "", names[i],
                                   value);
    }
    return *text ? text : NULL;
}

static bool read_axis(struct reader *r, const struct ct_xml *e, struct ct_urdf_joint *j)
{
    const struct ct_xml *axis = ct_xml_child(e, "axis");
    j->axis[0] = 1;
    j->axis[1] = j->axis[2] = 0;
    if (!axis)
        return true;
    if (!wanted(r, axis, "xyz") || !read_numbers(r, axis, "xyz", j->axis, 3))
        return false;
    return j->axis[0] != 0 || j->axis[1] != 0 || j->axis[2] != 0
        || wrong(r, axis, "the axis has no direction");
}

static void read_joint(struct reader *r, const struct ct_xml *e)
{
    const char *name = wanted(r, e, "name");
    if (!name)
        return;
    const char *owner = ct_arena_printf(r->a, "joint '%s'", name);
    const struct ct_xml *dynamics = ct_xml_child(e, "dynamics"),
                        *limit = ct_xml_child(e, "limit"), *mimic = ct_xml_child(e, "mimic");
    struct ct_urdf_joint j = {.name = name, .mark = e->mark, .mimic = -1, .multiplier = 1};
    if (ct_names_get(&r->joint, name) >= 0) {
        wrong(r, e, ct_arena_printf(r->a, "the joint '%s' is there twice", name));
        return;
    }
    ignore_others(r, e, "origin parent child axis limit dynamics mimic", owner);
    bool ok = read_type(r, e, &j.type) & read_origin(r, e, &j.pose) & read_axis(r, e, &j);
    j.parent = read_end(r, e, "parent");
    j.child = read_end(r, e, "child");
    if (dynamics) {
        double friction = 0;
        ok &= read_optional(r, dynamics, "damping", &j.damping, 1)
            & read_optional(r, dynamics, "friction", &friction, 1);
        if (friction != 0)
            ct_warning(r->ctx, dynamics->mark, CT_E_URDF_IGNORED,
                       "the friction of %s is ignored: an 'effort' such as "
                       "-%g*tanh(J.u/0.001) stands for it",
                       owner, friction);
    }
    j.limits = limit ? limits_of(r, limit) : NULL;
    if (mimic)
        ok &= read_optional(r, mimic, "multiplier", &j.multiplier, 1)
            & read_optional(r, mimic, "offset", &j.offset, 1);
    ct_names_put(r->a, &r->joint, name, (int)r->u->njoint);
    if (!ok || j.parent < 0 || j.child < 0)
        return;
    if (r->u->link[j.child].joint >= 0) {
        wrong(r, e,
              ct_arena_printf(r->a, "link '%s' is a child of joint '%s' already",
                              r->u->link[j.child].name,
                              r->u->joint[r->u->link[j.child].joint].name));
        return;
    }
    r->u->link[j.child].joint = (int)r->u->njoint;
    j.id = take_id(r, name, "joint");
    ct_names_put(r->a, &r->joint, name, (int)r->u->njoint);
    CT_PUSH(r->a, r->u->joint, r->u->njoint, r->u->joint_cap, j);
}

static bool has_one_coordinate(const struct ct_urdf_joint *j)
{
    return j->type <= CT_URDF_PRISMATIC;
}

static void read_mimic(struct reader *r, const struct ct_xml *e)
{
    const struct ct_xml *mimic = ct_xml_child(e, "mimic");
    const char *name = ct_xml_get(e, "name"), *of = mimic ? wanted(r, mimic, "joint") : NULL;
    const int i = ct_names_get(&r->joint, name), k = of ? ct_names_get(&r->joint, of) : -1;
    if (!of)
        return;
    struct ct_urdf_joint *j = &r->u->joint[i];
    if (k < 0 || k == i)
        wrong(r, mimic, ct_arena_printf(r->a, "there is no other joint '%s'", of));
    else if (!has_one_coordinate(j) || !has_one_coordinate(&r->u->joint[k]))
        wrong(r, mimic, "one of the joints has no single coordinate");
    else if (j->multiplier == 0)
        wrong(r, mimic, "a multiplier of 0 is a fixed joint");
    else
        j->mimic = k;
    for (int at = j->mimic, steps = 0; at >= 0; at = r->u->joint[at].mimic)
        if (at == i || steps++ > (int)r->u->njoint) {
            wrong(r, mimic, "joints mimic each other in a circle");
            j->mimic = -1;
            return;
        }
    j->mimic_id = take_id(r, ct_arena_printf(r->a, "%s_mimic", j->id), "gear");
}

// ---- the robot -----------------------------------------------------------------------------

static bool is_xacro(const struct ct_xml *e)
{
    for (size_t i = 0; i < e->nattribute; i++)
        if (strstr(e->attribute[i].value, "${") || strstr(e->attribute[i].value, "$("))
            return true;
    return strncmp(e->name, "xacro:", 6) == 0;
}

static const struct ct_xml *find_xacro(const struct ct_xml *e)
{
    const struct ct_xml *found = is_xacro(e) ? e : NULL;
    for (const struct ct_xml *c = e->child; c && !found; c = c->next)
        found = find_xacro(c);
    return found;
}

// Checks that there is one root from which joints lead to every link.
static bool check_tree(struct reader *r)
{
    struct ct_urdf *u = r->u;
    u->root = -1;
    for (size_t i = 0; i < u->nlink; i++) {
        if (u->link[i].joint >= 0)
            continue;
        if (u->root >= 0)
            return ct_error(r->ctx, u->link[i].mark, CT_E_URDF,
                            "no joint leads to link '%s', nor to '%s': a robot has one root",
                            u->link[i].name, u->link[u->root].name);
        u->root = (int)i;
    }
    if (!u->nlink)
        return wrong(r, r->robot, "it has no <link>");
    if (u->root < 0)
        return wrong(r, r->robot, "joints lead from link to link in a circle");
    for (size_t i = 0; i < u->nlink; i++) {
        int at = (int)i;
        for (size_t steps = 0; u->link[at].joint >= 0; steps++) {
            at = u->joint[u->link[at].joint].parent;
            if (steps > u->nlink)
                return ct_error(r->ctx, u->link[i].mark, CT_E_URDF,
                                "joints lead to link '%s' in a circle", u->link[i].name);
        }
    }
    return true;
}

static bool is_called(const struct ct_xml *e, const char *name)
{
    return strcmp(e->name, name) == 0;
}

static bool read_robot(struct reader *r)
{
    const size_t before = r->ctx->nerror;
    const struct ct_xml *macro = find_xacro(r->robot), *robot = r->robot;
    if (macro)
        return ct_error(r->ctx, macro->mark, CT_E_XACRO,
                        "this is xacro, which is not read: expand it first, as in 'xacro "
                        "robot.xacro > robot.urdf'");
    if (!is_called(robot, "robot"))
        return wrong(r, robot, "the file of a robot begins with <robot>");
    r->u->name = ct_xml_get(robot, "name") ? ct_xml_get(robot, "name") : "robot";
    for (const struct ct_xml *e = robot->child; e; e = e->next)
        if (is_called(e, "link"))
            read_link(r, e);
        else if (!is_called(e, "joint") && !is_called(e, "material"))
            ignore(r, e, "");
    for (const struct ct_xml *e = robot->child; e; e = e->next)
        if (is_called(e, "joint"))
            read_joint(r, e);
    for (const struct ct_xml *e = robot->child; e && r->ctx->nerror == before; e = e->next)
        if (is_called(e, "joint"))
            read_mimic(r, e);
    return r->ctx->nerror == before && check_tree(r) && r->ctx->nerror == before;
}

bool ct_urdf_read(struct ct_ctx *ctx, const char *path, const char *model, struct ct_urdf *u)
{
    struct reader r = {.ctx = ctx, .a = ctx->model, .u = u, .path = path, .model = model};
    const struct ct_mark file = {.file = ct_arena_strdup(ctx->model, path)};
    char *text;
    size_t n;
    *u = (struct ct_urdf){0};
    switch (ct_text_read_regular(ctx->model, path, max_bytes, &text, &n)) {
    case CT_TEXT_UNREADABLE:
        return ct_error(ctx, (struct ct_mark){0}, CT_E_FILE, "cannot read '%s': %s", path,
                        strerror(errno));
    case CT_TEXT_TOO_BIG:
        return ct_error(ctx, file, CT_E_XML, "the file is larger than %zu MiB",
                        max_bytes >> 20);
    case CT_TEXT_ENDLESS:
        return ct_error(ctx, file, CT_E_XML, "the file is no regular file");
    case CT_TEXT_OK:
        break;
    }
    r.robot = ct_xml_parse(ctx, ctx->model, file.file, text, n);
    return r.robot && read_robot(&r);
}
