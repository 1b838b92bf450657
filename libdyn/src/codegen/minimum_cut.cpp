#include "codegen/minimum_cut.hpp"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"  // gcc 12 sees it in Boost.Graph's iterators
#endif
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>

#include <vector>

namespace dyn {

namespace {
using Traits = boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::directedS>;
struct Edge {
  long capacity = 0, left = 0;
  Traits::edge_descriptor reverse;
};
struct Vertex {
  boost::default_color_type color = boost::white_color;
  Traits::edge_descriptor from;
  long distance = 0;
};
using Network = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS, Vertex, Edge>;

// Yes is the source's side.
constexpr std::size_t yes = 0, no = 1, first = 2;
constexpr long forbidden = 1L << 40;
std::size_t vertexOf(int question) { return first + static_cast<std::size_t>(question); }
}  // namespace

struct MinimumCut::Impl {
  Network network{first};
  int questions = 0;

  void connect(std::size_t a, std::size_t b, long cost) {
    if (cost == 0) return;
    const auto there = boost::add_edge(a, b, network).first, back = boost::add_edge(b, a, network).first;
    network[there].capacity = cost;
    network[there].reverse = back;
    network[back].reverse = there;
  }
};

MinimumCut::MinimumCut() : impl_(std::make_unique<Impl>()) {}
MinimumCut::~MinimumCut() = default;

int MinimumCut::add() {
  boost::add_vertex(impl_->network);
  return impl_->questions++;
}
void MinimumCut::costsIfNo(int question, int cost) { impl_->connect(yes, vertexOf(question), cost); }
void MinimumCut::costsIfYes(int question, int cost) { impl_->connect(vertexOf(question), no, cost); }
void MinimumCut::costsIf(int question, int other, int cost) { impl_->connect(vertexOf(question), vertexOf(other), cost); }
void MinimumCut::follows(int question, int other) { impl_->connect(vertexOf(question), vertexOf(other), forbidden); }

void MinimumCut::solve() {
  Network& n = impl_->network;
  boost::boykov_kolmogorov_max_flow(n, boost::get(&Edge::capacity, n), boost::get(&Edge::left, n), boost::get(&Edge::reverse, n),
                                    boost::get(&Vertex::from, n), boost::get(&Vertex::color, n), boost::get(&Vertex::distance, n),
                                    boost::get(boost::vertex_index, n), yes, no);
}
bool MinimumCut::answer(int question) const { return impl_->network[vertexOf(question)].color == boost::black_color; }

}  // namespace dyn
