// The OpenMesh type of the front: polygons, double precision.
#pragma once
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#pragma GCC diagnostic pop

namespace i2b {

struct FrontTraits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    using Normal = OpenMesh::Vec3d;
    HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
    VertexAttributes(OpenMesh::Attributes::None);
    FaceAttributes(OpenMesh::Attributes::None);
    EdgeAttributes(OpenMesh::Attributes::None);
};
using FrontMesh = OpenMesh::PolyMesh_ArrayKernelT<FrontTraits>;

} // namespace i2b
