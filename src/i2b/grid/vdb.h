// The one place that includes OpenVDB: its headers cost 20 s a file, so this is the precompiled header of
// the stages that hold trees.
#pragma once
#pragma GCC system_header
#include <openvdb/openvdb.h>
