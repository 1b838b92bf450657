// SPDX-License-Identifier: BSD-2-Clause
#include "codegen/minimum_cut.hpp"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"  // gcc 12 sees it in Boost.Graph's iterators
#endif
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>

#include <algorithm>
#include <map>
#include <utility>
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

// Questions on the source's side of the cut are answered yes.
constexpr std::size_t yes = 0, no = 1, first = 2;
constexpr long forbidden = 1L << 40;
std::size_t vertexOf(int question) { return first + static_cast<std::size_t>(question); }

/// Costs between two questions, one for each direction.
struct Pair {
  long there = 0, back = 0;
};
}  // namespace

/// Sums up all costs before the network is built: Boost's search (1.74) finds too little flow if several edges go from one vertex to another.
struct MinimumCut::Impl {
  std::vector<long> if_yes, if_no;
  std::map<std::pair<int, int>, Pair> pairs;  ///< by (a, b) with a < b; `there` is for a yes and b no, `back` for a no and b yes
  Network network;

  void add(int question, int other, long cost) {
    if (question == other) return;
    Pair& pair = pairs[std::minmax(question, other)];
    (question < other ? pair.there : pair.back) += cost;
  }
  void connect(std::size_t a, std::size_t b, const Pair& costs) {
    if (costs.there == 0 && costs.back == 0) return;
    const auto there = boost::add_edge(a, b, network).first, back = boost::add_edge(b, a, network).first;
    network[there].capacity = costs.there;
    network[back].capacity = costs.back;
    network[there].reverse = back;
    network[back].reverse = there;
  }
};

MinimumCut::MinimumCut() : impl_(std::make_unique<Impl>()) {}
MinimumCut::~MinimumCut() = default;

int MinimumCut::add() {
  impl_->if_yes.push_back(0);
  impl_->if_no.push_back(0);
  return static_cast<int>(impl_->if_yes.size()) - 1;
}
void MinimumCut::costsIfNo(int question, int cost) { impl_->if_no[static_cast<std::size_t>(question)] += cost; }
void MinimumCut::costsIfYes(int question, int cost) { impl_->if_yes[static_cast<std::size_t>(question)] += cost; }
void MinimumCut::costsIf(int question, int other, int cost) { impl_->add(question, other, cost); }
void MinimumCut::follows(int question, int other) { impl_->add(question, other, forbidden); }

void MinimumCut::solve() {
  Impl& x = *impl_;
  Network& n = x.network = Network(first + x.if_yes.size());
  for (std::size_t k = 0; k < x.if_yes.size(); ++k) {
    x.connect(yes, first + k, {x.if_no[k], 0});
    x.connect(first + k, no, {x.if_yes[k], 0});
  }
  for (const auto& [questions, costs] : x.pairs) x.connect(vertexOf(questions.first), vertexOf(questions.second), costs);
  boost::boykov_kolmogorov_max_flow(n, boost::get(&Edge::capacity, n), boost::get(&Edge::left, n), boost::get(&Edge::reverse, n),
                                    boost::get(&Vertex::from, n), boost::get(&Vertex::color, n), boost::get(&Vertex::distance, n),
                                    boost::get(boost::vertex_index, n), yes, no);
}
bool MinimumCut::answer(int question) const { return impl_->network[vertexOf(question)].color == boost::black_color; }

}  // namespace dyn
