// SPDX-License-Identifier: BSD-2-Clause
#include "report/labels.hpp"

#include <algorithm>
#include <numeric>
#include <sstream>

namespace dyn::benchmark {

double textWidth(const std::string& text, double size) {
  // Counts the bytes that begin a letter in UTF-8; the other bytes continue the letter before.
  const auto letters = std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; });
  return 0.58 * size * static_cast<double>(letters);
}

std::vector<std::string> wrapped(const std::string& text, double size, double width) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (lines.empty() || textWidth(lines.back() + ' ' + word, size) > width) {
      lines.push_back(word);
    } else {
      lines.back() += ' ' + word;
    }
  }
  return lines;
}

std::vector<double> spread(const std::vector<double>& wanted, double apart, double low, double high) {
  std::vector<std::size_t> order(wanted.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return wanted[a] < wanted[b]; });
  std::vector<double> out(wanted.size());
  double least = low;
  for (const std::size_t k : order) {
    out[k] = std::max(wanted[k], least);
    least = out[k] + apart;
  }
  double most = high;
  for (auto k = order.rbegin(); k != order.rend(); ++k) {
    out[*k] = std::min(out[*k], most);
    most = out[*k] - apart;
  }
  return out;
}

int FreeSpace::takeFirst(const std::vector<Box>& places) {
  const auto within = [&](const Box& b) {
    return b.x >= frame_.x && b.y >= frame_.y && b.x + b.width <= frame_.x + frame_.width && b.y + b.height <= frame_.y + frame_.height;
  };
  const auto meet = [](const Box& a, const Box& b) {
    return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
  };
  for (std::size_t k = 0; k < places.size(); ++k) {
    const bool free = std::none_of(taken_.begin(), taken_.end(), [&](const Box& other) { return meet(places[k], other); });
    if (!free || !within(places[k])) continue;
    taken_.push_back(places[k]);
    return static_cast<int>(k);
  }
  return -1;
}

}  // namespace dyn::benchmark
