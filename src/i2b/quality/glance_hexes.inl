// The kernel of glanceAtHexes(); needs lane_maths.inl. Included by glance.cpp as that is.

// As measureCell(). Returns the volume.
I2B_LANES Doubles measureHexes(HexBatch& b, std::size_t k, const Vecs* centre, const Vecs* area, Marks& odd) {
    Vecs mean{};
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) mean += centre[i];
    mean = divided(mean, splat(6));
    const Vecs quarter = splat(1.0 / 4.0) * mean;
    Vecs weighted{};
    Doubles volume3{};
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
        const Doubles pyramid3 = dot(area[i], load(b.side[i], k) * (centre[i] - mean));
        weighted += pyramid3 * (splat(3.0 / 4.0) * centre[i] + quarter);
        volume3 += pyramid3;
    }
    markUnlessAbove(odd, volume3, splat(1e-300));
    store(b.centre, k, divided(weighted, volume3));
    return volume3 * (1.0 / 3.0);
}

// As checkClosedness(), but for the part of the aspect ratio that takes a power. Returns the openness.
I2B_LANES Doubles closednessOf(HexBatch& b, std::size_t k, const Vecs* area) {
    Vecs sum{}, sizes{};
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
        sum += load(b.side[i], k) * area[i];
        sizes += Vecs{absolute(area[i].x), absolute(area[i].y), absolute(area[i].z)};
    }
    const Doubles open = most(most(absolute(sum.x) / (sizes.x + tinyDivisor), absolute(sum.y) / (sizes.y + tinyDivisor)),
                              absolute(sum.z) / (sizes.z + tinyDivisor));
    store(b.aspect, k, most(most(sizes.x, sizes.y), sizes.z) / (least(least(sizes.x, sizes.y), sizes.z) + tinyDivisor));
    store(b.surface, k, 1.0 / 6.0 * (sizes.x + sizes.y + sizes.z));
    return open;
}

// As cellDeterminant() in three directions.
I2B_LANES Doubles determinantOf(const HexBatch& b, std::size_t k, const Vecs* area, const Doubles* size, Marks& odd) {
    Doubles mean{}, n{};
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) mean += load(b.inner[i], k) * size[i], n += load(b.inner[i], k);
    markUnlessAbove(odd, mean, splat(tinyDivisor));
    mean = mean / n;
    Doubles xx{}, xy{}, xz{}, yy{}, yz{}, zz{};
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
        const Vecs a = load(b.inner[i], k) * divided(area[i], mean);
        xx += a.x * a.x, xy += a.x * a.y, xz += a.x * a.z;
        yy += a.y * a.y, yz += a.y * a.z, zz += a.z * a.z;
    }
    const Doubles det = xx * yy * zz + xy * yz * xz + xz * xy * yz - xx * yz * yz - xy * xy * zz - xz * yy * xz;
    return absolute(det) / 8.0;
}

// As cellFullness().
I2B_LANES Doubles fullnessOf(const Vecs* area, const Doubles* size) {
    Doubles sum{}, xx{}, xy{}, xz{}, yy{}, yz{}, zz{};
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
        const Vecs unit = (1.0 / (size[i] + 1e-300)) * area[i];
        sum += size[i];
        xx += area[i].x * unit.x, xy += area[i].x * unit.y, xz += area[i].x * unit.z;
        yy += area[i].y * unit.y, yz += area[i].y * unit.z, zz += area[i].z * unit.z;
    }
    const Doubles det = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
    sum += 1e-300;
    return det / (sum * sum * sum) / 0.037037037037037;
}

// As isConcave().
I2B_LANES void markMaybeConcave(const HexBatch& b, std::size_t k, const Vecs* centre, const Vecs* area, const Doubles* size2, Marks& odd) {
#pragma GCC unroll 6
    for (int f = 0; f < 6; ++f) {
        const Vecs outwards = load(b.side[f], k) * area[f];
        const Doubles least2 = (1.01 * planarCosine * planarCosine) * size2[f];
#pragma GCC unroll 6
        for (int g = 0; g < 6; ++g) {
            if (g == f) continue;
            const Vecs d = centre[g] - centre[f];
            const Doubles along = dot(d, outwards), d2 = norm2(d);
            markUnlessAbove(odd, -along, Doubles{});
            markUnlessAbove(odd, along * along, least2 * d2);
            markUnlessAbove(odd, d2 * size2[f], splat(1e-200));
        }
    }
}

I2B_LANES unsigned glanceAtHexes(HexBatch& b, std::size_t k, const HexBounds& bounds, HexExtremes& extremes) {
    Vecs centre[6], area[6];
    Doubles size2[6], size[6];
    Marks odd{};
    for (int f = 0; f < 6; ++f) {
        const VecLanes* const from = b.point[f];
        const Vecs point[4] = {load(from[0], k), load(from[1], k), load(from[2], k), load(from[3], k)};
        const Vecs edge[4] = {point[1] - point[0], point[2] - point[1], point[3] - point[2], point[0] - point[3]};
        const QuadShapes shape = shapesOfQuads(point, edge);
        centre[f] = shape.centre, area[f] = shape.area;
        size2[f] = norm2(shape.area), size[f] = root(size2[f]);
        markUnlessAtLeast(odd, shape.sizes, splat(1e-150));
    }
    const Doubles volume = measureHexes(b, k, centre, area, odd);
    const Doubles openness = closednessOf(b, k, area), fullness = fullnessOf(area, size);
    const Doubles determinant = determinantOf(b, k, area, size, odd);
    markUnlessAtLeast(odd, volume, splat(bounds.smallVolume));
    markUnlessAtLeast(odd, splat(bounds.closedness), openness);
    markUnlessAtLeast(odd, splat(bounds.aspectRatio), load(b.aspect, k));
    markUnlessAtLeast(odd, determinant, splat(bounds.determinant));
    markUnlessAtLeast(odd, fullness, splat(bounds.fullness));
    markMaybeConcave(b, k, centre, area, size2, odd);
    store(b.volume, k, volume), store(b.determinant, k, determinant);
    add(extremes.volume, k, volume, odd), add(extremes.openness, k, openness, odd);
    add(extremes.determinant, k, determinant, odd), add(extremes.fullness, k, fullness, odd);
    return lanesOf(odd);
}

static unsigned glanceAtHexes(HexBatch& batch, const HexBounds& bounds, HexExtremes& extremes) {
    unsigned odd = 0;
    for (std::size_t k = 0; k < laneCount; k += width) odd |= glanceAtHexes(batch, k, bounds, extremes) << k;
    return odd;
}
