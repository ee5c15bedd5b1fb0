// A small importer of FMUs, of FMI 2.0 and 3.0, for tests: unpacks the archive, reads the
// description, loads the binary.
//
//     importer FILE.fmu me STEP UNTIL        model exchange by a Runge-Kutta method of order 4 with steps of STEP, events located
//     importer FILE.fmu cs STEP UNTIL        co-simulation with communication steps of STEP
//     importer FILE.fmu check                states saved and restored, directional derivatives, dependencies, instances, refusals
//     ... NAME=VALUE ...                     values set before the start
//     importer FILE.fmu unpack FOLDER        its files
//
// Prints the time and all outputs as CSV, a row a tenth of UNTIL or, with ROWS=N in the
// environment, N rows and the start.
#define _POSIX_C_SOURCE 200809L
#include <dlfcn.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

enum { MOST = 4000, LONGEST = 300 };

static void fail(const char *what)
{
    printf("importer: %s\n", what);
    exit(1);
}

// ---- the archive --------------------------------------------------------------------------------

static unsigned char *archive;
static size_t archive_size;

static void read_archive(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        fail("no such file");
    fseek(file, 0, SEEK_END);
    archive_size = (size_t)ftell(file);
    archive = malloc(archive_size);
    rewind(file);
    if (fread(archive, 1, archive_size, file) != archive_size)
        fail("cannot read");
    fclose(file);
}

static size_t number(size_t at, int bytes)
{
    size_t v = 0;
    for (int i = bytes; i-- > 0;)
        v = v << 8 | archive[at + (size_t)i];
    return v;
}

// The next file of the archive from *at on, by its local header; NULL at the end.
static unsigned char *next_file(size_t *at, char *name, size_t *size)
{
    if (*at + 30 > archive_size || number(*at, 4) != 0x04034b50)
        return NULL;
    const size_t packed = number(*at + 18, 4), nname = number(*at + 26, 2);
    *size = number(*at + 22, 4);
    if (number(*at + 8, 2) != 8 || nname >= LONGEST)
        fail("a file is stored in another way");
    memcpy(name, archive + *at + 30, nname);
    name[nname] = 0;
    unsigned char *out = calloc(*size + 1, 1);
    z_stream z = {.next_in = archive + *at + 30 + nname + number(*at + 28, 2),
                  .avail_in = (uInt)packed,
                  .next_out = out,
                  .avail_out = (uInt)*size};
    const size_t crc = number(*at + 14, 4);
    if (inflateInit2(&z, -15) != Z_OK || inflate(&z, Z_FINISH) != Z_STREAM_END
        || crc32(crc32(0, NULL, 0), out, (uInt)*size) != crc)
        fail("a file is damaged");
    inflateEnd(&z);
    *at += 30 + nname + number(*at + 28, 2) + packed;
    return out;
}

static unsigned char *find_file(const char *wanted, size_t *size)
{
    char name[LONGEST];
    unsigned char *b;
    for (size_t at = 0; (b = next_file(&at, name, size)); free(b))
        if (!strcmp(name, wanted))
            return b;
    return NULL;
}

static void unpack(const char *folder)
{
    char name[LONGEST], path[2 * LONGEST];
    unsigned char *b;
    size_t size;
    for (size_t at = 0; (b = next_file(&at, name, &size)); free(b)) {
        snprintf(path, sizeof path, "%s/%s", folder, name);
        for (char *s = path + 1; (s = strchr(s, '/')); *s++ = '/') {
            *s = 0;
            mkdir(path, 0777);
        }
        FILE *file = fopen(path, "wb");
        if (!file || fwrite(b, 1, size, file) != size)
            fail("cannot write");
        fclose(file);
        puts(name);
    }
}

// ---- the description ----------------------------------------------------------------------------

static int version;
static char identifier[LONGEST], token[LONGEST];
static struct variable {
    char name[LONGEST], causality[LONGEST], initial[LONGEST];
    unsigned reference, derivative; // of 2.0 the number of the state, else its reference
    bool is_derivative;
} variable[MOST];
static size_t nvariable, state[MOST], nstate,
    nroot; // state: number of the variable, in the order of derivatives
