// In place of what web/build.js writes, where cotree is built without the report.
#include "html/web.h"

const unsigned char ct_web_script[] = {0};
const size_t ct_web_script_size = 0;
const unsigned char ct_web_style[] = {0};
const size_t ct_web_style_size = 0;
