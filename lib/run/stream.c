// SPDX-License-Identifier: MIT
// How often the loaded cells use each page of a mapped file. The system is told of the pages that come into
// use, and of those that fall out of it; of neighbouring ones at once. A cell's triangles never change, so
// dropping it counts down what loading it has counted up, however often it uses a page.
#include "enfilade/prefetch.h"
#include "run/open.h"
#include "run/take.h"

#include <sys/mman.h>
#include <unistd.h>

struct enf_stream {
    const enf_file_view *view;
    size_t page;        ///< bytes; 0: no cell has anything to load
    bool *loaded;       ///< per cell
    size_t page_count;  ///< of the file
    uint32_t *uses;     ///< per page; one more of pages that hold anything else
    size_t first, next; ///< pages that the system has not been told of yet
    bool is_load;       ///< or else a drop
};

#ifndef MADV_DONTNEED // nothing can be told
enum { MADV_WILLNEED, MADV_DONTNEED };
static int madvise(void *start, size_t size, int what) {
    (void)start, (void)size, (void)what;
    return 0;
}
#endif

/// Tells the system of pages.
static void advise(const enf_stream *stream, size_t first, size_t next, int what) {
    uintptr_t start = (uintptr_t)stream->view->bytes + first * stream->page;
    if (next > first) madvise((void *)start, (next - first) * stream->page, what); // NOLINT: an address
}

/// When a page is read Linux may map all that it has read at once, of which there are AROUND bytes at most.
/// Pages around that nobody uses go with the page.
static void tell(enf_stream *stream) {
    enum { AROUND = 1 << 21 };
    size_t first = stream->first, next = stream->next;
    for (size_t n = 0; n < AROUND && !stream->is_load && next > first; n += stream->page) {
        if (first > 0 && stream->uses[first - 1] == 0) first--;
        if (next < stream->page_count && stream->uses[next] == 0) next++;
    }
    advise(stream, first, next, stream->is_load ? MADV_WILLNEED : MADV_DONTNEED);
    stream->first = stream->next = 0;
}

/// The pages of an element or of several.
static void use(enf_stream *stream, const void *start, size_t size) {
    if (size == 0) return;
    size_t offset = (size_t)((const uint8_t *)start - stream->view->bytes);
    for (size_t page = offset / stream->page; page <= (offset + size - 1) / stream->page; page++) {
        stream->uses[page] += stream->is_load ? 1 : UINT32_MAX; // that is -1
        if (stream->uses[page] != stream->is_load) continue;
        if (page != stream->next) {
            tell(stream);
            stream->first = page;
        }
        stream->next = page + 1;
    }
}

/// What a triangle refers to in one array.
static void use_corners(enf_stream *stream, const enf_file_triangle *triangle, int array) {
    const enf_file_view *view = stream->view;
    for (int k = 0; k < 3; k++) {
        int32_t point = triangle->point[k], normal = triangle->normal[k], texcoord = triangle->texcoord[k];
        if (array == 0) use(stream, view->render_points[point], sizeof *view->render_points);
        if (array == 1 && normal >= 0)
            use(stream, view->render_normals[normal], sizeof *view->render_normals);
        if (array == 2 && texcoord >= 0)
            use(stream, view->render_texcoords[texcoord], sizeof *view->render_texcoords);
    }
}

/// Lists are read to find triangles, and triangles to find corners: they come first, and go last.
static void use_cell(enf_stream *stream, const enf_file_cell *cell) {
    enum { LIST, TRIANGLES, CORNERS, STEPS = CORNERS + 3 };
    const enf_file_view *view = stream->view;
    const int32_t *list = view->cell_triangles + cell->triangle_first;
    for (int n = 0; n < STEPS; n++) {
        int step = stream->is_load ? n : STEPS - 1 - n;
        if (step == LIST) use(stream, list, (size_t)cell->triangle_count * sizeof *list);
        for (int32_t i = 0; step != LIST && i < cell->triangle_count; i++) {
            const enf_file_triangle *triangle = &view->triangles[list[i]];
            if (step == TRIANGLES)
                use(stream, triangle, sizeof *triangle);
            else
                use_corners(stream, triangle, step - CORNERS);
        }
        tell(stream);
    }
}

static bool change(enf_stream *stream, int32_t cell, bool is_load) {
    if (cell < 0 || cell >= stream->view->cell_count || stream->loaded[cell] == is_load) return false;
    stream->loaded[cell] = stream->is_load = is_load;
    if (stream->page) use_cell(stream, &stream->view->cells[cell]);
    return true;
}

bool enf_stream_load(enf_stream *stream, int32_t cell) {
    return change(stream, cell, true);
}

bool enf_stream_drop(enf_stream *stream, int32_t cell) {
    return change(stream, cell, false);
}

/// Drops an array, but for pages that it shares with others. A large page, which Linux uses for parts of a
/// file that it has read at once, would be back as a whole when any of it is read.
static void drop_array(enf_stream *stream, const void *start, int64_t count, size_t size) {
    size_t offset = (size_t)((const uint8_t *)start - stream->view->bytes), page = stream->page;
    size_t first = (offset + page - 1) / page, next = (offset + (size_t)count * size) / page;
#ifdef MADV_NOHUGEPAGE
    advise(stream, offset / page, next + 1, MADV_NOHUGEPAGE);
#endif
    advise(stream, first, next, MADV_DONTNEED);
    for (; first < next; first++) stream->uses[first] = 0;
}

static void drop_all(enf_stream *stream) {
    const enf_file_view *view = stream->view;
    for (size_t i = 0; i < stream->page_count; i++) stream->uses[i] = 1;
    drop_array(stream, view->render_points, view->render_point_count, sizeof *view->render_points);
    drop_array(stream, view->render_normals, view->render_normal_count, sizeof *view->render_normals);
    drop_array(stream, view->render_texcoords, view->render_texcoord_count, sizeof *view->render_texcoords);
    drop_array(stream, view->triangles, view->triangle_count, sizeof *view->triangles);
    drop_array(stream, view->cell_triangles, view->cell_triangle_count, sizeof *view->cell_triangles);
}

enf_status enf_stream_create(enf_stream **out, const enf_world *world, enf_error *error) {
    *out = NULL;
    enf_status status = enf_world_need(world, ENF_LOAD_CELLS | ENF_LOAD_DRAW, error);
    if (status) return status;
    enf_stream *stream = calloc(1, sizeof *stream);
    if (!stream) return enf_fail_memory(error, "a stream");
    long page = sysconf(_SC_PAGESIZE);
    stream->view = enf_world_file(world);
    if (enf_world_is_mapped(world) && stream->view->has_geometry && page > 0) {
        stream->page = (size_t)page;
        stream->page_count = (stream->view->size - 1) / stream->page + 1;
    }
    stream->loaded = enf_take((size_t)stream->view->cell_count, sizeof *stream->loaded);
    stream->uses = enf_take(stream->page_count, sizeof *stream->uses);
    if (!stream->loaded || !stream->uses) {
        enf_stream_free(stream);
        return enf_fail_memory(error, "a stream");
    }
    if (stream->page) drop_all(stream);
    *out = stream;
    return ENF_OK;
}

void enf_stream_free(enf_stream *stream) {
    if (!stream) return;
    free(stream->loaded);
    free(stream->uses);
    free(stream);
}
