/* What the shared library shows: a function declared with CT_API is public, all else is hidden. */
#ifndef COTREE_EXPORT_H
#define COTREE_EXPORT_H

#if defined(__GNUC__)
#define CT_API __attribute__((visibility("default")))
#else
#define CT_API
#endif

#endif