static struct unknown {
    size_t variable;
    bool on[MOST]; // by variable
} * unknown;
static size_t nunknown;

// The value of an attribute of the tag at s, "" if it has none.
static const char *attribute(const char *s, const char *name, char *out)
{
    char key[LONGEST];
    const char *end = strchr(s, '>');
    snprintf(key, sizeof key, " %s=\"", name);
    const char *at = strstr(s, key);
    out[0] = 0;
    if (!at || at > end)
        return out;
    at += strlen(key);
    size_t n = 0;
    static const char *const entity[][2]
        = {{"&amp;", "&"}, {"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&apos;", "'"}};
    while (*at != '"') {
        size_t k = 0;
        while (k < 5 && strncmp(at, entity[k][0], strlen(entity[k][0])) != 0)
            k++;
        if (n + 2 > LONGEST)
            fail("an attribute is too long");
        out[n++] = k < 5 ? *entity[k][1] : *at;
        at += k < 5 ? strlen(entity[k][0]) : 1;
    }
    out[n] = 0;
    return out;
}

static size_t find_reference(unsigned reference)
{
    for (size_t i = 0; i < nvariable; i++)
        if (variable[i].reference == reference)
            return i;
    fail("a reference to no variable");
    return 0;
}

static void read_variables(const char *text)
{
    const char *tag = version == 3 ? "<Float64 " : "<ScalarVariable ";
    char value[LONGEST];
    for (const char *s = text; (s = strstr(s, tag)); s++) {
        struct variable *v = &variable[nvariable++];
        attribute(s, "name", v->name);
        attribute(s, "causality", v->causality);
        attribute(s, "initial", v->initial);
        v->reference = (unsigned)atoi(attribute(s, "valueReference", value));
        const char *own = version == 3 ? s : strstr(s, "<Real");
        v->is_derivative = *attribute(own, "derivative", value);
        v->derivative = (unsigned)atoi(value);
    }
}

// What the structure says of derivatives and outputs.
static void read_unknowns(const char *text, const char *from, const char *to, const char *tag)
{
    const char *s = strstr(text, from), *end = s ? strstr(s, to) : NULL;
    static char list[100000];
    for (; s && (s = strstr(s, tag)) && (!end || s < end); s++) {
        char value[LONGEST];
        struct unknown *u = &unknown[nunknown++];
        memset(u, 0, sizeof *u);
        u->variable = version == 3
                        ? find_reference((unsigned)atoi(attribute(s, "valueReference", value)))
                        : (size_t)atoi(attribute(s, "index", value)) - 1;
        const char *d = strstr(s, "dependencies=\"");
        if (!d || d > strchr(s, '>'))
            fail("an unknown has no dependencies");
        const size_t n = strcspn(d + 14, "\"");
        memcpy(list, d + 14, n);
        list[n] = 0;
        for (char *word = strtok(list, " "); word; word = strtok(NULL, " "))
            u->on[version == 3 ? find_reference((unsigned)atoi(word)) : (size_t)atoi(word) - 1]
                = true;
    }
}

static void read_description(void)
{
    size_t size;
    char value[LONGEST];
    char *text = (char *)find_file("modelDescription.xml", &size);
    if (!text)
        fail("no description");
    const char *head = strstr(text, "<fmiModelDescription");
    version = atoi(attribute(head, "fmiVersion", value));
    attribute(head, version == 3 ? "instantiationToken" : "guid", token);
    attribute(strstr(text, "<ModelExchange"), "modelIdentifier", identifier);
    read_variables(text);
    unknown = calloc(MOST, sizeof *unknown);
    if (version == 3) {
        for (const char *s = text; (s = strstr(s, "<EventIndicator ")); s++)
            nroot++;
        read_unknowns(text, "<ModelStructure>", "<InitialUnknown", "<Output ");
        read_unknowns(text, "<ModelStructure>", "<InitialUnknown",
                      "<ContinuousStateDerivative ");
    } else {
        nroot = (size_t)atoi(attribute(head, "numberOfEventIndicators", value));
        read_unknowns(text, "<Outputs>", "</Outputs>", "<Unknown ");
        read_unknowns(text, "<Derivatives>", "</Derivatives>", "<Unknown ");
    }
    for (size_t i = 0; i < nunknown; i++) {
        const struct variable *v = &variable[unknown[i].variable];
        if (v->is_derivative)
            state[nstate++] = version == 3 ? find_reference(v->derivative) : v->derivative - 1;
    }
    free(text);
}

