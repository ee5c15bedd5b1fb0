// The bundled script and style of the pages, made from web/ during the build. Their sizes are 0
// if cotree is built without pages.
#ifndef CT_HTML_WEB_H
#define CT_HTML_WEB_H

#include <stddef.h>

extern const unsigned char ct_web_script[], ct_web_style[];
extern const size_t ct_web_script_size, ct_web_style_size;

#endif
