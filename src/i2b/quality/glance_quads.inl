// The kernel of glanceAtQuads(); needs lane_maths.inl. Included by glance.cpp as that is.

// As clearlyConvex().
I2B_LANES void markMaybeConcave(const Vecs* edge, const Vecs& area, Marks& odd) {
    const Doubles area2 = norm2(area);
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
        const Vecs turn = cross(edge[(i + 3) % 4], edge[i]);
        const Doubles along = dot(turn, area);
        markUnlessAbove(odd, along, splat(1e-140));
        markUnlessAbove(odd, along * along, 1e-16 * norm2(turn) * area2);
    }
}

// Triangles around the face's centre: their areas for the flatness, their normals for the two twists. A normal that is
// clearly within the limit of the direction across is within it when everything is divided by lengths, too.
I2B_LANES Doubles trianglesArea(const Vecs* point, const Vecs* edge, const Vecs& centre, const Vecs& across,
                                       const Doubles& acrossSize, const QuadBounds& bounds, Marks& odd) {
    constexpr double margin = 1e-6;
    Doubles sum{};
    Vecs triangle[4];
    Doubles size[4];
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
        triangle[i] = splat(0.5) * cross(edge[i], centre - point[i]);
        size[i] = norm(triangle[i]);
        sum += size[i];
        markUnlessAbove(odd, dot(across, triangle[i]), (bounds.twist + margin) * acrossSize * size[i]);
    }
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
        const int next = (i + 1) % 4;
        markUnlessAbove(odd, dot(triangle[i], triangle[next]), (bounds.triangleTwist + margin) * size[i] * size[next]);
    }
    return sum;
}

// As faceSkewness() of an inner face.
I2B_LANES Doubles skewnessOf(const Vecs* point, const QuadShapes& shape, const Vecs& toFace, const Vecs& across,
                                    const Doubles& acrossSize) {
    const Vecs miss = toFace - (dot(shape.area, toFace) / (dot(shape.area, across) + tinyDivisor)) * across;
    const Doubles size = norm(miss);
    const Vecs direction = divided(miss, size + tinyDivisor);
    Doubles extent = 0.2 * acrossSize + tinyDivisor;
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) extent = most(extent, absolute(dot(direction, point[i] - shape.centre)));
    return size / extent;
}

// As tetsClearlyGood().
I2B_LANES void markMaybePoorTets(const Vecs* point, const Vecs& centre, const Vecs& toOwner, const Vecs& toNeighbour, const QuadBounds& bounds,
                                 Marks& odd) {
    Doubles reach2 = most(norm2(toOwner), norm2(toNeighbour));
    Doubles volume = splat(1e300);
    Vecs arm[4];
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
        arm[i] = point[i] - centre;
        reach2 = most(reach2, norm2(arm[i]));
    }
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
        const Vecs area = cross(arm[i], arm[(i + 1) % 4]);
        volume = least(volume, least(-dot(area, toOwner), dot(area, toNeighbour)));
    }
    // The fan from any vertex: both that have the same diagonal are the same triangles.
    Doubles best = splat(-1e300);
#pragma GCC unroll 2
    for (int base = 0; base < 2; ++base) {
        const Vecs& first = arm[base];
        Doubles fan = splat(1e300);
#pragma GCC unroll 2
        for (int i = 1; i < 3; ++i) {
            const Vecs area = cross(arm[(base + i) % 4] - first, arm[(base + i + 1) % 4] - first);
            fan = least(fan, least(dot(area, first - toOwner), dot(area, toNeighbour - first)));
        }
        best = most(best, fan);
    }
    volume = least(volume, best);
    const Doubles longest2 = 4 * reach2, volume2 = volume * volume;
    markUnlessAbove(odd, volume, Doubles{});
    markUnlessAbove(odd, volume2, bounds.tetShape * longest2 * longest2 * longest2);
    markUnlessAbove(odd, volume2, splat(1e-280));
}