// ---- the binary ---------------------------------------------------------------------------------

static void *library;

static void load(void)
{
    char name[2 * LONGEST], path[] = "/tmp/fmi-test-XXXXXX";
    size_t size;
    snprintf(name, sizeof name, "binaries/%s/%s.so", version == 3 ? "x86_64-linux" : "linux64",
             identifier);
    unsigned char *b = find_file(name, &size);
    if (!b)
        fail("no binary");
    const int file = mkstemp(path);
    if (file < 0 || write(file, b, size) != (ssize_t)size)
        fail("cannot write the binary");
    close(file);
    library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    unlink(path);
    if (!library)
        fail(dlerror());
    free(b);
}

// The function of that name, fmi2 or fmi3 in front; the caller knows its type.
static void *function(const char *two, const char *three)
{
    char name[LONGEST];
    snprintf(name, sizeof name, "fmi%d%s", version, version == 3 ? three : two);
    void *f = dlsym(library, name);
    if (!f)
        fail(name);
    return f;
}

// NAME(arguments), of any version: a pointer to a function out of one to an object, as POSIX
// allows.
#define CALL(type, two, three, arguments)                                                      \
    ((union {                                                                                  \
         void *object;                                                                         \
         type;                                                                                 \
     }){function(two, three)}                                                                  \
         .f arguments)

static void log_two(void *environment, const char *instance, int status, const char *category,
                    const char *message, ...)
{
    va_list ap;
    (void)environment, (void)instance, (void)category;
    va_start(ap, message);
    printf("status %d: ", status);
    vprintf(message, ap);
    printf("\n");
    va_end(ap);
}

static void log_three(void *environment, int status, const char *category, const char *message)
{
    (void)environment, (void)category;
    printf("status %d: %s\n", status, message);
}

struct callbacks {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*step_finished)(void *, int);
    void *environment;
};
static const struct callbacks callbacks = {log_two, calloc, free, NULL, NULL};

static void *instantiate(const char *given, bool is_cs)
{
    if (version == 2)
        return CALL(void *(*f)(const char *, int, const char *, const char *,
                               const struct callbacks *, int, int),
                    "Instantiate", "", ("test", is_cs, given, "file:///tmp", &callbacks, 0, 0));
    if (is_cs)
        return CALL(void *(*f)(const char *, const char *, const char *, bool, bool, bool, bool,
                               const uint32_t *, size_t, void *,
                               void (*)(void *, int, const char *, const char *), void *),
                    "", "InstantiateCoSimulation",
                    ("test", given, "/tmp", false, false, false, false, NULL, 0, NULL,
                     log_three, NULL));
    return CALL(void *(*f)(const char *, const char *, const char *, bool, bool, void *,
                           void (*)(void *, int, const char *, const char *)),
                "", "InstantiateModelExchange",
                ("test", given, "/tmp", false, false, NULL, log_three));
}

static void done(int status, const char *what)
{
    if (status)
        fail(what);
}

static int get(void *c, const unsigned *r, size_t n, double *v)
{
    if (version == 2)
        return CALL(int (*f)(void *, const unsigned *, size_t, double *), "GetReal", "",
                    (c, r, n, v));
    return CALL(int (*f)(void *, const unsigned *, size_t, double *, size_t), "", "GetFloat64",
                (c, r, n, v, n));
}

