// See suffix.h.
#include "report/suffix.h"

#include <cotree/cotree.h>

#include <string.h>
#include <strings.h>

static const struct {
    enum ct_suffix suffix;
    const char *text;
} suffixes[]
    = {{CT_SUFFIX_CSV, ".csv"}, {CT_SUFFIX_CSV_GZ, ".csv.gz"}, {CT_SUFFIX_JSON, ".json"},
       {CT_SUFFIX_NPZ, ".npz"}, {CT_SUFFIX_MAT, ".mat"},       {CT_SUFFIX_SVG, ".svg"}};

static bool ends_with(const char *text, const char *end)
{
    const size_t n = strlen(text), k = strlen(end);
    return n > k && strcasecmp(text + n - k, end) == 0;
}

static bool refuse(struct ct_ctx *ctx, const char *path, const char *dot, unsigned allowed)
{
    const char *list = "", *separator = "";
    for (size_t i = 0; i < COUNT(suffixes); i++)
        if (suffixes[i].suffix & allowed) {
            list = ct_arena_printf(ctx->model, "%s%s%s", list, separator, suffixes[i].text);
            separator = ", ";
        }
    return ct_error(ctx, (struct ct_mark){0}, CT_E_SUFFIX,
                    "'%s': this output cannot be written as '%s'; the suffix must be one of %s",
                    path, dot, list);
}

bool ct_suffix_read(struct ct_ctx *ctx, const char *path, unsigned allowed,
                    enum ct_suffix *suffix)
{
    *suffix = (enum ct_suffix)(allowed & -allowed);
    if (!path || strcmp(path, "-") == 0)
        return true;
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path;
    // a leading dot marks a hidden file
    const char *dot = *base ? strrchr(base + 1, '.') : NULL;
    if (!dot)
        return true;
    for (size_t i = 0; i < COUNT(suffixes); i++)
        if (suffixes[i].suffix & allowed && ends_with(base, suffixes[i].text)) {
            *suffix = suffixes[i].suffix;
            return true;
        }
    return refuse(ctx, path, dot, allowed);
}

bool ct_can_write(struct ct_ctx *ctx, enum ct_contents contents, const char *path)
{
    static const unsigned allowed[] = {[CT_CONTENTS_TABLE] = CT_SUFFIX_TABLE,
                                       [CT_CONTENTS_SUMMARY] = CT_SUFFIX_JSON,
                                       [CT_CONTENTS_PLOT] = CT_SUFFIX_SVG};
    enum ct_suffix unused;
    return ct_suffix_read(ctx, path, allowed[contents], &unused);
}
