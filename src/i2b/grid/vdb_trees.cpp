// The trees that vdb.h promises to every file that includes it.
#include "i2b/grid/vdb.h"

template class openvdb::tree::Tree<openvdb::MaskTree::RootNodeType>;
template class openvdb::tree::Tree<openvdb::Int32Tree::RootNodeType>;
