#include "i2b/carve/min_cut.h"
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>

namespace i2b {
namespace {

using boost::property;
using Traits = boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::directedS>;
using Vertex = property<boost::vertex_color_t, boost::default_color_type,
                        property<boost::vertex_distance_t, long, property<boost::vertex_predecessor_t, Traits::edge_descriptor>>>;
using Edge = property<boost::edge_capacity_t, long,
                      property<boost::edge_residual_capacity_t, long, property<boost::edge_reverse_t, Traits::edge_descriptor>>>;
using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS, Vertex, Edge>;

void connect(Graph& graph, std::size_t a, std::size_t b, long there, long back) {
    const auto e = boost::add_edge(a, b, graph).first, f = boost::add_edge(b, a, graph).first;
    boost::put(boost::edge_capacity, graph, e, there);
    boost::put(boost::edge_capacity, graph, f, back);
    boost::put(boost::edge_reverse, graph, e, f);
    boost::put(boost::edge_reverse, graph, f, e);
}

} // namespace

std::vector<unsigned char> MinCut::solve() const {
    const std::size_t n = taken_.size(), source = n, sink = n + 1;
    Graph graph(n + 2);
    for (std::size_t i = 0; i < n; ++i) {
        connect(graph, source, i, left_[i], 0);
        connect(graph, i, sink, taken_[i], 0);
    }
    for (const Pair& p : pairs_) connect(graph, p.a, p.b, p.first, p.second);
    boost::boykov_kolmogorov_max_flow(graph, source, sink);
    std::vector<unsigned char> taken(n);
    // White vertices still lead to the sink: they are left.
    for (std::size_t i = 0; i < n; ++i) taken[i] = boost::get(boost::vertex_color, graph, i) != boost::white_color;
    return taken;
}

} // namespace i2b
