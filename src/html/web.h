// The bundled script and style of the page, made from web/ when cotree is built; sizes are 0 where it is built without.
#ifndef CT_HTML_WEB_H
#define CT_HTML_WEB_H

#include <stddef.h>

extern const unsigned char ct_web_script[], ct_web_style[];
extern const size_t ct_web_script_size, ct_web_style_size;

#endif