static int set(void *c, const unsigned *r, size_t n, const double *v)
{
    if (version == 2)
        return CALL(int (*f)(void *, const unsigned *, size_t, const double *), "SetReal", "",
                    (c, r, n, v));
    return CALL(int (*f)(void *, const unsigned *, size_t, const double *, size_t), "",
                "SetFloat64", (c, r, n, v, n));
}

static double get_one(void *c, size_t i)
{
    double v = NAN;
    done(get(c, &variable[i].reference, 1, &v), "get");
    return v;
}

static void set_named(void *c, char *setting)
{
    char *value = strchr(setting, '=');
    if (!value)
        fail("NAME=VALUE is wanted");
    *value++ = 0;
    for (size_t i = 0; i < nvariable; i++)
        if (!strcmp(variable[i].name, setting)) {
            const double v = strtod(value, NULL);
            done(set(c, &variable[i].reference, 1, &v), "set");
            return;
        }
    fail("no variable of that name");
}

static void initialize(void *c, int nset, char **setting)
{
    if (version == 2)
        done(CALL(int (*f)(void *, int, double, double, int, double), "SetupExperiment", "",
                  (c, 0, 0, 0, 0, 0)),
             "setup");
    for (int i = 0; i < nset; i++)
        set_named(c, setting[i]);
    if (version == 2)
        done(CALL(int (*f)(void *), "EnterInitializationMode", "", (c)), "initialization");
    else
        done(CALL(int (*f)(void *, bool, double, double, bool, double), "",
                  "EnterInitializationMode", (c, false, 0, 0, false, 0)),
             "initialization");
    done(CALL(int (*f)(void *), "ExitInitializationMode", "ExitInitializationMode", (c)),
         "end of initialization");
}

static void print_head(void)
{
    printf("t");
    for (size_t i = 0; i < nunknown; i++)
        if (!strcmp(variable[unknown[i].variable].causality, "output"))
            printf(",%s", variable[unknown[i].variable].name);
    printf("\n");
}

static void print_row(void *c, double t)
{
    printf("%.12g", t);
    for (size_t i = 0; i < nunknown; i++)
        if (!strcmp(variable[unknown[i].variable].causality, "output"))
            printf(",%.15g", get_one(c, unknown[i].variable));
    printf("\n");
}

// ---- model exchange -----------------------------------------------------------------------------

static void set_state(void *c, double t, const double *x)
{
    done(CALL(int (*f)(void *, double), "SetTime", "SetTime", (c, t)), "time");
    done(CALL(int (*f)(void *, const double *, size_t), "SetContinuousStates",
              "SetContinuousStates", (c, x, nstate)),
         "states");
}

static void derive(void *c, double t, const double *x, double *dx)
{
    set_state(c, t, x);
    done(CALL(int (*f)(void *, double *, size_t), "GetDerivatives",
              "GetContinuousStateDerivatives", (c, dx, nstate)),
         "derivatives");
}

static void get_roots(void *c, double *g)
{
    done(CALL(int (*f)(void *, double *, size_t), "GetEventIndicators", "GetEventIndicators",
              (c, g, nroot)),
         "event indicators");
}

static void get_states(void *c, double *x)
{
    done(CALL(int (*f)(void *, double *, size_t), "GetContinuousStates", "GetContinuousStates",
              (c, x, nstate)),
         "states");
}

static void rk4(void *c, double t, double h, const double *x, double *out)
{
    static double dx[4][MOST];
    derive(c, t, x, dx[0]);
    for (int k = 1; k < 4; k++) {
        const double part = k < 3 ? 0.5 : 1;
        for (size_t i = 0; i < nstate; i++)
            out[i] = x[i] + part * h * dx[k - 1][i];
        derive(c, t + part * h, out, dx[k]);
    }
    for (size_t i = 0; i < nstate; i++)
        out[i] = x[i] + h / 6 * (dx[0][i] + 2 * dx[1][i] + 2 * dx[2][i] + dx[3][i]);
}

struct event_info {
    int needed, terminate, nominals, values, has_next;
    double next;
};

