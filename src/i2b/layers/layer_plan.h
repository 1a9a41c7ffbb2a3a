// What is asked of the layers on a wall, solved from the options, and how a stack of cells of one front vertex follows
// it: heights are counted from the wall, so that stacks of different counts beside each other have their cells level.
#pragma once
#include "i2b/options.h"
#include <string>
#include <vector>

namespace i2b {

constexpr int maxLayers = 100;
constexpr int maxOver = 6;           // cells over them, between the last layer and the front
constexpr int maxStack = maxLayers + maxOver;
constexpr double leastGrowth = 0.5, mostGrowth = 4;
constexpr double defaultGrowth = 1.2;

struct LayerPlan {
    int count = 1;                   // layers; 0: none, one cell from front to wall
    double first = 0;                // height of the one at the wall, m or cell sizes; 0: the layers fill the room
    double growth = defaultGrowth;   // ratio of heights, outwards
    bool relative = false;           // first is in cell sizes

    bool fills() const { return first == 0; }
    double room() const;             // that they and a cell over them want, m or cell sizes; 0: any will do
    double firstAt(double cellSize) const { return relative ? first * cellSize : first; } // m
};

// Count, heights and growth as asked for, before the one left out of the last three is solved for; 0: left out.
struct LayerRequest {
    int count = 1;
    double first = 0, thickness = 0, growth = 0;
};
LayerRequest requestOf(const LayerOptions& options);                         // for all walls
LayerRequest requestOf(const LayerOptions& options, const PartLayers& part); // with what the part leaves out

// "" or why no plan meets the request: three figures that contradict each other, or no growth in bounds.
std::string faultOf(const LayerRequest& request);
LayerPlan planOf(const LayerRequest& request, LayerUnit unit); // of a request without fault

// first * (1 + r + ... + r^(n-1))
double stackHeight(double first, double ratio, int n);
// The ratio between lo and hi with which n layers that start at first, and a further cell of `extra` times the height of
// the last, are `height` high; lo or hi where none is.
double solveGrowth(double first, double height, int n, double lo, double hi, double extra = 0);

// Distances (m, rising) from the wall of the cells - 1 points between wall and front into level. room: m, from wall to
// front; cells: of the stack, at most maxOver more than the plan's layers.
//   More cells than layers: they take what the layers leave of the room, on average at least half the height of the last layer, each in the
//   same ratio to the one before it.
//   As many: where the room is up to half a layer higher than asked, it is shared out over all layers.
//   Fewer, beside stacks of fewer cells: the cells at the wall as asked, the last takes the rest.
// Where the room is too small the growth falls down to 1 while the first height stays, then all heights.
void stackLevels(const LayerPlan& plan, double room, double cellSize, int cells, double* level);

// The layers' height as asked, in m: of the room where they fill it.
double askedThickness(const LayerPlan& plan, double room, double cellSize);
double askedFirst(const LayerPlan& plan, double room, double cellSize);
// Cells of a stack of its own: further ones where the room is over half the last layer higher than what is asked, so many that none is more
// than three times as high as the one before it.
int wantedCells(const LayerPlan& plan, double room, double cellSize);

} // namespace i2b
