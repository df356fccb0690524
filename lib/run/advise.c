// SPDX-License-Identifier: MIT
// What the system is told about the pages of a mapped file. Elements of a cell lie close to each other, so
// ranges that touch the same or neighbouring pages are joined to one call.
#include "enfilade/prefetch.h"
#include "run/open.h"

#include <sys/mman.h>
#include <unistd.h>

#ifdef MADV_WILLNEED

typedef struct advice {
    uintptr_t page;       ///< size
    uintptr_t first, end; ///< pages not told yet, as addresses
    int what;
} advice;

static void tell(advice *advice) {
    if (advice->end > advice->first)
        madvise((void *)advice->first, advice->end - advice->first, advice->what); // NOLINT: an address
    advice->first = advice->end = 0;
}

static void add_range(advice *advice, const void *start, size_t size) {
    uintptr_t first = (uintptr_t)start / advice->page * advice->page;
    uintptr_t end = ((uintptr_t)start + size + advice->page - 1) / advice->page * advice->page;
    if (size == 0) return;
    if (first > advice->end || end < advice->first) tell(advice);
    if (advice->end == 0 || first < advice->first) advice->first = first;
    if (end > advice->end) advice->end = end;
}

/// What the triangles of a cell refer to, one array at a time.
static void add_corners(advice *advice, const enf_file_view *view, const enf_file_cell *cell, int array) {
    for (int32_t i = 0; i < cell->triangle_count; i++) {
        const enf_file_triangle *triangle = &view->triangles[view->cell_triangles[cell->triangle_first + i]];
        for (int k = 0; k < 3; k++) {
            int32_t point = triangle->point[k], normal = triangle->normal[k],
                    texcoord = triangle->texcoord[k];
            if (array == 0) add_range(advice, view->render_points[point], sizeof view->render_points[0]);
            if (array == 1 && normal >= 0)
                add_range(advice, view->render_normals[normal], sizeof view->render_normals[0]);
            if (array == 2 && texcoord >= 0)
                add_range(advice, view->render_texcoords[texcoord], sizeof view->render_texcoords[0]);
        }
    }
    tell(advice);
}

static void add_triangles(advice *advice, const enf_file_view *view, const enf_file_cell *cell) {
    for (int32_t i = 0; i < cell->triangle_count; i++)
        add_range(advice, &view->triangles[view->cell_triangles[cell->triangle_first + i]],
                  sizeof view->triangles[0]);
    tell(advice);
}

void enf_world_advise_cell(const enf_world *world, int32_t cell, bool needed) {
    const enf_file_view *view = enf_world_file(world);
    long page = sysconf(_SC_PAGESIZE);
    if (!enf_world_is_mapped(world) || !view->has_geometry || page <= 0) return;
    if (cell < 0 || cell >= view->cell_count) return;
    const enf_file_cell *about = &view->cells[cell];
    const int32_t *list = view->cell_triangles + about->triangle_first;
    advice advice = {.page = (uintptr_t)page, .what = needed ? MADV_WILLNEED : MADV_DONTNEED};
    // Lists are read to find triangles, and triangles to find corners: they come first, and go last.
    if (needed) {
        add_range(&advice, list, (size_t)about->triangle_count * sizeof *list);
        tell(&advice);
        add_triangles(&advice, view, about);
    }
    for (int array = 0; array < 3; array++) add_corners(&advice, view, about, array);
    if (!needed) {
        add_triangles(&advice, view, about);
        add_range(&advice, list, (size_t)about->triangle_count * sizeof *list);
        tell(&advice);
    }
}

#else

void enf_world_advise_cell(const enf_world *world, int32_t cell, bool needed) {
    (void)world;
    (void)cell;
    (void)needed;
}

#endif
