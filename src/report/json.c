// See json.h.
#include "report/json.h"

#include "report/number.h"

#include <assert.h>
#include <math.h>

void ct_json_init(struct ct_json *j, FILE *out)
{
    *j = (struct ct_json){.out = out};
}

static void new_line(struct ct_json *j)
{
    fputc('\n', j->out);
    for (int i = 0; i < j->depth; i++)
        fputs("  ", j->out);
}

// Bytes of the well-formed UTF-8 sequence at s (RFC 3629: no surrogates, shortest form), or 0.
static int utf8_length(const unsigned char *s)
{
    if (s[0] < 0x80)
        return 1;
    const int n = s[0] >= 0xc2 && s[0] < 0xe0 ? 2
                : s[0] >= 0xe0 && s[0] < 0xf0 ? 3
                : s[0] >= 0xf0 && s[0] < 0xf5 ? 4
                                              : 0;
    for (int i = 1; i < n; i++)
        if ((s[i] & 0xc0) != 0x80) // also stops at the terminating zero
            return 0;
    if ((s[0] == 0xe0 && s[1] < 0xa0) || (s[0] == 0xed && s[1] >= 0xa0)
        || (s[0] == 0xf0 && s[1] < 0x90) || (s[0] == 0xf4 && s[1] >= 0x90))
        return 0;
    return n;
}

static void quote(FILE *out, const char *text)
{
    fputc('"', out);
    for (const unsigned char *s = (const unsigned char *)text; *s;) {
        const int n = utf8_length(s);
        if (n == 0)
            fputs("\xef\xbf\xbd", out);
        else if (*s == '"' || *s == '\\')
            fprintf(out, "\\%c", *s);
        else if (*s == '\n')
            fputs("\\n", out);
        else if (*s == '\t')
            fputs("\\t", out);
        else if (*s < 0x20 || *s == 0x7f)
            fprintf(out, "\\u%04x", *s);
        else
            fwrite(s, 1, (size_t)n, out);
        s += n ? n : 1;
    }
    fputc('"', out);
}

// The separator before a value: comma, line break and key.
static void start_value(struct ct_json *j, const char *key)
{
    if (j->depth == 0) {
        assert(!key);
        return;
    }
    const uint32_t bit = UINT32_C(1) << (j->depth - 1);
    assert(!(j->is_object & bit) == !key);
    if (j->has_member & bit)
        fputc(',', j->out);
    j->has_member |= bit;
    new_line(j);
    if (key) {
        quote(j->out, key);
        fputs(": ", j->out);
    }
}

static void open_container(struct ct_json *j, const char *key, bool is_object)
{
    start_value(j, key);
    assert(j->depth < CT_JSON_DEPTH);
    const uint32_t bit = UINT32_C(1) << j->depth++;
    j->has_member &= ~bit;
    j->is_object = is_object ? j->is_object | bit : j->is_object & ~bit;
    fputc(is_object ? '{' : '[', j->out);
}

void ct_json_object(struct ct_json *j, const char *key)
{
    open_container(j, key, true);
}

void ct_json_array(struct ct_json *j, const char *key)
{
    open_container(j, key, false);
}

void ct_json_end(struct ct_json *j)
{
    assert(j->depth > 0);
    const uint32_t bit = UINT32_C(1) << --j->depth;
    if (j->has_member & bit)
        new_line(j);
    fputc(j->is_object & bit ? '}' : ']', j->out);
    if (j->depth == 0)
        fputc('\n', j->out);
}

static void print_number(FILE *out, double v)
{
    char text[CT_NUMBER_SIZE];
    fputs(isfinite(v) ? ct_number_format(text, v) : "null", out);
}

void ct_json_number(struct ct_json *j, const char *key, double v)
{
    start_value(j, key);
    print_number(j->out, v);
}

void ct_json_integer(struct ct_json *j, const char *key, long long v)
{
    start_value(j, key);
    fprintf(j->out, "%lld", v);
}

void ct_json_bool(struct ct_json *j, const char *key, bool v)
{
    start_value(j, key);
    fputs(v ? "true" : "false", j->out);
}

void ct_json_text(struct ct_json *j, const char *key, const char *text)
{
    start_value(j, key);
    if (text)
        quote(j->out, text);
    else
        fputs("null", j->out);
}

void ct_json_numbers(struct ct_json *j, const char *key, const double *v, size_t n)
{
    start_value(j, key);
    fputc('[', j->out);
    for (size_t i = 0; i < n; i++) {
        if (i)
            fputs(", ", j->out);
        print_number(j->out, v[i]);
    }
    fputc(']', j->out);
}

void ct_json_texts(struct ct_json *j, const char *key, const char *const *text, size_t n)
{
    start_value(j, key);
    fputc('[', j->out);
    for (size_t i = 0; i < n; i++) {
        if (i)
            fputs(", ", j->out);
        quote(j->out, text[i]);
    }
    fputc(']', j->out);
}
