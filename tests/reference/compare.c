/* compare RESULT.csv REFERENCE.csv TOLERANCE-FILE
 *
 * Every column and every time of the reference must be in the result (columns by name, times
 * within 1e-9 s); further ones in the result are free. The error is |result - reference| over
 * max(|reference|, size); size, the typical size of the quantity, is its largest |reference|
 * over the listed times, and 1 if that is 0.
 *
 * The tolerance file holds the tolerance on its first line; lines `COLUMN TOLERANCE [SIZE]` may
 * follow for columns that need another one. Prints the worst error of each column. Exit status:
 * 0 all within, 1 not, 2 cannot tell.
 */
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct table {
    size_t columns, rows;
    char *text;    /* of the file, which the names stand in */
    char **name;   /* columns */
    double *value; /* rows x columns */
};

static _Noreturn void fail(const char *format, ...)
{
    va_list args;

    va_start(args, format);
    fputs("compare: ", stderr);
    // NOLINTNEXTLINE(clang-diagnostic-format-nonliteral): the callers' are literals
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
    exit(2);
}

static void *must(void *p)
{
    if (!p)
        fail("out of memory");
    return p;
}

/* the whole file, with a 0 at its end */
static char *slurp(const char *path)
{
    FILE *f = fopen(path, "rb");
    size_t size = 0, room = 1 << 16, got;
    char *text;

    if (!f)
        fail("%s: %s", path, strerror(errno));
    text = must(malloc(room));
    while ((got = fread(text + size, 1, room - size - 1, f)) > 0) {
        size += got;
        if (size + 1 == room)
            text = must(realloc(text, room *= 2));
    }
    if (ferror(f)) {
        free(text);
        fail("%s: cannot be read", path);
    }
    fclose(f);
    text[size] = 0;
    return text;
}

/* Cuts the next field off *at, unquoted in place; sets *last at the end of a line. */
static char *field(char **at, bool *last)
{
    char *from = *at, *in = from, *out = from;
    bool quoted = false;

    for (; *in && (quoted || (*in != ',' && *in != '\n' && *in != '\r')); in++) {
        if (*in != '"')
            *out++ = *in;
        else if (quoted && in[1] == '"')
            *out++ = *in++;
        else
            quoted = !quoted;
    }
    *last = *in != ',';
    if (*in == '\r')
        in++;
    *at = *in ? in + 1 : in;
    *out = 0;
    return from;
}

static void read_table(const char *path, struct table *t)
{
    char *at = t->text = slurp(path);
    size_t room = 0;
    bool last;

    do {
        t->name = must(realloc(t->name, (t->columns + 1) * sizeof *t->name));
        t->name[t->columns++] = field(&at, &last);
    } while (!last);
    if (strcmp(t->name[0], "t") != 0)
        fail("%s: the first column is '%s', not t", path, t->name[0]);
    for (; *at; t->rows++) {
        size_t c = 0;

        if ((t->rows + 1) * t->columns > room) {
            room = 2 * (t->rows + 1) * t->columns;
            t->value = must(realloc(t->value, room * sizeof *t->value));
        }
        do {
            char *cell = field(&at, &last), *end;

            if (c == t->columns)
                fail("%s: row %zu has more than %zu columns", path, t->rows + 1, t->columns);
            t->value[t->rows * t->columns + c++] = strtod(cell, &end);
            if (end == cell || *end)
                fail("%s: row %zu: '%s' is no number", path, t->rows + 1, cell);
        } while (!last);
        if (c != t->columns)
            fail("%s: row %zu has %zu columns, the header %zu", path, t->rows + 1, c,
                 t->columns);
    }
}

static void free_table(struct table *t)
{
    free(t->text);
    free(t->name);
    free(t->value);
}

static bool find_column(const struct table *t, const char *name, size_t *column)
{
    for (*column = 0; *column < t->columns; (*column)++)
        if (strcmp(t->name[*column], name) == 0)
            return true;
    return false;
}

static bool find_row(const struct table *t, double time, size_t *row)
{
    for (*row = 0; *row < t->rows; (*row)++)
        if (fabs(t->value[*row * t->columns] - time) <= 1e-9)
            return true;
    return false;
}

/* the tolerance of a column, and its typical size unless the file, of this text, does not name one */
static double tolerance_of(const char *path, const char *text, const char *column, double *size)
{
    const char *line = text;
    char *end;
    double tolerance = strtod(line, &end);
    size_t length = strlen(column);

    if (end == line || !(tolerance > 0))
        fail("%s: the first line is no tolerance", path);
    while ((line = strchr(line, '\n')) != NULL) {
        line++;
        if (strncmp(line, column, length) != 0 || line[length] != ' ')
            continue;
        line += length;
        tolerance = strtod(line, &end);
        if (end == line || !(tolerance > 0))
            fail("%s: '%s' has no tolerance", path, column);
        if (*end == ' ')
            *size = strtod(end, NULL);
        break;
    }
    return tolerance;
}

/* true if the column is within its tolerance at all times */
static bool compare_column(const struct table *result, const struct table *reference,
                           size_t column, const char *tolerance_file, const char *tolerances)
{
    const char *name = reference->name[column];
    double size = 0, worst = 0, worst_time = 0, tolerance;
    bool ok = true;
    size_t at, row, r;

    if (!find_column(result, name, &at)) {
        printf("%-24s missing\n", name);
        return false;
    }
    for (r = 0; r < reference->rows; r++)
        size = fmax(size, fabs(reference->value[r * reference->columns + column]));
    if (size == 0)
        size = 1;
    tolerance = tolerance_of(tolerance_file, tolerances, name, &size);
    for (r = 0; r < reference->rows; r++) {
        double time = reference->value[r * reference->columns];
        double want = reference->value[r * reference->columns + column], got, error;

        if (!find_row(result, time, &row)) {
            printf("%-24s no row at t = %.17g\n", name, time);
            ok = false;
            continue;
        }
        got = result->value[row * result->columns + at];
        error = fabs(got - want) / fmax(fabs(want), size);
        if (!(error <= tolerance)) { /* also when it is no number */
            printf("%-24s t = %-10g got %.17g, wanted %.17g\n", name, time, got, want);
            ok = false;
        }
        if (!(error <= worst)) {
            worst = error;
            worst_time = time;
        }
    }
    printf("%-24s worst error %.2e at t = %-8g allowed %.0e%s\n", name, worst, worst_time,
           tolerance, ok ? "" : "  FAILED");
    return ok;
}

int main(int argc, char **argv)
{
    /* static: what fail leaves behind can still be reached, so that it is no leak */
    static struct table result, reference;
    static char *tolerances;
    bool ok = true;
    size_t c;

    if (argc != 4)
        fail("usage: compare RESULT.csv REFERENCE.csv TOLERANCE-FILE");
    read_table(argv[1], &result);
    read_table(argv[2], &reference);
    if (reference.rows == 0 || reference.columns < 2)
        fail("%s: nothing to compare with", argv[2]);
    tolerances = slurp(argv[3]);
    for (c = 1; c < reference.columns; c++)
        if (!compare_column(&result, &reference, c, argv[3], tolerances))
            ok = false;
    free_table(&result);
    free_table(&reference);
    free(tolerances);
    return ok ? 0 : 1;
}
