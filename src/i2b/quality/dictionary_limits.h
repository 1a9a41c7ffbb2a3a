// Limits of mesh quality that a user sets.
#pragma once

namespace i2b {

// OpenFOAM's mesh quality dictionary, with the figures of its etc/caseDicts/mesh/generation/meshQualityDict.cfg.
struct DictionaryLimits {
    double nonOrthogonality = 65;    // degrees, at most; 180: not asked
    double pyramidVolume = 1e-13;    // m^3, of a face with a cell's centre, at least; -1e15 and less: not asked
    double tetQuality = 1e-15;       // of the tetrahedra of faces with cells, 1: regular; -1e15 and less: not asked
    double concavity = 80;           // degrees, of a face's angles, at most; 180: not asked
    double faceArea = -1;            // m^2, at least; below 0: not asked
    double internalSkewness = 4;     // at most; this and the next not over 0: not asked
    double boundarySkewness = 20;
    double faceWeight = 0.05;        // at least; below 0, or 1 and more: not asked
    double volumeRatio = 0.01;       // at least; below 0: not asked
    double twist = 0.02;             // cosine, triangles of a face to the line between the cells, at least; -1: not asked
    double triangleTwist = -1;       // cosine, triangles of a face to the next, at least; -1: not asked
    double flatness = -1;            // sum of the areas of a face's triangles over its own, at least; below 0: not asked
    double determinant = 0.001;      // of cells, by all faces (1: a cube), at least; -1: not asked
};

} // namespace i2b
