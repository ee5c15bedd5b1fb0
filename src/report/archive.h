// Named arrays in one file, for other programs: FILE.npz for NumPy, FILE.mat for MATLAB, Octave and SciPy.
//
//     numpy.load("file.npz")["A"]        load("file.mat"); A
//
// .npz is a ZIP archive with one compressed .npy file for each array; .mat is of version 4. Matrices are column-major
// in memory and in both files. What always holds: the same arrays give the same bytes.
#ifndef CT_REPORT_ARCHIVE_H
#define CT_REPORT_ARCHIVE_H

#include "report/outfile.h"
#include "report/suffix.h"

#include <stdint.h>

struct ct_archive {
    struct ct_arena *arena;
    struct ct_outfile *file;                // the caller's, open
    const struct ct_archive_format *format; // npz.c, mat.c
    struct ct_archive_entry {
        const char *name;                   // in the file
        uint32_t crc, size, packed, offset; // of .npz
    } * entry;
    size_t nentry, cap;
    uint64_t offset;  // of what comes next
    bool is_too_long; // for the format
};

/// An array of n rows and m columns, as a matrix or, of .npz, as a vector.
struct ct_archive_shape {
    size_t n, m;
    bool is_vector;
};

struct ct_archive_format {
    void (*numbers)(struct ct_archive *z, const char *name, struct ct_archive_shape shape,
                    const double *v);
    void (*names)(struct ct_archive *z, const char *name, const char *const *text, size_t n);
    void (*finish)(struct ct_archive *z);
};
extern const struct ct_archive_format ct_archive_npz, ct_archive_mat;

/// suffix: CT_SUFFIX_NPZ or CT_SUFFIX_MAT; onto a file that is open.
void ct_archive_init(struct ct_archive *z, struct ct_arena *a, enum ct_suffix suffix,
                     struct ct_outfile *file);
/// A (n x m, column-major) under a name.
void ct_archive_matrix(struct ct_archive *z, const char *name, const double *A, size_t n,
                       size_t m);
/// A column of n numbers.
void ct_archive_vector(struct ct_archive *z, const char *name, const double *v, size_t n);
/// Texts in UTF-8: of .npz an array of strings, of .mat a matrix of characters with a row for each.
void ct_archive_names(struct ct_archive *z, const char *name, const char *const *text,
                      size_t n);
/// Nothing more is to come; the file stays open. Errors: E002 for what the format has no room for.
bool ct_archive_finish(struct ct_ctx *ctx, struct ct_archive *z);

struct ct_archive_bytes;
/// A ZIP archive without a format: z has an arena and an open file, all else zero. Files come in the order they are added.
void ct_archive_add_file(struct ct_archive *z, const char *name,
                         const struct ct_archive_bytes *content);
/// The directory; too much for the format: z->is_too_long.
void ct_archive_finish_files(struct ct_archive *z);

// ---- for the formats -------------------------------------------------------------------------

struct ct_archive_bytes {
    struct ct_arena *arena;
    unsigned char *b;
    size_t n, cap;
};

/// The lowest `size` bytes of v, the lowest first.
void ct_archive_put(struct ct_archive_bytes *out, uint64_t v, int size);
void ct_archive_put_text(struct ct_archive_bytes *out, const char *text);
/// n doubles.
void ct_archive_put_numbers(struct ct_archive_bytes *out, const double *v, size_t n);
/// The next code point of UTF-8; what is not well-formed becomes U+FFFD.
uint32_t ct_archive_next_point(const char **text);
/// Of n texts the largest number of code points, 1 at least.
size_t ct_archive_longest(const char *const *text, size_t n);
/// Onto the file.
void ct_archive_write(struct ct_archive *z, const struct ct_archive_bytes *bytes);

#endif
