// Whatever bytes a name has, the JSON text is one line of valid UTF-8 between two quotes, with no
// control character and no quote of its own left bare.
#include "report/json.h"
#include "tests/fuzz/target.h"

#include <stdlib.h>
#include <string.h>

static void require(bool holds)
{
    if (!holds)
        abort();
}

// Decodes n bytes; aborts if they are not well-formed UTF-8.
static void require_utf8(const unsigned char *s, size_t n)
{
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    for (size_t i = 0; i < n;) {
        const unsigned char c = s[i];
        const size_t length = c < 0x80 ? 1 : c >> 5 == 6 ? 2 : c >> 4 == 14 ? 3 : 4;
        require(length < 4 || c >> 3 == 30);
        require(i + length <= n);
        uint32_t point = length == 1 ? c : c & (0xffu >> (length + 1));
        for (size_t k = 1; k < length; k++) {
            require(s[i + k] >> 6 == 2);
            point = point << 6 | (s[i + k] & 0x3fu);
        }
        require(point >= least[length] && point <= 0x10ffff);
        require(point < 0xd800 || point > 0xdfff);
        i += length;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *name = calloc(1, size + 1);
    require(name != NULL);
    if (size)
        memcpy(name, data, size);
    char *text = NULL;
    size_t n = 0;
    FILE *out = open_memstream(&text, &n);
    require(out != NULL);
    struct ct_json j;
    ct_json_init(&j, out);
    ct_json_text(&j, NULL, name);
    fclose(out);

    require(n >= 2 && text[0] == '"' && text[n - 1] == '"');
    require_utf8((const unsigned char *)text, n);
    for (size_t i = 1; i < n - 1; i++) {
        require((unsigned char)text[i] >= 0x20 && text[i] != '"');
        if (text[i] == '\\')
            require(++i < n - 1); // what is escaped is inside the quotes
    }
    free(text);
    free(name);
    return 0;
}