// Event mode and back; returns the time of the next event.
static double handle_event(void *c, double *x, bool must_enter)
{
    double next = INFINITY;
    if (must_enter)
        done(CALL(int (*f)(void *), "EnterEventMode", "EnterEventMode", (c)), "event mode");
    for (bool again = true; again;) {
        if (version == 2) {
            struct event_info info = {0};
            done(CALL(int (*f)(void *, struct event_info *), "NewDiscreteStates", "",
                      (c, &info)),
                 "event");
            again = info.needed;
            next = info.has_next ? info.next : INFINITY;
        } else {
            bool terminate, nominals, values, has_next;
            double at;
            done(CALL(int (*f)(void *, bool *, bool *, bool *, bool *, bool *, double *), "",
                      "UpdateDiscreteStates",
                      (c, &again, &terminate, &nominals, &values, &has_next, &at)),
                 "event");
            next = has_next ? at : INFINITY;
        }
    }
    done(CALL(int (*f)(void *), "EnterContinuousTimeMode", "EnterContinuousTimeMode", (c)),
         "continuous time");
    get_states(c, x);
    return next;
}

static bool is_changed(const double *before, const double *now)
{
    for (size_t i = 0; i < nroot; i++)
        if ((before[i] > 0) != (now[i] > 0))
            return true;
    return false;
}

static bool complete_step(void *c)
{
    if (version == 2) {
        int enter = 0, terminate = 0;
        done(CALL(int (*f)(void *, int, int *, int *), "CompletedIntegratorStep", "",
                  (c, 1, &enter, &terminate)),
             "completed step");
        return enter;
    }
    bool enter = false, terminate = false;
    done(CALL(int (*f)(void *, bool, bool *, bool *), "", "CompletedIntegratorStep",
              (c, true, &enter, &terminate)),
         "completed step");
    return enter;
}

// The shortest part of h, to round-off, behind which a root has changed its side.
static double bisect(void *c, double t, double h, const double *x, double *out,
                     const double *before)
{
    static double g[MOST];
    double low = 0, high = h;
    for (int k = 0; k < 60; k++) {
        const double middle = low + (high - low) / 2;
        if (!(t + middle > t + low && t + middle < t + high))
            break;
        rk4(c, t, middle, x, out);
        set_state(c, t + middle, out);
        get_roots(c, g);
        if (is_changed(before, g))
            high = middle;
        else
            low = middle;
    }
    rk4(c, t, high, x, out);
    set_state(c, t + high, out);
    return high;
}

static double exchange(void *c, double t, double end, double step, double *next)
{
    static double x[MOST], y[MOST], before[MOST], now[MOST];
    get_states(c, x);
    set_state(c, t, x);
    get_roots(c, before);
    while (t < end) {
        const double stop = fmin(end, *next), left = stop - t;
        double h = left / ceil(left / step * (1 - 1e-9));
        const bool is_last = !(h < left);
        rk4(c, t, h, x, y);
        set_state(c, t + h, y);
        get_roots(c, now);
        bool is_event = is_changed(before, now);
        if (is_event)
            h = bisect(c, t, h, x, y, before);
        t = is_last && !is_event ? stop : t + h;
        set_state(c, t, y);
        memcpy(x, y, nstate * sizeof *x);
        is_event |= complete_step(c) | (t == *next);
        if (is_event)
            *next = handle_event(c, x, true);
        get_roots(c, before);
    }
    return t;
}

// ---- co-simulation ------------------------------------------------------------------------------

static void do_step(void *c, double t, double h)
{
    bool event, terminate, early;
    double last;
    if (version == 2)
        done(CALL(int (*f)(void *, double, double, int), "DoStep", "", (c, t, h, 1)), "step");
    else
        done(CALL(int (*f)(void *, double, double, bool, bool *, bool *, bool *, double *), "",
                  "DoStep", (c, t, h, true, &event, &terminate, &early, &last)),
             "step");
}

