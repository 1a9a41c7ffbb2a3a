// What the entries of the list options are called and how they are read, once: case files, the command line and
// --write-case all go over these lists. On the command line the values follow each other in this order.
#pragma once
#include "i2b/options.h"
#include <optional>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

namespace i2b {

template <class T, class V>
struct Entry {
    std::string_view name;
    V T::*member;
    bool size = false; // a Vec3 that may be written as one number for all axes
    bool optional = false; // may be left out of a case file
};

inline auto entriesOf(const PartSize&) {
    return std::tuple{Entry{"part", &PartSize::part}, Entry{"size", &PartSize::size, true}};
}
inline auto entriesOf(const BoxSize&) {
    return std::tuple{Entry{"box", &BoxSize::box}, Entry{"size", &BoxSize::size, true}};
}
inline auto entriesOf(const SphereSize&) {
    return std::tuple{Entry{"centre", &SphereSize::centre}, Entry{"radius", &SphereSize::radius},
                      Entry{"size", &SphereSize::size, true}};
}
inline auto entriesOf(const CylinderSize&) {
    return std::tuple{Entry{"from", &CylinderSize::from}, Entry{"to", &CylinderSize::to},
                      Entry{"radius", &CylinderSize::radius}, Entry{"size", &CylinderSize::size, true}};
}
inline auto entriesOf(const BandSize&) {
    return std::tuple{Entry{"part", &BandSize::part}, Entry{"distance", &BandSize::distance},
                      Entry{"size", &BandSize::size, true}};
}
inline auto entriesOf(const PointSize&) {
    return std::tuple{Entry{"place", &PointSize::place}, Entry{"size", &PointSize::size, true}};
}
inline auto entriesOf(const SegmentSize&) {
    return std::tuple{Entry{"from", &SegmentSize::from}, Entry{"to", &SegmentSize::to},
                      Entry{"size", &SegmentSize::size, true}};
}
inline auto entriesOf(const LineSize&) {
    return std::tuple{Entry{"through", &LineSize::through}, Entry{"direction", &LineSize::direction},
                      Entry{"size", &LineSize::size, true}};
}

inline auto entriesOf(const FeatureBox&) {
    return std::tuple{Entry{"box", &FeatureBox::box}, Entry{"edges", &FeatureBox::edges}};
}

inline auto entriesOf(const PartLayers&) {
    return std::tuple{Entry{"part", &PartLayers::part}, Entry{"count", &PartLayers::count},
                      Entry{"first", &PartLayers::first, false, true}, Entry{"thickness", &PartLayers::thickness, false, true},
                      Entry{"growth", &PartLayers::growth, false, true}};
}

inline std::string_view nameOf(LayerUnit unit) { return unit == LayerUnit::cell ? "cell" : "m"; }
inline std::optional<LayerUnit> layerUnitNamed(std::string_view name) {
    for (const LayerUnit unit : {LayerUnit::metre, LayerUnit::cell})
        if (nameOf(unit) == name) return unit;
    return {};
}

inline std::string_view nameOf(BoxEdges edges) { return edges == BoxEdges::all ? "all" : "none"; }
inline std::optional<BoxEdges> boxEdgesNamed(std::string_view name) {
    for (const BoxEdges edges : {BoxEdges::none, BoxEdges::all})
        if (nameOf(edges) == name) return edges;
    return {};
}

// True for lists whose items have such entries.
template <class T>
struct HasEntries : std::false_type {};
template <class T>
    requires requires(const T& t) { entriesOf(t); }
struct HasEntries<std::vector<T>> : std::true_type {};

// How many numbers a value takes on the command line; a text takes none. Sizes are one number or three.
template <class V>
constexpr std::size_t numbersIn() {
    return std::is_same_v<V, Box> ? 6 : std::is_same_v<V, Vec3> ? 3 : std::is_same_v<V, double> ? 1 : 0;
}

} // namespace i2b
