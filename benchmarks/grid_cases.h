// What the grid benchmarks run on, and where they find it: OpenFOAM's motorBike (Debian's openfoam-examples, or
// $I2B_GEOMETRY_DIR) in its tutorial's domain, and the built-in engine, which is always there.
#pragma once
#include "i2b/geometry/read.h"
#include "i2b/samples/sample.h"
#include "i2b/sizing/size_field.h"
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

namespace i2b::benchmarks {

// "" where there is none.
inline std::string motorBikeFile() {
    const char* folder = std::getenv("I2B_GEOMETRY_DIR");
    for (const char* name : {"motorBike.obj.gz", "motorBike.obj"}) {
        for (const std::string& place : {std::string(folder ? folder : ""), std::string("/usr/share/doc/openfoam-examples/examples/resources/geometry")}) {
            const std::filesystem::path file = std::filesystem::path(place) / name;
            if (!place.empty() && std::filesystem::exists(file)) return file.string();
        }
    }
    return "";
}

// Read once a run. No triangles: the file is not there.
inline const Surface& surfaceOf(const std::string& name) {
    static std::map<std::string, Surface> known;
    const auto [at, fresh] = known.try_emplace(name);
    if (!fresh) return at->second;
    if (name != "motorBike") return at->second = makeSample(name);
    GeometryNotes notes;
    const std::string file = motorBikeFile();
    if (!file.empty()) at->second = readSurface({file}, 1, notes);
    return at->second;
}

// Base cells of 1.024 m around the motorbike (20 x 8 x 8 of them, about the tutorial's domain) and of 64 mm around
// the engine; cells of millimetres on the surface, so that the levels come out whole at 4, 2 and 1 mm.
inline SizeField fieldOf(const std::string& name, double millimetres, int bufferCells) {
    SizeOptions size;
    DomainOptions domain;
    const bool bike = name == "motorBike";
    size.max = bike ? 1.024 : 0.064;
    size.surface = millimetres * 1e-3;
    size.bufferCells = bufferCells;
    const Vec3 low = bike ? Vec3{-5, -4.096, 0} : Vec3{-0.64, -0.64, -0.32};
    domain.box = Box{low, low + (bike ? Vec3{20, 8, 8} : Vec3{20, 20, 20}) * size.max};
    return makeSizeField(surfaceOf(name), size, domain);
}

} // namespace i2b::benchmarks