static void run(bool is_cs, double step, double until, int nset, char **setting)
{
    static double x[MOST];
    void *c = instantiate(token, is_cs);
    const int rows = getenv("ROWS") ? atoi(getenv("ROWS")) : 10;
    double next = INFINITY;
    if (!c)
        fail("no instance");
    initialize(c, nset, setting);
    print_head();
    if (!is_cs)
        next = handle_event(c, x, false);
    print_row(c, 0);
    for (int k = 0; k < rows; k++) {
        const double t = until * k / rows, end = until * (k + 1) / rows;
        const long n = lround((end - t) / step);
        if (!is_cs)
            exchange(c, t, end, step, &next);
        for (long i = 0; i < n && is_cs; i++)
            do_step(c, t + (end - t) * (double)i / (double)n, (end - t) / (double)n);
        print_row(c, end);
    }
    CALL(void (*f)(void *), "FreeInstance", "FreeInstance", (c));
}

// ---- checks -------------------------------------------------------------------------------------

static void expect(bool is_so, const char *what)
{
    printf("%s: %s\n", what, is_so ? "yes" : "no");
}

static int save(void *c, void **s)
{
    return CALL(int (*f)(void *, void **), "GetFMUstate", "GetFMUState", (c, s));
}

static int restore(void *c, void *s)
{
    return CALL(int (*f)(void *, void *), "SetFMUstate", "SetFMUState", (c, s));
}

static void advance(void *c, double from, double to)
{
    for (int i = 0; i < 20; i++)
        do_step(c, from + (to - from) * i / 20, (to - from) / 20);
}

static double sum_of_outputs(void *c)
{
    double sum = 0;
    for (size_t i = 0; i < nunknown; i++)
        sum += get_one(c, unknown[i].variable);
    return sum;
}

static void check_states(int nset, char **setting)
{
    void *c = instantiate(token, true), *other = instantiate(token, true), *s = NULL, *t = NULL;
    size_t size = 0;
    initialize(c, nset, setting);
    initialize(other, nset, setting);
    advance(c, 0, 0.02);
    done(save(c, &s), "save");
    advance(c, 0.02, 0.04);
    const double once = sum_of_outputs(c);
    done(restore(c, s), "restore");
    advance(c, 0.02, 0.04);
    expect(sum_of_outputs(c) == once, "the same again from a saved state");
    done(CALL(int (*f)(void *, void *, size_t *), "SerializedFMUstateSize",
              "SerializedFMUStateSize", (c, s, &size)),
         "size");
    unsigned char *bytes = malloc(size);
    done(CALL(int (*f)(void *, void *, unsigned char *, size_t), "SerializeFMUstate",
              "SerializeFMUState", (c, s, bytes, size)),
         "serialize");
    done(CALL(int (*f)(void *, const unsigned char *, size_t, void **), "DeSerializeFMUstate",
              "DeserializeFMUState", (other, bytes, size, &t)),
         "deserialize");
    done(restore(other, t), "restore");
    advance(other, 0.02, 0.04);
    expect(sum_of_outputs(other) == once, "and from bytes in another instance");
    expect(CALL(int (*f)(void *, const unsigned char *, size_t, void **), "DeSerializeFMUstate",
                "DeserializeFMUState", (other, bytes, size - 1, &t))
               != 0,
           "bytes that are no state are refused");
    CALL(int (*f)(void *, void **), "FreeFMUstate", "FreeFMUState", (c, &s));
    CALL(int (*f)(void *, void **), "FreeFMUstate", "FreeFMUState", (other, &t));
    done(CALL(int (*f)(void *), "Reset", "Reset", (c)), "reset");
    initialize(c, 0, NULL);
    advance(c, 0, 0.02);
    advance(c, 0.02, 0.04);
    expect(nset > 0 || sum_of_outputs(c) == once, "and after a reset");
    CALL(void (*f)(void *), "FreeInstance", "FreeInstance", (c));
    CALL(void (*f)(void *), "FreeInstance", "FreeInstance", (other));
    free(bytes);
}

