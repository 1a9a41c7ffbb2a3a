// Arithmetic of lanes. glance.cpp includes this once for each instruction set, inside a namespace of its own: what is
// inline here must not be shared between them.

using Doubles = double __attribute__((vector_size(I2B_LANE_BYTES)));
constexpr int width = I2B_LANE_BYTES / 8; // lanes that are worked on at once
using Marks = Doubles; // 1 in lanes that are marked, else 0: compilers choose best between doubles where they compare such

struct Vecs {
    Doubles x, y, z;
};

// From lane k on.
I2B_LANES Doubles load(const Lanes& from, std::size_t k) {
    Doubles v;
    __builtin_memcpy(&v, from.value + k, sizeof v);
    return v;
}
I2B_LANES Vecs load(const VecLanes& from, std::size_t k) { return {load(from.x, k), load(from.y, k), load(from.z, k)}; }
I2B_LANES void store(Lanes& to, std::size_t k, const Doubles& v) { __builtin_memcpy(to.value + k, &v, sizeof v); }
I2B_LANES void store(VecLanes& to, std::size_t k, const Vecs& v) { store(to.x, k, v.x), store(to.y, k, v.y), store(to.z, k, v.z); }

I2B_LANES Doubles splat(double v) { return Doubles{} + v; }
I2B_LANES Doubles absolute(const Doubles& v) { return v < 0.0 ? -v : v; }
I2B_LANES Doubles least(const Doubles& a, const Doubles& b) { return b < a ? b : a; }
I2B_LANES Doubles most(const Doubles& a, const Doubles& b) { return a < b ? b : a; }
I2B_LANES Doubles root(const Doubles& v) {
    Doubles r;
    for (int i = 0; i < width; ++i) r[i] = __builtin_sqrt(v[i]);
    return r;
}

// Mark the lanes that are not above, or not at least, what they should be; those that are no numbers, too.
I2B_LANES void markUnlessAbove(Marks& odd, const Doubles& v, const Doubles& limit) { odd = v > limit ? odd : splat(1); }
I2B_LANES void markUnlessAtLeast(Marks& odd, const Doubles& v, const Doubles& limit) { odd = v >= limit ? odd : splat(1); }
I2B_LANES unsigned lanesOf(const Marks& m) { // bit i: lane i is marked
    unsigned bits = 0;
    for (int i = 0; i < width; ++i) bits |= m[i] > 0 ? 1U << i : 0U;
    return bits;
}
// But for the marked lanes.
I2B_LANES void add(LaneExtremes& e, std::size_t k, const Doubles& v, const Marks& out) {
    const Doubles low = load(e.least, k), high = load(e.most, k);
    store(e.least, k, out > 0.0 ? low : least(low, v));
    store(e.most, k, out > 0.0 ? high : most(high, v));
}

I2B_LANES void operator+=(Vecs& a, const Vecs& o) { a.x += o.x, a.y += o.y, a.z += o.z; }
I2B_LANES void operator-=(Vecs& a, const Vecs& o) { a.x -= o.x, a.y -= o.y, a.z -= o.z; }
I2B_LANES Vecs operator+(const Vecs& a, const Vecs& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
I2B_LANES Vecs operator-(const Vecs& a, const Vecs& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
I2B_LANES Vecs operator*(const Doubles& s, const Vecs& a) { return {a.x * s, a.y * s, a.z * s}; }
I2B_LANES Vecs divided(const Vecs& a, const Doubles& s) { return {a.x / s, a.y / s, a.z / s}; }
I2B_LANES Doubles dot(const Vecs& a, const Vecs& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
I2B_LANES Vecs cross(const Vecs& a, const Vecs& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
I2B_LANES Doubles norm2(const Vecs& a) { return dot(a, a); }
I2B_LANES Doubles norm(const Vecs& a) { return root(norm2(a)); }

struct QuadShapes {
    Vecs centre, area; // as FaceShape
    Doubles sizes;     // of the triangles, twice their sum; next to 0, centre and area are not those of FaceShape
};

// shapeOfPolygon() of quadrilaterals; edge[i] runs from point[i] to the next.
I2B_LANES QuadShapes shapesOfQuads(const Vecs* point, const Vecs* edge) {
    Vecs mean = point[0];
    mean += point[1];
    mean += point[2];
    mean += point[3];
    mean = splat(0.25) * mean;
    Vecs normal{}, weighted{};
    Doubles sizes{};
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
        const Vecs twice = cross(edge[i], mean - point[i]);
        const Doubles size = norm(twice);
        normal += twice;
        sizes += size;
        weighted += size * (point[i] + point[(i + 1) % 4] + mean);
    }
    return {divided(splat(1.0 / 3.0) * weighted, sizes), splat(0.5) * normal, sizes};
}
