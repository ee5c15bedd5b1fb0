// A model as an FMU: description, sources and binary in one archive. See fmu.h.
#include "export/fmu.h"

#include "report/archive.h"

#include <string.h>

// Tolerance of steps relative to the tolerance of co-simulation, because local errors
// accumulate over a run.
// Chosen: accuracy of co-simulation against number of steps.
static const double step_tolerance_ratio = 1e-2;

#if defined(__linux__) && defined(__x86_64__)
static const char *const platform[] = {"linux64", "x86_64-linux"}; // of FMI 2.0, of 3.0
#elif defined(__linux__) && defined(__aarch64__)
static const char *const platform[] = {NULL, "aarch64-linux"};
#else
static const char *const platform[] = {NULL, NULL};
#endif

// 64-bit FNV-1a, continued from h.
static uint64_t hash(uint64_t h, const char *text)
{
    for (; *text; text++)
        h = (h ^ (unsigned char)*text) * UINT64_C(0x100000001b3);
    return h;
}

// The GUID of a model: the same for the same model, different for others.
static const char *find_token(struct ct_arena *a, const char *header, const char *source)
{
    const uint64_t one = hash(hash(UINT64_C(0xcbf29ce484222325), header), source),
                   two = hash(hash(one, source), header);
    return ct_arena_printf(a, "{%08x-%04x-%04x-%04x-%012llx}", (unsigned)(one >> 32),
                           (unsigned)(one >> 16 & 0xffff), (unsigned)(one & 0xffff),
                           (unsigned)(two >> 48),
                           (unsigned long long)(two & UINT64_C(0xffffffffffff)));
}

static void add_text(struct ct_archive *z, const char *name, const char *text)
{
    struct ct_archive_bytes b = {.arena = z->arena};
    ct_archive_put_text(&b, text);
    ct_archive_add_file(z, name, &b);
}

static void add_binary(struct ct_archive *z, const char *name, const struct ct_compiled *c)
{
    struct ct_archive_bytes b = {.arena = z->arena};
    for (size_t i = 0; i < c->n; i++)
        ct_archive_put(&b, c->b[i], 1);
    ct_archive_add_file(z, name, &b);
}

bool ct_fmu_write(struct ct_exported *w, int version, const char *path)
{
    struct ct_arena *a = w->ctx->model;
    struct ct_fmu f = {.w = w, .version = version};
    f.source = (struct ct_export_fmu){
        .version = version, .tolerance = w->sim->tolerance, .share = step_tolerance_ratio};
    ct_fmu_list_variables(&f);
    ct_fmu_find_dependencies(&f);
    ct_fmu_list_directions(&f);
    const char *header = ct_export_header(a, &w->x), *source = ct_export_source(a, &w->x);
    f.source.token = find_token(a, header, source);
    const char *fmu = ct_export_fmu(a, &w->x, &f.source);
    const char *folder = platform[version == 3];
    const struct ct_compiled binary
        = folder
            ? ct_compile_library(a, w->x.name, header, source, fmu)
            : (struct ct_compiled){
                .why_not = "there is no name for this platform, or cotree does not know it"};
    if (!binary.b)
        ct_warning(w->ctx, (struct ct_mark){0}, CT_E_NO_BINARY,
                   "'%s' contains sources only, no binary: %s", path, binary.why_not);
    struct ct_outfile file;
    if (!ct_outfile_open(w->ctx, &file, path))
        return false;
    struct ct_archive z = {.arena = a, .file = &file};
    add_text(&z, "modelDescription.xml", ct_fmu_description(&f));
    if (binary.b)
        add_binary(&z, ct_arena_printf(a, "binaries/%s/%s.so", folder, w->x.name), &binary);
    add_text(&z, "sources/fmu.c", fmu);
    add_text(&z, ct_arena_printf(a, "sources/%s.c", w->x.name), source);
    add_text(&z, ct_arena_printf(a, "sources/%s.h", w->x.name), header);
    if (version == 3)
        add_text(&z, "sources/buildDescription.xml", ct_fmu_build_description(&f));
    ct_archive_finish_files(&z);
    if (z.is_too_long) {
        ct_outfile_discard(&file);
        return ct_error(w->ctx, (struct ct_mark){0}, CT_E_FILE,
                        "cannot write '%s': it is too long for a ZIP archive", path);
    }
    return ct_outfile_close(w->ctx, &file);
}