I2B_LANES unsigned glanceAtQuads(QuadBatch& b, std::size_t k, const QuadBounds& bounds, QuadExtremes& extremes) {
    const Vecs point[4] = {load(b.point[0], k), load(b.point[1], k), load(b.point[2], k), load(b.point[3], k)};
    const Vecs edge[4] = {point[1] - point[0], point[2] - point[1], point[3] - point[2], point[0] - point[3]};
    const Doubles edge2[4] = {norm2(edge[0]), norm2(edge[1]), norm2(edge[2]), norm2(edge[3])};
    const Doubles shortest2 = least(least(edge2[0], edge2[1]), least(edge2[2], edge2[3]));
    const QuadShapes shape = shapesOfQuads(point, edge);
    const Doubles size = norm(shape.area);
    Marks odd{};
    markUnlessAtLeast(odd, shape.sizes, splat(1e-150));
    markUnlessAtLeast(odd, shortest2, splat(bounds.shortEdge2));
    markUnlessAtLeast(odd, size, splat(bounds.faceArea));
    markUnlessAbove(odd, size, splat(1e-150));
    markMaybeConcave(edge, shape.area, odd);

    const Vecs own = load(b.own, k), nei = load(b.nei, k);
    const Vecs across = nei - own, toFace = shape.centre - own, fromFace = nei - shape.centre;
    const Doubles acrossSize = norm(across);
    const Doubles spread = trianglesArea(point, edge, shape.centre, across, acrossSize, bounds, odd);
    const Doubles flat = size / (spread + 1e-150);
    markUnlessAtLeast(odd, flat, splat(bounds.flatness));
    markUnlessAtLeast(odd, spread, bounds.spread * size);

    const Doubles ortho = dot(across, shape.area) / (acrossSize * size + tinyDivisor);
    const Doubles ownPyramid = dot(shape.area, toFace), neiPyramid = dot(shape.area, fromFace);
    const Doubles ownDistance = absolute(ownPyramid), neiDistance = absolute(neiPyramid);
    const Doubles ownVolume = load(b.ownVolume, k), neiVolume = load(b.neiVolume, k);
    const Doubles weight = least(neiDistance, ownDistance) / (neiDistance + ownDistance + 1e-300);
    const Doubles ratio = least(ownVolume, neiVolume) / (most(ownVolume, neiVolume) + 1e-300);
    const Doubles skew = skewnessOf(point, shape, toFace, across, acrossSize);
    markUnlessAtLeast(odd, ortho, splat(bounds.cosine));
    markUnlessAtLeast(odd, weight, splat(bounds.weight));
    markUnlessAtLeast(odd, ratio, splat(bounds.ratio));
    markUnlessAbove(odd, least(ownVolume, neiVolume), Doubles{});
    markUnlessAtLeast(odd, least(ownPyramid, neiPyramid), splat(bounds.pyramid3));
    markUnlessAtLeast(odd, splat(bounds.skewness), skew);
    markMaybePoorTets(point, shape.centre, own - shape.centre, fromFace, bounds, odd);

    store(b.flat, k, flat), store(b.ortho, k, ortho), store(b.weight, k, weight), store(b.ratio, k, ratio), store(b.skewness, k, skew);
    for (const Doubles& e : edge2) add(extremes.edge2, k, e, odd);
    add(extremes.area, k, size, odd), add(extremes.flatness, k, flat, odd), add(extremes.ortho, k, ortho, odd);
    add(extremes.weight, k, weight, odd), add(extremes.ratio, k, ratio, odd), add(extremes.skewness, k, skew, odd);
    return lanesOf(odd);
}

static unsigned glanceAtQuads(QuadBatch& batch, const QuadBounds& bounds, QuadExtremes& extremes) {
    unsigned odd = 0;
    for (std::size_t k = 0; k < laneCount; k += width) odd |= glanceAtQuads(batch, k, bounds, extremes) << k;
    return odd;
}
