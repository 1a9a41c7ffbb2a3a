// Reading of geometry files into one Surface: STL (ASCII and binary), Wavefront OBJ, PLY and Nastran bulk data, plain
// or gzipped, told apart by their content. Files are memory-mapped and read on all cores; the result is the same on any
// number of threads.
#pragma once
#include "i2b/geometry/surface.h"
#include <cstdint>
#include <string>
#include <vector>

namespace i2b {

// What was found amiss and what was done about it. Nothing here keeps a mesh from being made.
struct GeometryNotes {
    std::uint64_t notNumbers = 0; // triangles left out: a coordinate is NaN, infinite or over 1e30 m
    std::uint64_t coincident = 0; // triangles left out: all three corners at one place
    std::uint64_t zeroArea =
        0; // triangles kept: no area, but extent (2 area <= 1e-12 of the longest edge squared)
    std::uint64_t emptyParts = 0;      // STL solids left out: no triangles
    std::uint64_t renamedParts = 0;    // the name is not the file's own
    std::vector<std::string> messages; // one sentence each, in the order of the files
};

// files: at least one. scale: file unit to metres, finite and positive. STL solids, OBJ groups and objects and
// Nastran properties are parts; a nameless one takes its file's name. Equal STL points of one part become one; OBJ points stay
// as indexed, less the unused. OBJ `l` gives segments, `p` free points, polygons a fan of triangles. Nastran's
// quadrangles are cut along the shorter diagonal; its other elements are left out, with a note. Throws
// Error (input) with one sentence: missing, unreadable, empty, a folder, no geometry, truncated, without
// triangles; of several bad files the first is named.
Surface readSurface(const std::vector<std::string>& files, double scale, GeometryNotes& notes);

} // namespace i2b
