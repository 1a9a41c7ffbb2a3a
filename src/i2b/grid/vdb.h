// The one place that includes OpenVDB: its headers cost 20 s a file, so this is the precompiled header of
// the stages that hold trees. The trees used are instantiated once, in vdb_trees.cpp: else each file compiles
// their virtual functions (input and output, pruning, clipping) again, which took two thirds of its time.
#pragma once
#pragma GCC system_header
#include <openvdb/openvdb.h>

extern template class openvdb::tree::Tree<openvdb::MaskTree::RootNodeType>;
extern template class openvdb::tree::Tree<openvdb::Int32Tree::RootNodeType>;