static int directional(void *c, const unsigned *unknown_of, size_t nu, const unsigned *known,
                       size_t nk, const double *seed, double *out)
{
    if (version == 2)
        return CALL(int (*f)(void *, const unsigned *, size_t, const unsigned *, size_t,
                             const double *, double *),
                    "GetDirectionalDerivative", "", (c, unknown_of, nu, known, nk, seed, out));
    return CALL(int (*f)(void *, const unsigned *, size_t, const unsigned *, size_t,
                         const double *, size_t, double *, size_t),
                "", "GetDirectionalDerivative",
                (c, unknown_of, nu, known, nk, seed, nk, out, nu));
}

// Derivatives along each state and input against differences; what is said not to depend on it does
// not.
static void check_derivatives(int nset, char **setting)
{
    static double x[MOST], up[MOST], down[MOST], got[MOST];
    static unsigned of[MOST];
    void *c = instantiate(token, false);
    double worst = 0;
    bool is_true = true;
    initialize(c, nset, setting);
    handle_event(c, x, false);
    get_states(c, x);
    for (size_t k = 0; k < nstate; k++)
        x[k] += 1e-3 * (double)(k % 5); // not where much is zero
    for (size_t i = 0; i < nunknown; i++)
        of[i] = variable[unknown[i].variable].reference;
    for (size_t v = 0; v < nvariable; v++) {
        size_t k = 0;
        const bool is_input = !strcmp(variable[v].causality, "input");
        while (k < nstate && state[k] != v)
            k++;
        if (k == nstate && !is_input)
            continue;
        const double one = 1, at = is_input ? get_one(c, v) : x[k],
                     h = 1e-5 * fmax(1, fabs(at));
        set_state(c, 0, x);
        done(directional(c, of, nunknown, &variable[v].reference, 1, &one, got), "directional");
        for (int side = 0; side < 2; side++) {
            const double there = at + (side ? -h : h);
            double before = at;
            if (is_input)
                done(set(c, &variable[v].reference, 1, &there), "set");
            else
                x[k] = there;
            set_state(c, 0, x);
            done(get(c, of, nunknown, side ? down : up), "get");
            if (is_input)
                done(set(c, &variable[v].reference, 1, &before), "set");
            else
                x[k] = before;
        }
        for (size_t i = 0; i < nunknown; i++) {
            const double d = (up[i] - down[i]) / (2 * h),
                         size = fmax(1, fmax(fabs(d), fabs(up[i])));
            worst = fmax(worst, fabs(d - got[i]) / size);
            is_true
                &= unknown[i].on[v] || (fabs(d) < 1e-9 * size && fabs(got[i]) < 1e-9 * size);
        }
    }
    expect(worst < 1e-5, "directional derivatives are those of differences");
    if (!(worst < 1e-5))
        printf("worst %g\n", worst);
    expect(is_true, "nothing depends on what is not named");
    CALL(void (*f)(void *), "FreeInstance", "FreeInstance", (c));
}

static void check_refusals(void)
{
    void *c = instantiate(token, true);
    const double v = 1;
    const unsigned none = 4000000;
    expect(!instantiate("of another model", true), "another token is refused");
    initialize(c, 0, NULL);
    expect(set(c, &none, 1, &v) != 0, "no such variable");
    for (size_t i = 0; i < nvariable; i++)
        if (!strcmp(variable[i].causality, "calculatedParameter")) {
            expect(set(c, &variable[i].reference, 1, &v) != 0,
                   "a derived parameter is refused");
            break;
        }
    CALL(void (*f)(void *), "FreeInstance", "FreeInstance", (c));
}

int main(int argc, char **argv)
{
    if (argc < 3)
        fail("FILE.fmu and what to do are wanted");
    read_archive(argv[1]);
    if (!strcmp(argv[2], "unpack")) {
        unpack(argv[3]);
        return 0;
    }
    read_description();
    load();
    if (!strcmp(argv[2], "check")) {
        check_refusals();
        check_states(argc - 3, argv + 3);
        check_derivatives(argc - 3, argv + 3);
        return 0;
    }
    run(!strcmp(argv[2], "cs"), atof(argv[3]), atof(argv[4]), argc - 5, argv + 5);
    return 0;
}
