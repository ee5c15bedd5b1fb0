// Named arrays in one file, for other programs: FILE.npz for NumPy, FILE.mat for MATLAB, Octave
// and SciPy.
//
//     numpy.load("file.npz")["A"]        load("file.mat"); A
//
// .npz is a ZIP archive with one compressed .npy file for each array; .mat is of version 4.
// Matrices are column-major in memory and in both files. What always holds: the same arrays
// give the same bytes.
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
    uint64_t offset;  // of the next entry
    bool is_too_long; // the contents exceed the format
};

/// Shape of an array: n rows and m columns; in .npz it may also be a vector.
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

/// Begins an archive in an open file. suffix: CT_SUFFIX_NPZ or CT_SUFFIX_MAT.
void ct_archive_init(struct ct_archive *z, struct ct_arena *a, enum ct_suffix suffix,
                     struct ct_outfile *file);
/// Writes A (n x m, column-major) under a name.
void ct_archive_matrix(struct ct_archive *z, const char *name, const double *A, size_t n,
                       size_t m);
/// Writes a column of n numbers.
void ct_archive_vector(struct ct_archive *z, const char *name, const double *v, size_t n);
/// Writes n texts in UTF-8: an array of strings in .npz, a matrix of characters with one row
/// each in .mat.
void ct_archive_names(struct ct_archive *z, const char *name, const char *const *text,
                      size_t n);
/// Completes the archive; the file stays open. Errors: E002 if the contents exceed the format.
bool ct_archive_finish(struct ct_ctx *ctx, struct ct_archive *z);

struct ct_archive_bytes;
/// Adds a file to a plain ZIP archive: z has an arena and an open file, all else zero. Files
/// keep their order.
void ct_archive_add_file(struct ct_archive *z, const char *name,
                         const struct ct_archive_bytes *content);
/// Writes the directory. Sets z->is_too_long if the contents exceed the format.
void ct_archive_finish_files(struct ct_archive *z);

// ---- for the formats -----------------------------------------------------------------------

struct ct_archive_bytes {
    struct ct_arena *arena;
    unsigned char *b;
    size_t n, cap;
};

/// Appends the lowest `size` bytes of v, lowest first.
void ct_archive_put(struct ct_archive_bytes *out, uint64_t v, int size);
void ct_archive_put_text(struct ct_archive_bytes *out, const char *text);
/// Appends n doubles.
void ct_archive_put_numbers(struct ct_archive_bytes *out, const double *v, size_t n);
/// Returns the next code point of UTF-8; U+FFFD for invalid bytes.
uint32_t ct_archive_next_point(const char **text);
/// Largest number of code points of n texts; at least 1.
size_t ct_archive_longest(const char *const *text, size_t n);
/// Writes the bytes to the file.
void ct_archive_write(struct ct_archive *z, const struct ct_archive_bytes *bytes);

#endif
